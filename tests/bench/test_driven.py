"""One mission driven: realism, settings, the row; and the same again."""

import re
from dataclasses import replace

import numpy as np
import pytest

from dynastar.bench import driven
from dynastar.bench.keeping import FailureKeeper, replay
from dynastar.bench.missions import Mission, Options
from dynastar.bench.runner import run_suite
from dynastar.errors import ConfigError, InputError
from dynastar.io import load_episode
from small_suite import SUITE, scenario

TIMED = re.compile(r"(tick|command)_ms")


def untimed(row):
    return {key: value for key, value in row.items() if not TIMED.match(key)}


@pytest.fixture(scope="module")
def result():
    return run_suite("small", SUITE, Options(seed=2))


def test_the_row_has_what_the_frame_promises(result):
    arrived, late = result["rows"]
    assert (arrived["outcome"], late["outcome"]) == ("arrived", "timeout")
    assert (arrived["number"], arrived["seed"], arrived["group"]) == (3, 2, "group 3")
    assert arrived["time_bound"] < arrived["time"] < 60.0
    assert arrived["time_ratio"] == arrived["time"] / arrived["time_bound"]
    assert late["time_ratio"] is None
    assert 0.0 < arrived["tick_ms_median"] <= arrived["tick_ms_p99"]
    assert 0.0 < sum(arrived["limited"].values()) <= arrived["time"] + 1.0
    assert arrived["ticks"] > 20


def test_the_result_has_totals_by_group_and_what_is_published(result):
    assert (result["missions"], result["arrived"], result["skipped"]) == (2, 1, 1)
    assert result["score"] == 0.5
    assert result["groups"]["group 3"]["score"] == 1.0
    assert result["published"] == [
        {"label": "someone", "figure": "all of them", "source": "Key2020"}
    ]
    assert result["comparable"] == "nothing"
    assert result["wall_s"] > 0.0
    assert result["cpu_s"] > 0.0
    assert not any("cpu_s" in row for row in result["rows"])


def test_one_seed_gives_the_same_rows_and_another_others(result):
    again = run_suite("small", SUITE, Options(seed=2))
    assert list(map(untimed, again["rows"])) == list(map(untimed, result["rows"]))
    other = run_suite("small", SUITE, Options(seed=3))
    assert other["rows"][0]["length"] != result["rows"][0]["length"]


def test_realism_is_switched_off_by_ideal():
    real, ideal = (scenario(Mission(3), Options(ideal=ideal), 0) for ideal in (False, True))
    assert (real.noise.range_bound, real.latency) == (0.01, 0.05)
    assert (ideal.noise.range_bound, ideal.latency) == (0.0, 0.0)
    assert real.navigator == ideal.navigator == {"period": 0.05}


def test_options_are_laid_over_the_scenario():
    made = replace(scenario(Mission(3), Options(), 0), seed=10)
    options = Options(seed=5, preset="paper", settings={"dwa": {"horizon": 2.0}, "period": 0.1})
    asked = driven.asked(made, options, 2)
    assert (asked.seed, asked.preset) == (17, "paper")
    assert asked.navigator == {"period": 0.1, "dwa": {"horizon": 2.0}}
    attentions = [("none", None), ("late", None), ("late", "none"), ("none", "late")]
    found = [
        driven.asked(replace(made, attention=own), Options(attention=other), 0).attention
        for own, other in attentions
    ]
    assert found == ["none", "late", "none", "late"]
    row = run_suite("small", SUITE, Options(settings={"period": 7.0}))["rows"][0]
    assert row["outcome"] == "error"
    assert "period" in row["reason"]


def test_replay_gives_the_same_row_and_its_episode(result):
    row, episode = replay("small", SUITE, Options(seed=2), 3, 0)
    assert untimed(row) == untimed(result["rows"][0])
    assert len(episode.commands) == row["ticks"]
    assert (episode.scenario["name"], episode.outcome) == ("small 3", "arrived")
    repeated, _ = replay("small", SUITE, Options(), 3, 2)
    assert repeated["seed"] == 2
    assert repeated["length"] == row["length"]


@pytest.mark.parametrize(
    ("number", "said"), [(4, "leaves out mission 4: by rule"), (6, "no mission 6")]
)
def test_what_cannot_be_replayed(number, said):
    with pytest.raises(InputError, match=said):
        replay("small", SUITE, Options(), number, 0)


def test_failures_are_saved_with_episode_and_picture(tmp_path, result):
    again = run_suite("small", SUITE, Options(seed=2, observe=FailureKeeper(tmp_path)))
    assert sorted(file.suffix for file in tmp_path.iterdir()) == [".npz", ".png"]
    (file,) = tmp_path.glob("*-5-0.npz")
    assert load_episode(file).outcome == "timeout"
    assert list(map(untimed, again["rows"])) == list(map(untimed, result["rows"]))


def test_a_failure_that_cannot_be_saved_is_a_warning_and_the_row_stays(tmp_path):
    (tmp_path / "file").touch()
    keeper = FailureKeeper(tmp_path / "file")
    with pytest.warns(UserWarning, match="was not saved"):
        rows = run_suite("small", SUITE, Options(select="5", observe=keeper))["rows"]
    assert rows[0]["outcome"] == "timeout"


def test_what_limits_is_summed_by_cause():
    _, episode = replay("small", SUITE, Options(), 3, 0)
    n = 5
    few = replace(
        episode,
        trajectory=replace(
            episode.trajectory,
            times=np.array([0.0, 0.5, 1.0, 1.5, 2.5]),
            poses=episode.trajectory.poses[:n],
            twists=episode.trajectory.twists[:n],
        ),
        commands=np.array([[0.2, 0], [0.2, 0], [1.0, 0], [0.0, 0], [0.0, 0]]),
        states=np.array(["following", "following", "following", "waiting", "arrived"]),
        limits=np.array(["", "curvature", "", "", ""]),
    )
    expected = {"state: waiting": 1.0, "curvature": 0.5, "other": 0.5}
    assert driven.limited(few, 1.0) == expected
    assert list(driven.limited(few, 1.0)) == ["state: waiting", "curvature", "other"]
    old = replace(few, limits=np.empty(0, np.str_))
    assert driven.limited(old, 1.0) == {"other": 1.0, "state: waiting": 1.0}


def test_an_unknown_controller_is_a_row_with_the_reason():
    row = run_suite("small", SUITE, Options(select="3", controller="navigater"))["rows"][0]
    assert row["outcome"] == "error"
    assert ConfigError.__name__ in row["reason"]
