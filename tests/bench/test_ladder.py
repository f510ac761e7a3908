"""From print to robot: the steps, and what their rows add up to."""

import math
from dataclasses import replace

import pytest

from dynastar.bench import arms, ladder, paper
from dynastar.bench.controllers.printed import Printed, PrintedReplanning
from dynastar.bench.controllers.printed_cost_to_go import PrintedCostToGo
from dynastar.bench.settings import merged
from dynastar.navigator import PRESETS, Navigator, configured
from dynastar.simulation import drive

LEAST, *NAVIGATORS = list(ladder.STEPS)[3:]


def settings(step):
    return configured("default", ladder.STEPS[step].navigator)


def test_the_first_steps_are_the_readings_of_the_paper_and_the_last_is_the_default():
    controllers = [arm.controller for arm in ladder.STEPS.values()]
    assert controllers[:3] == [Printed, PrintedReplanning, PrintedCostToGo]
    assert set(controllers[3:]) == {None}
    assert settings("+ people out of unseen space: preset paper") == PRESETS["paper"]
    assert settings(NAVIGATORS[-1]) == PRESETS["default"]


def test_each_step_adds_what_its_name_says_and_nothing_else():
    before = LEAST
    for step in NAVIGATORS:
        added = ladder.ADDED[step]
        with_it_left_out = merged(ladder.STEPS[step].navigator, added)
        assert settings(step) != settings(before), step
        assert configured("default", with_it_left_out) == settings(before), step
        before = step


@pytest.mark.parametrize(
    ("step", "tracked"), [(LEAST, False), ("+ tracking, risk and nearness", True)]
)
def test_the_walker_is_tracked_from_the_step_of_that_name_on(step, tracked):
    speeds = []

    class Watched(Navigator):
        def command(self, *arguments, **more):
            twist = super().command(*arguments, **more)
            speeds.extend(math.hypot(track.vx, track.vy) for track in self.status.tracks)
            return twist

    world = replace(paper.world(0, 0), navigator=ladder.STEPS[step].navigator)
    drive(replace(world, time_limit=60.0), navigator=Watched)
    assert any(speed > 0.3 for speed in speeds) is tracked


def row(number, step, outcome="arrived", **more):
    return {"number": number, "step": step, "outcome": outcome, "length": 30.0, "time": 60.0} | more


def test_each_step_is_compared_with_the_one_before():
    rows = [
        row(n, step, "arrived" if at >= 3 else "blocked")
        for n in range(6)
        for at, step in enumerate(ladder.STEPS)
    ]
    rows[-1] = row(5, NAVIGATORS[-1], "contact", contacts_moving=1)
    found = ladder.summary(rows)
    assert "p_holm" not in found["printed"]
    assert (found[LEAST]["lost"], found[LEAST]["gained"]) == (0, 6)
    assert found[LEAST]["p_holm"] == pytest.approx(2 / 2**6 * (len(ladder.STEPS) - 1))
    assert (found[NAVIGATORS[-1]]["lost"], found[NAVIGATORS[-1]]["gained"]) == (1, 0)
    cells = ladder.table(found).cells
    assert cells[1] == ["printed", "0", "0 to 39", "0", "0", "6", "", "", "", "", ""]
    assert cells[4][1:9] == ["6", "61 to 100", "0", "0", "0", "60.0", "30.0", "0"]
    ends = ladder.outcomes(found)
    assert ends["late, blocked"]["printed"] == ends["arrived"][LEAST] == 100.0
    assert ends["hit moving"][NAVIGATORS[-1]] == pytest.approx(100.0 / 6)


def test_all_steps_drive_the_same_worlds_once(tmp_path, monkeypatch):
    driven = []

    def record(scenario, navigator):
        driven.append((scenario.name, scenario.seed, scenario.navigator, navigator))
        raise RuntimeError("no")

    monkeypatch.setattr(arms, "drive", record)
    rows = ladder.run(2, 0, tmp_path / "out", settings={"comfort": 0.2})
    assert driven == [
        (name, 0, {"comfort": 0.2, **arm.navigator}, arm.controller)
        for name in ("paper 0", "paper 2")
        for arm in ladder.STEPS.values()
    ]
    monkeypatch.setattr(arms, "drive", None)
    assert ladder.run(2, 0, tmp_path / "out", settings={"comfort": 0.2}) == rows
