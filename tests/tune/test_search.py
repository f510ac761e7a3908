"""A search on a made-up robot, whose missions take no time: it improves, stops, resumes, and judges."""

import json
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from dynastar.bench.missions import Mission
from dynastar.errors import DynastarError, InputError
from dynastar.footprint import Footprint
from dynastar.io import load_robot
from dynastar.navigator import NavigatorConfig, configured
from dynastar.robot import ROBOTS
from dynastar.tune.results import tuned_toml, write_results
from dynastar.tune.robot_file import declared_table
from dynastar.tune.sampler import importances, propose
from dynastar.tune.search import Plan, Search
from dynastar.tune.space import SPACE, start_values
from dynastar.tune.state import State, Trial, load_state
from dynastar.tune.verdict import compared, judged
from dynastar.tune.worlds import World

pytest.importorskip("optuna")

SMALL = tuple(p for p in SPACE if p.name in ("dwa.horizon", "comfort", "prediction.spread"))
START = start_values(SMALL, NavigatorConfig())
WORLDS = [World("made", "made", Mission(number), 0) for number in range(16)]
REPORT = [World("made", "made", Mission(number), 10_000) for number in range(100, 140)]


def mission(world, values, gain):
    """A time that falls with the horizon by up to ``gain``, and a failure where comfort is large."""
    random = np.random.default_rng([world.seed, world.mission.number])
    faster = gain * (values["dwa.horizon"] - 4.0) / 3.0
    time = random.uniform(10.0, 20.0) * (1.0 - faster) + 0.2 * random.normal()
    failed = values["comfort"] > 0.3 and world.mission.number % 4 == 1
    outcome = "timeout" if failed else "arrived"
    return {
        "suite": world.name, "number": world.mission.number, "outcome": outcome, "time": time,
        "smoothness": 1.0,
    }  # fmt: skip


class Driver:
    """Counts what is driven, and presses Ctrl-C before the mission that is asked for."""

    def __init__(self, gain=0.3, interrupt=None):
        self.gain, self.interrupt, self.driven = gain, interrupt, []

    def __call__(self, worlds, values):
        if self.interrupt is not None and len(self.driven) + len(worlds) > self.interrupt:
            raise KeyboardInterrupt
        self.driven += [
            (world.seed, world.mission.number, tuple(values.items())) for world in worlds
        ]
        return [mission(world, values, self.gain) for world in worlds]


def searched(folder, driver, settings=30, said=None):
    state = load_state(folder, {"suite": ["made"]})
    say = (lambda line: None) if said is None else said.append
    search = Search(state, folder, START, Plan(1e9, settings, batch=4), driver, say)
    search.run(SMALL, WORLDS)
    search.judge(iter(REPORT), 40)
    return state


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    said = []
    return searched(tmp_path_factory.mktemp("search"), Driver(), said=said), said


def test_a_search_finds_what_is_better_and_says_by_how_much(found):
    state, said = found
    assert state.best.values["dwa.horizon"] > 5.5
    assert state.best.values["comfort"] <= 0.3
    verdict = judged(state)
    assert verdict.better
    assert verdict.worlds == 40
    low, high = verdict.interval
    assert low < verdict.ratio < high < 0.95
    true = 1.0 - 0.3 * (state.best.values["dwa.horizon"] - 4.0) / 3.0
    assert verdict.ratio == pytest.approx(true, abs=0.02)
    assert any("best so far" in line for line in said)
    assert any("final comparison: 40 worlds" in line for line in said)


def test_poor_settings_are_stopped_early(found):
    state, _ = found
    stopped = [trial for trial in state.finished if trial.stopped]
    assert len(stopped) > 10
    assert sum(len(trial.rows) for trial in state.trials) < 0.75 * 30 * len(WORLDS)
    for trial in state.finished:
        if trial.values["comfort"] > 0.3:
            assert "failures" in trial.stopped


def test_what_mattered_is_found(found, tmp_path):
    state, _ = found
    weights = importances(SMALL, state.finished, state.default)
    assert min(weights, key=weights.get) == "prediction.spread"
    assert sum(weights.values()) == pytest.approx(1.0)
    pytest.importorskip("matplotlib")
    write_results(tmp_path, state, SMALL, judged(state), None)
    page = (tmp_path / "report.html").read_text("utf-8")
    assert "In SI units; limits are fractions of the robot's own." in page
    assert page.count("<tr") == 32
    assert page.count("<svg") == 1
    assert "better than the default" in page


def test_a_search_that_was_cut_off_goes_on_to_the_same_end(tmp_path, found):
    whole = searched(tmp_path / "whole", Driver(), settings=8)
    driven = []
    for cut in (2, 14, 25, None):
        driver = Driver(interrupt=cut)
        try:
            state = searched(tmp_path / "cut", driver, settings=8)
        except KeyboardInterrupt:
            assert cut is not None
        driven += driver.driven
    assert (
        len(driven)
        == len(set(driven))
        == sum(len(t.rows) for t in whole.trials) + 2 * len(whole.report_tuned)
    )
    assert [vars(one) for one in state.trials] == [vars(one) for one in whole.trials]
    assert state.report_tuned == whole.report_tuned


