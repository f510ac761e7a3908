"""The command line as others call it: exit statuses, JSON, one line for what is wrong."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from dynastar.cli import arguments, main
from dynastar.navigator import PRESETS

ROOM = """\
##########
#........#
#........#
#..####..#
#........#
##########
"""
DOOR = """\
##############
#......#.....#
#......#.....#
#............#
#......#.....#
##############
"""
SPLIT = "#####\n#.#.#\n#####\n"
MOVINGAI = "type octile\nheight 4\nwidth 5\nmap\n.....\n.@@@.\n....@\n@@@@.\n"
SCENARIO = """\
map = "room.txt"
robot = "turtlebot3_burger"
start = [1.5, 1.5]
goal = [3.5, 1.5]
time_limit = 60.0
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "room.txt").write_text(ROOM)
    (tmp_path / "split.txt").write_text(SPLIT)
    (tmp_path / "small.map").write_text(MOVINGAI)
    (tmp_path / "drive.toml").write_text(SCENARIO)
    return tmp_path


def run(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    """Status, stdout and stderr of a command."""
    try:
        status = main([str(word) for word in words])
    except SystemExit as stop:
        status = int(str(stop.code))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def refused(result: tuple[int, str, str]) -> str:
    """The one line on stderr of bad input."""
    status, out, err = result
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1, err
    return err


def finite(text: str) -> Any:
    """The parsed JSON, which has to be strict."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} in JSON")

    return json.loads(text, parse_constant=refuse)


def test_help_imports_nothing_heavy() -> None:
    script = (
        "import sys\nfrom dynastar.cli import main\n"
        "try:\n    main(['plan', '--help'])\nexcept SystemExit:\n    pass\n"
        "print([m for m in ('numpy', 'numba', 'matplotlib', 'cv2') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "[]"
    assert "examples:" in done.stdout


def test_the_presets_are_the_navigators() -> None:
    assert set(arguments.PRESETS) == set(PRESETS)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = run(capsys, "--version")
    assert status == 0
    assert out.startswith("dynastar ")


def test_plan_as_json(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    where = ["--start", 1.5, 1.5, "--goal", 8.5, 4.5, "--radius", 0.3]
    status, out, _ = run(capsys, "plan", folder / "room.txt", *where, "--json")
    result = finite(out)
    assert status == 0
    assert set(result) == {
        *("planner", "length", "path", "grid_length", "expanded", "turns", "time_ms")
    }
    assert result["planner"] == "improved"
    assert result["path"][0] == [1.5, 1.5]
    assert result["path"][-1] == [8.5, 4.5]
    assert 7.0 < result["length"] <= result["grid_length"] + 1e-9
    assert result["time_ms"] > 0.0


def test_plan_says_from_where_on_the_path_keeps_the_radius(
    capsys: pytest.CaptureFixture[str], folder: Path
) -> None:
    words = ["plan", folder / "room.txt", "--start", 1.2, 1.5, "--goal", 8.5, 1.5, "--radius", 0.4]
    status, out, _ = run(capsys, *words)
    assert status == 0
    assert "clear_from" in out
    status, out, _ = run(capsys, *words, "--json")
    assert 0.2 <= json.loads(out)["clear_from"] <= 0.4


def test_plan_fails_where_only_a_door_that_is_too_narrow_leads_on(
    capsys: pytest.CaptureFixture[str], folder: Path
) -> None:
    (folder / "door.txt").write_text(DOOR)
    words = ["plan", folder / "door.txt", "--start", 2, 1.5, "--goal", 11, 3, "--radius", 1]
    status, out, err = run(capsys, *words)
    assert (status, out) == (1, "")
    assert "the widest that would pass has 0.5 m, and (7.5, 2.5) is where it is narrowest" in err


def test_a_tolerance_lets_a_path_end_beside_an_occupied_goal(
    capsys: pytest.CaptureFixture[str], folder: Path
) -> None:
    words = ["plan", folder / "room.txt", "--start", 1.5, 1.5, "--goal", 8.9, 1.5, "--radius", 0.4]
    refused(run(capsys, *words))
    status, out, _ = run(capsys, *words, "--json", "--tolerance", 0.5)
    assert status == 0
    assert json.loads(out)["path"][-1] == pytest.approx([8.6, 1.5], abs=2e-3)


def test_plan_as_a_table_and_a_picture(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    where = ["--start", 1.5, 1.5, "--goal", 8.5, 4.5]
    picture = folder / "plan.png"
    status, out, _ = run(capsys, "plan", folder / "room.txt", *where, "--out", picture)
    assert status == 0
    assert "expanded" in out
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_movingai_map_has_the_coordinates_of_its_file(
    capsys: pytest.CaptureFixture[str], folder: Path
) -> None:
    words = ["plan", folder / "small.map", "--start", 0, 0, "--goal", 3, 2, "--planner", "astar"]
    status, out, _ = run(capsys, *words, "--json")
    result = finite(out)
    assert status == 0
    assert result["path"][0] == [0.5, 0.5]
    assert result["path"][-1] == [3.5, 2.5]
    assert result["grid_length"] == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("start", "said"),
    [((0.5, 1), "integers"), ((5, 0), "off the map"), ((0, -1), "off the map"), ((1, 1), "")],
)
def test_a_bad_cell_of_a_movingai_map(
    capsys: pytest.CaptureFixture[str], folder: Path, start: tuple[float, float], said: str
) -> None:
    line = refused(run(capsys, "plan", folder / "small.map", "--start", *start, "--goal", 3, 2))
    assert said in line


def test_no_path_is_1(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    where = ["--start", 1.5, 1.5, "--goal", 3.5, 1.5]
    status, out, err = run(capsys, "plan", folder / "split.txt", *where, "--json")
    assert (status, out) == (1, "")
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--start", "nan", "1", "--goal", "2", "2"], "finite"),
        (["--start", "1.5", "-inf", "--goal", "2", "2"], "finite"),
        (["--start", "1.5", "-1e3", "--goal", "2", "2"], "off the map"),
        (["--start", "1.5", "1.5", "--goal", "99", "2"], "off the map"),
        (["--start", "0.5", "0.5", "--goal", "2", "2"], ""),
        (["--start", "1.5", "1.5", "--goal", "4.5", "2.5"], ""),
        (["--start", "1.5", "1.5", "--goal", "2", "2", "--radius", "-1"], "negative"),
        (["--start", "1.5", "1.5", "--goal", "2", "2", "--planner", "astra"], "'astar'"),
        (["--start", "1.5", "1.5", "--goal", "2", "2", "--unknown", "maybe"], "blocked"),
        (["--start", "1.5", "--goal", "2", "2"], "--start"),
        (["--start", "1.5", "1.5"], "--goal"),
    ],
)
def test_bad_arguments_of_plan(
    capsys: pytest.CaptureFixture[str], folder: Path, words: list[str], said: str
) -> None:
    assert said in refused(run(capsys, "plan", folder / "room.txt", *words))


@pytest.mark.parametrize("name", ["missing.yaml", "missing.map", "missing.txt", ".", "drive.toml"])
def test_a_map_that_is_none(capsys: pytest.CaptureFixture[str], folder: Path, name: str) -> None:
    refused(run(capsys, "plan", folder / name, "--start", 1, 1, "--goal", 2, 2))


def test_run_writes_its_folder(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    out = folder / "out"
    status, text, err = run(capsys, "run", folder / "drive.toml", "--out", out, "--json")
    summary = finite(text)
    assert status == 0, err
    assert {
        *("outcome", "reason", "time", "length", "turning_points", "min_clearance"),
        *("contacts_moving", "contacts_resting", "replans", "recoveries"),
        *("command_ms_mean", "command_ms_max"),
    } <= set(summary)
    assert summary["outcome"] == "arrived"
    assert finite((out / "summary.json").read_text()) == summary
    assert {path.name for path in out.iterdir()} == {
        *(
            "figure.png",
            "report.html",
            "animation.gif",
            "summary.json",
            "episode.npz",
            "config.json",
        )
    }


def test_run_without_arriving_is_1(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    (folder / "drive.toml").write_text(SCENARIO.replace("60.0", "1.0"))
    words = ["run", folder / "drive.toml", "--out", folder / "out", "--no-gif", "--seed", 3]
    status, text, _ = run(capsys, *words)
    assert status == 1
    assert "timeout" in text
    assert not (folder / "out" / "animation.gif").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("robot", "robto"), "'robot'"),
        (("turtlebot3_burger", "turtlebot_burger"), "turtlebot3_burger"),
        (("room.txt", "rooms.txt"), "rooms.txt"),
        (("[1.5, 1.5]", "[0.5, 0.5]"), "occupied"),
        (("[1.5, 1.5]", "[-1.5, 1.5]"), "off the map"),
        (("60.0", "nan"), "time_limit"),
        (("map =", "map = ="), "TOML"),
    ],
)
def test_bad_scenarios(
    capsys: pytest.CaptureFixture[str], folder: Path, change: tuple[str, str], said: str
) -> None:
    (folder / "drive.toml").write_text(SCENARIO.replace(*change, 1))
    words = ["run", folder / "drive.toml", "--out", folder / "out", "--no-gif"]
    assert said in refused(run(capsys, *words))


@pytest.mark.parametrize("words", [["."], ["missing.toml"], ["room.txt"]])
def test_a_scenario_that_is_none(
    capsys: pytest.CaptureFixture[str], folder: Path, words: list[str]
) -> None:
    refused(run(capsys, "run", folder / words[0], "--out", folder / "out"))


def test_an_out_that_cannot_be_made(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    line = refused(run(capsys, "run", folder / "drive.toml", "--out", folder / "room.txt"))
    assert "--out" in line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["movingia"], "'movingai'"),
        (["movingai", "--data", "nowhere"], "verified_scenarios.csv"),
        (["movingai", "--missions", "0"], "1 or more"),
        (["movingai", "--workers", "x"], "--workers"),
        (["paper", "--select", "a:b"], "--select"),
        (["paper", "--json-out", "nowhere/at/all.json"], "--json-out"),
        (["paper", "--preset", "fast"], "default"),
    ],
)
def test_bad_arguments_of_bench(
    capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    assert said in refused(run(capsys, "bench", *words))


def test_bench_without_data(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DYNASTAR_DATA", raising=False)
    assert "DYNASTAR_DATA" in refused(run(capsys, "bench", "movingai"))


@pytest.mark.data
def test_bench_movingai_finds_every_optimum_asked_for(
    capsys: pytest.CaptureFixture[str], data_dir: Path, folder: Path
) -> None:
    file = folder / "result.json"
    words = ["bench", "movingai", "--data", data_dir, "--select", "0:361:40", "--workers", 1]
    status, _, err = run(capsys, *words, "--json-out", file)
    result = finite(file.read_text())
    assert status == 0, err
    assert result["arrived"] == result["missions"] > 5
    assert result["missions"] + result["skipped"] == 10
    assert result["mean_time"] is None


@pytest.mark.slow
def test_a_reader_that_leaves_is_no_error(folder: Path) -> None:
    words = ["plan", str(folder / "room.txt"), "--start", "1.5", "1.5", "--goal", "8.5", "4.5"]
    command = [sys.executable, "-m", "dynastar", *words, "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
