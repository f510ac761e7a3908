"""``dynastar tune`` as it is called: worlds for a robot, resumed after a kill, refused where it must be."""

import json
import pickle
import subprocess
import sys
import time
import tomllib

import pytest

import tuned_bench
from dynastar import io
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import SUITES
from dynastar.cli import main
from dynastar.errors import DataError, InputError
from dynastar.navigator import NavigatorConfig, configured
from dynastar.robot import Robot
from dynastar.tune.search import Plan
from dynastar.tune.state import alone_in, load_state
from dynastar.tune.tuning import Task, tune
from dynastar.tune.worlds import RobotWorlds, seen_before, suites_of, worlds_of

MINE = Robot.simple(0.3, 0.7, "mine")
OPTIONS = ["--suite", "tuned", "--worlds", "8", "--settings", "5", "--workers", "1", "--hours", "1"]


@pytest.fixture(autouse=True)
def _tuned(monkeypatch):
    monkeypatch.setitem(SUITES, "tuned", "tuned_bench")


def ended(folder):
    table = json.loads((folder / "state.json").read_text("utf-8"))
    del table["spent_s"]
    return table


def test_a_search_that_was_killed_goes_on(tmp_path, capsys):
    pytest.importorskip("optuna")
    words = [*OPTIONS, "--data", str(tmp_path), "--out"]
    command = [sys.executable, tuned_bench.__file__, "tune", *words, str(tmp_path / "out")]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        while not (tmp_path / "under way").exists():
            assert process.poll() is None
            time.sleep(0.01)
        process.kill()
    assert sum(len(trial["rows"]) for trial in ended(tmp_path / "out")["trials"]) == 20
    (tmp_path / "again").touch()
    assert main(["tune", *words, str(tmp_path / "out")]) == 0
    assert "better than the default" in capsys.readouterr().out
    assert main(["tune", *words, str(tmp_path / "whole")]) == 0
    assert ended(tmp_path / "out") == ended(tmp_path / "whole")
    final = ended(tmp_path / "out")["report_tuned"]
    assert len(final) == 32
    assert {row["seed"] for row in final} == {10_000}
    numbers = {row["number"] for row in ended(tmp_path / "out")["trials"][0]["rows"]}
    assert not numbers & {row["number"] for row in final}
    table = tomllib.loads((tmp_path / "out" / "tuned.toml").read_text("utf-8"))
    assert configured("default", table["navigator"]).dwa.horizon > 4.0
    assert (tmp_path / "out" / "report.html").read_text("utf-8").startswith("<!doctype html>")
    assert not list((tmp_path / "out").glob(".*"))
    assert main(["tune", *words, str(tmp_path / "out"), "--worlds", "9"]) == 2
    assert "holds a search with other worlds" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("task", "words"),
    [
        (Task(seed=10_000), "the seed is 10000: the search takes those below 10000"),
        (Task(worlds=100), "at most 190 worlds"),
        (Task(("movingai",)), "--suite movingai: drives nothing"),
        (Task(("peple",)), "did you mean 'people'"),
    ],
)
def test_a_task_that_cannot_be_is_refused(task, words, tmp_path):
    with pytest.raises(InputError, match=words):
        tune(task, Plan(1.0), tmp_path)


def test_a_robot_that_fits_nowhere_ends_the_search(tmp_path):
    large = Robot.simple(4.0, 0.5)
    with pytest.raises(InputError, match="people leaves out 100 worlds in a row"):
        tune(Task(("people",), 1, large), Plan(1.0), tmp_path)


def test_limits_are_searched_only_in_worlds_of_the_robot(tmp_path, capsys):
    pytest.importorskip("optuna")
    (tmp_path / "again").touch()
    words = ["tune", "--robot", "jackal", *OPTIONS, "--settings", "1", "--data", str(tmp_path)]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    assert "12 parameters" in capsys.readouterr().err


def test_one_search_at_a_time_is_in_a_folder(tmp_path):
    with (
        alone_in(tmp_path),
        pytest.raises(InputError, match="another search runs in it"),
        alone_in(tmp_path),
    ):
        pass
    for folder in (tmp_path, tmp_path / "not" / "there"):
        with alone_in(folder):
            assert folder.is_dir()