def test_a_state_that_is_half_written_or_of_another_search_is_refused(tmp_path):
    State({"suite": ["made"]}).save(tmp_path)
    with pytest.raises(InputError, match="other suite: name another --out"):
        load_state(tmp_path, {"suite": ["random"]})
    (tmp_path / "state.json").write_text('{"asked": {')
    with pytest.raises(InputError, match="cannot be read"):
        load_state(tmp_path, {"suite": ["made"]})
    (tmp_path / "state.json").write_text(json.dumps([1]))
    with pytest.raises(InputError, match="cannot be read"):
        load_state(tmp_path, {"suite": ["made"]})


def test_the_search_leaves_time_for_the_final_comparison(tmp_path, monkeypatch):
    now = [0.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])

    def drive(worlds, values):
        now[0] += len(worlds)  # a second for each
        return [mission(world, values, 0.3) for world in worlds]

    state = load_state(tmp_path, {})
    search = Search(state, tmp_path, START, Plan(400.0, None, batch=4), drive, lambda line: None)
    search.run(SMALL, WORLDS)
    assert 300.0 <= state.spent_s < 304.0
    search.judge(iter(REPORT), 1000)
    assert len(state.report_tuned) == len(REPORT)
    assert state.spent_s < 400.0


def test_a_comparison_that_used_up_its_time_is_not_extended(tmp_path):
    driver = Driver()
    state = searched(tmp_path, driver)
    before, state.spent_s = len(state.report_tuned), 1e9
    state.report_default, state.report_tuned = state.report_default[:8], state.report_tuned[:8]
    Search(state, tmp_path, START, Plan(1e9, batch=4), driver, str).judge(iter(REPORT), 40)
    assert (before, len(state.report_tuned)) == (40, 8)


@pytest.mark.parametrize("of_default", [True, False])
def test_a_mission_that_fails_ends_a_search_of_the_default_and_is_named_else(tmp_path, of_default):
    def drive(worlds, values):
        rows = [mission(world, values, 0.0) for world in worlds]
        if (values == START) == of_default:
            rows[0] |= {"outcome": "error", "reason": "no data"}
        return rows

    said = []
    ends = pytest.raises(DynastarError, match=r"with the default .*: made 0: no data")
    search = Search(State({}), tmp_path, START, Plan(1e9, 2, 4), drive, said.append)
    with ends if of_default else nullcontext():
        search.run(SMALL, WORLDS)
    assert of_default != any(line.endswith("a mission fails: made 0: no data") for line in said)


@pytest.mark.parametrize("count", [1, 3])
def test_so_many_settings_are_tried_besides_the_default(tmp_path, count):
    assert len(searched(tmp_path, Driver(), settings=count).finished) == 1 + count


def test_worlds_that_were_seen_before_are_named(found):
    state, _ = found
    assert judged(state).words in judged(state, ["barn"]).words
    assert "the worlds of barn are those of the search again" in judged(state, ["barn"]).words


def test_a_robots_tuned_file_is_one_to_use(found, tmp_path):
    state, _ = found
    robot = replace(ROBOTS["jackal"], name="mine", footprint=Footprint.disc(0.3))
    config = configured("default", {"latency": 0.2, "dwa": {"reach": 0.5}})
    file = tmp_path / "tuned.toml"
    file.write_text(tuned_toml(state, judged(state), declared_table(robot, config, {})))
    made, used = load_robot(file)
    assert (made.limits, made.lidar) == (robot.limits, robot.lidar)
    assert made.footprint.circumscribed == 0.3
    assert (used.latency, used.dwa.reach) == (0.2, 0.5)
    assert used.dwa.horizon > 5.5


def test_nothing_is_better_where_no_setting_matters(tmp_path):
    state = searched(tmp_path, Driver(gain=0.0), settings=12)
    verdict = judged(state)
    assert not verdict.better
    text = tuned_toml(state, verdict, None)
    assert "horizon = 4.0" in text
    assert "The default settings" in text


def test_the_final_word_puts_success_first():
    def rows(failed, time):
        return [
            {"outcome": "timeout" if n < failed else "arrived", "time": time + 0.01 * n}
            for n in range(40)
        ]

    assert compared(rows(10, 10.0), rows(0, 12.0)).words.startswith("better than the default")
    assert not compared(rows(0, 12.0), rows(10, 10.0)).better
    same = compared(rows(0, 10.0), rows(0, 10.0))
    assert not same.better
    assert "+0.0 %" in same.words


def test_proposals_stay_in_their_ranges_and_are_repeated(found):
    state, _ = found
    values = propose(SMALL, state.finished, state.default, 3)
    assert values == propose(SMALL, state.finished, state.default, 3)
    assert values != propose(SMALL, state.finished, state.default, 4)
    for trial in state.trials:
        for parameter in SMALL:
            assert parameter.low <= trial.values[parameter.name] <= parameter.high


@pytest.mark.parametrize(
    ("tried", "said"), [(0, "0 settings"), (1, "1 setting"), (2, "2 settings")]
)
def test_how_many_settings_were_tried_is_said_in_words(tried, said):
    row = {"outcome": "arrived", "time": 1.0}
    trials = [Trial({}, [row], done=True)] + [Trial({}, [row], "slow", True)] * tried
    assert judged(State({}, trials)).words.endswith(f"found in {said}")
