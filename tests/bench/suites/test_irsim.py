"""The suite irsim: its worlds are ir-sim's, and ir-sim's flag decides on contacts."""

import sys

import numpy as np
import pytest

from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import load_suite
from dynastar.errors import DataError
from dynastar.geometry import Twist
from dynastar.simulation.start import start_pose
from scripted import Still


def test_without_ir_sim_one_clear_line(monkeypatch):
    for name in [name for name in sys.modules if "irsim" in name]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "irsim", None)
    with pytest.raises(DataError, match="the suite irsim needs the package irsim"):
        load_suite("irsim")


pytest.importorskip("irsim", reason="needs ir-sim: pip install '.[irsim]'")

from dynastar.bench.suites import irsim as suite  # noqa: E402
from dynastar.bench.suites.irsim_world import IrSimWorld  # noqa: E402

OPTIONS = Options()
KINDS = {"walkers": 0, "crowd": 1, "clutter": 2, "mixed": 3}


def world(number=0, start=None):
    env = suite.make_env(Mission(number), OPTIONS)
    scenario = suite.scenario(Mission(number), OPTIONS, 0)
    if start is not None:
        env.robot.set_state(list(start), init=True)
        env.refresh()
    return IrSimWorld(scenario, start_pose(scenario), 0, env)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mission_has_the_walkers_and_the_clutter_of_its_kind(kind):
    made, wanted = world(KINDS[kind]), suite.KINDS[kind]
    assert len(made.movers) == len(made.mover_radii) == wanted.walkers
    assert len(made.obstacles) == wanted.clutter
    assert made.contact == ""
    assert made.clearance > 0.0


def test_numbers_and_seeds_make_other_worlds_and_the_same_ones_again():
    assert np.array_equal(world(0).movers, world(0).movers)
    assert not np.array_equal(world(0).movers, world(4).movers)
    seeded = suite.make_env(Mission(0), Options(seed=1))
    assert not np.array_equal(seeded.obstacle_list[0].state[:2, 0], world(0).movers[0])


def test_the_robot_moves_as_ir_sim_says_and_walkers_move_too():
    made = world(0)
    before = made.movers
    for _ in range(10):
        made.step(Twist(0.5, 0.0), 0.1)
    assert made.time == pytest.approx(1.0)
    assert made.pose.x == pytest.approx(1.0 + 0.1 * (0.1 + 0.2 + 0.3 + 0.4 + 6 * 0.5))
    assert made.twist == (0.5, 0.0)
    assert not made.resting
    moved = np.hypot(*(made.movers - before).T)
    assert (moved < 1.01 * np.sqrt(2.0)).all()
    assert moved.max() > 0.5


def test_speeds_and_scans_are_those_of_now():
    made = world(2)
    gaps = []
    for v in (0.1, 0.2, 0.3):
        made.step(Twist(v, 0.0), 0.1)
        state, scan = made.sensed_state(), made.scan()
        assert (state.pose, state.twist) == (made.pose, (v, 0.0))
        assert state.stamp == scan.stamp == made.time
        gaps.append(float(np.nanmin(scan.readings())) - 0.25 - made.clearance)
    assert gaps == pytest.approx([0.0] * 3, abs=0.05)


def test_a_period_of_two_steps_drives_both():
    made = world(0)
    made.step(Twist(0.1, 0.0), 0.2)
    assert (made.time, made.pose.x) == (pytest.approx(0.2), pytest.approx(1.02))


def test_a_touch_is_ir_sims_and_ends_the_world():
    made = world(2)
    ring = made.obstacles[0]
    x, y = ring[:, 0].min() - 0.3, 0.5 * (ring[:, 1].min() + ring[:, 1].max())
    made = world(2, (x, y, 0.0))
    while not made.contact and made.time < 3.0:
        made.step(Twist(0.3, 0.0), 0.1)
    assert (made.contact, made.clearance) == ("moving", 0.0)
    stopped = made.time
    made.step(Twist(0.3, 0.0), 0.1)
    assert made.time == stopped


def test_a_row_says_how_the_mission_ended_and_of_which_kind_it_was(monkeypatch):
    monkeypatch.setattr(suite, "TIME_LIMIT", 1.0)
    monkeypatch.setattr(suite, "controller_named", lambda name: Still)
    seen = []
    options = Options(controller="given", observe=lambda *args: seen.append(args))
    row = suite.run_mission(Mission(2), options, 0)
    assert (row["group"], row["outcome"], row["contacts_moving"]) == ("clutter", "timeout", 0)
    assert seen[0][2].outcome == "timeout"
    assert len(seen[0][2].obstacles) == suite.KINDS["clutter"].clutter


@pytest.mark.slow
def test_the_navigator_arrives_among_clutter_and_does_so_again():
    first, second = (suite.run_mission(Mission(2), OPTIONS, 0) for _ in range(2))
    assert first["outcome"] == "arrived"
    assert (first["time"], first["length"]) == (second["time"], second["length"])
    assert first["time_ratio"] >= 1.0


def test_clutter_that_leaves_no_way_is_left_out(monkeypatch):
    assert suite.leave_out(Mission(2), OPTIONS) == ""
    monkeypatch.setattr(suite, "time_bound", lambda scenario: None)
    assert suite.leave_out(Mission(2), OPTIONS) == "the clutter leaves no way"