@pytest.mark.parametrize(
    "text",
    [
        '{"asked": [], "trials": []}',
        '{"asked": null, "trials": []}',
        '{"asked": {}, "trials": [], "spent_s": null}',
        '{"asked": {}, "trials": [], "spent_s": "x"}',
        '{"asked": {}, "trials": [], "spent_s": NaN}',
        "[" * 100_000,
    ],
)
def test_a_damaged_state_is_named(tmp_path, text):
    (tmp_path / "state.json").write_text(text, encoding="utf-8")
    with pytest.raises(DataError, match="cannot be read"):
        load_state(tmp_path, {"worlds": 1})


def test_worlds_are_drawn_for_a_robot_and_the_same_for_slower_limits():
    config = NavigatorConfig(latency=0.15, range_error=0.03, period=0.1)
    suites = suites_of(("random", "people", "crowd"), MINE, config, {})
    assert suites["crowd"] == "crowd"
    for name in ("random", "people"):
        own = suites[name]
        assert pickle.loads(pickle.dumps(own)) == own
        world = next(worlds_of({name: own}, Options(seed=3)))
        made = own.scenario(world.mission, Options(seed=3), 0)
        assert made.robot.limits == MINE.limits
        assert (made.latency, made.noise.range_bound) == (0.15, 0.03)
        slower = own.limited({"limits.v_max": 0.5, "comfort": 0.0})
        slow = slower.scenario(world.mission, Options(seed=3), 0)
        assert slow.robot.limits == MINE.limits._replace(v_max=0.35)
        assert slow.grid is made.grid
        assert (slow.start, slow.goals, slow.time_limit) == (
            made.start,
            made.goals,
            made.time_limit,
        )


def test_the_worlds_of_the_final_comparison_are_others(monkeypatch):
    suites = {"tuned": "tuned"}
    first = [one.mission.number for one in worlds_of(suites, Options(), count=4)]
    assert first == [1, 2, 4, 5]
    others = worlds_of(suites, Options(seed=10_000), after=4)
    assert [next(others).mission for _ in range(2)] == [Mission(7), Mission(8)]
    # A suite that has no more begins anew, under another seed.
    monkeypatch.setattr(tuned_bench, "missions", lambda options: map(Mission, range(5)))
    again = worlds_of(suites, Options(seed=10_000), after=4, count=2)
    assert [(one.mission.number, one.seed) for one in again] == [(1, 10_000), (2, 10_000)]
    assert seen_before(suites, Options(seed=10_000), 4) == ["tuned"]
    assert seen_before(suites, Options(seed=10_000), 2) == []


def test_no_published_case_is_searched():
    searched, final = (
        {one.mission.number for one in worlds_of({"crowdnav": "crowdnav"}, options, count=30)}
        for options in (Options(), Options(seed=10_000))
    )
    assert searched == set(range(30))
    assert final == set(range(1000, 1030))


def test_one_mission_for_a_robot_of_a_file(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        '[robot]\nbase = "turtlebot3_burger"\nradius = 0.2\n[navigator]\nperiod = 0.1\n'
        "[drive]\ngain_v = 0.9\n[lidar]\nposts = [{angle = 2.0, distance = 0.15, readings = 3}]\n"
    )
    robot, config = io.load_robot(file)
    worlds = RobotWorlds.of("random", robot, config, io.load_faults(file))
    worlds = worlds.limited({"limits.v_max": 0.9})
    world = next(worlds_of({"random": worlds}, Options()))
    made = worlds.scenario(world.mission, Options(), 0)
    assert (made.drive.gain_v, made.lidar.posts[0].angle) == (0.9, 2.0)
    row = worlds.run_mission(world.mission, Options(), 0)
    assert row["outcome"] == "arrived"
    assert not row["contacts_moving"]


def test_without_optuna_the_extra_is_named(monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["tune"]) == 2
    assert "tuning needs optuna, matplotlib, scipy: pip install" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--hours", "0"], "--hours 0: expected 0.001 or more"),
        (["--out", "-"], "--out -: expected a file"),
        (["--dask", "tcp://host:1", "--workers", "2"], "--workers goes with processes here"),
        (["--robot", "none.toml"], "none.toml: there is no such file"),
        (["--robot", "jackle"], "unknown robot 'jackle' (did you mean 'jackal'?)"),
    ],
)
def test_options_that_cannot_be_are_refused(words, said, tmp_path, monkeypatch, capsys):
    pytest.importorskip("optuna")
    monkeypatch.chdir(tmp_path)
    assert main(["tune", *words]) == 2
    assert said in capsys.readouterr().err
