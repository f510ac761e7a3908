"""``dynastar bench`` and ``--set`` as others call them."""

import json
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from dynastar.bench import scoreboard
from dynastar.errors import InputError
from test_cli import SCENARIO, finite, folder, refused, run

__all__ = ["folder"]  # a fixture

FILES = {"figure.png", "animation.gif", "summary.json", "episode.npz", "config.json", "report.html"}


def small_result(outcomes: list[str]) -> str:
    rows = [{"number": n, "outcome": outcome} for n, outcome in enumerate(outcomes)]
    return json.dumps({"suite": "small", "rows": rows})


def test_a_mission_is_run_kept_and_replayed(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file, again = tmp_path / "result.json", tmp_path / "again"
    words = ["bench", "random", "--select", "0", "--workers", 1, "--set", "goal_tolerance=0.3"]
    status, out, err = run(capsys, *words, "--json-out", file)
    assert status == 0, err
    result = finite(file.read_text())
    assert result["settings"] == {"goal_tolerance": 0.3}
    assert not (tmp_path / "result.json.rows.jsonl").exists()
    words = ["bench", "random", "--replay", "0", "--set", "goal_tolerance=0.3", "--out", again]
    status, out, err = run(capsys, *words, "--json-out", "-")
    assert status == 0, err
    (row,) = result["rows"]
    replayed = finite(out)
    for timed in ("command_ms_mean", "command_ms_max", "tick_ms_median", "tick_ms_p99"):
        assert replayed.pop(timed) != row.pop(timed)
    assert replayed == row
    assert {path.name for path in again.iterdir()} == FILES
    config = finite((again / "config.json").read_text())
    assert config["config"]["goal_tolerance"] == 0.3


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["paper", "--set", "dwa.horzion=2"], "'horizon'"),
        (["paper", "--set", "dwa.horizon"], "KEY=VALUE"),
        (["paper", "--controller", "pure_persuit"], "'pure_pursuit'"),
        (["paper", "--json-out", "."], "that is a folder"),
        (["paper", "--save-failures", "file"], "--save-failures file"),
        (["paper", "--replay", "1"], "leaves out mission 1"),
        (["paper", "--replay", "x"], "--replay"),
        (["paper", "--replay", "0", "--out", "file"], "--out file"),
        (["paper", "--out", "somewhere"], "--out"),
        (["paper", "file"], "only `bench compare` takes files"),
        (["paper", "--quick", "--missions", "3"], "--quick"),
        (["paper", "--dask", "nowhere", "--missions", "1"], "--dask nowhere"),
        (["movingai", "--replay", "0"], "drives nothing"),
        (["office", "--replay", "1000000"], "has no mission 1000000"),
        (["office", "--replay", "0", "--missions", "2"], "--missions has no effect"),
        (["office", "--replay", "0", "--save-failures", "."], "--save-failures has no effect"),
        (["office", "--replay", "0", "--workers", "2"], "--workers has no effect"),
        (["office", "--no-gif"], "--no-gif leaves out the animation of --replay N alone"),
        (["movingai", "--ideal"], "--ideal has no effect"),
        (["movingai", "--attention", "none"], "--attention has no effect"),
        (["all", "--select", "3"], "--select goes with one suite"),
        (["random", "--quick", "--seed", "10000"], "--seed 10000 is a report seed"),
        (["all", "--quick", "--seed", "12345"], "--seed 12345 is a report seed"),
        (["all", "--set", "horizon=2"], "horizon"),
        (["paper", "--data", "nowhere"], "--data has no effect: the suite paper reads no data"),
        (["paper", "--controller", ""], "unknown controller ''"),
        (
            ["compare", "file", "file", "--missions", "3"],
            "--missions has no effect with `bench comp",
        ),
        (["compare", "file", "file", "--replay", "2"], "--replay has no effect"),
        (["compare", "file", "file", "--quick"], "--quick has no effect"),
        (["compare", "a.json"], "two results"),
        (["compare", "a.json", "b.json"], "a.json: there is no such file"),
        (["compare", "file", "file"], "file: the file is empty"),
    ],
)
def test_bad_arguments(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    words: list[str],
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    assert said in refused(run(capsys, "bench", *words))
    assert {path.name for path in tmp_path.iterdir()} <= {"file", "out"}


def test_a_replay_that_fails_and_a_bench_without_a_mission_leave_older_files(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("episode.npz", "good.json"):
        (tmp_path / name).write_text("older")
    (tmp_path / "broken.py").write_text("def make(*given):\n    raise ValueError('broken')\n")
    words = ["bench", "office", "--replay", 0, "--out", tmp_path, "--controller"]
    assert "ValueError: broken" in refused(run(capsys, *words, "broken:make"))
    words = ["bench", "paper", "--select", "5:3", "--json-out", tmp_path / "good.json"]
    assert "--select 5:3 names no mission of the suite paper" in refused(run(capsys, *words))
    for name in ("episode.npz", "good.json"):
        assert (tmp_path / name).read_text() == "older"


@pytest.mark.parametrize(
    ("words", "others"),
    [
        ([], scoreboard.COMPETITORS),
        (["--quick"], ("pure_pursuit", "kompass_dwa", "orca")),
        (["--controller", "navigator"], ()),
        (["--quick", "--controller", "printed"], ()),
    ],
)
def test_all_runs_other_controllers_unless_one_is_named(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    words: list[str],
    others: tuple[str, ...],
) -> None:
    asked = []

    def run_all(options: Any, **more: Any) -> Any:
        asked.append((options.controller, more["others"]))
        raise InputError("enough")

    monkeypatch.setattr(scoreboard, "run_all", run_all)
    assert "enough" in refused(run(capsys, "bench", "all", "--out", tmp_path / "out", *words))
    assert asked == [(words[-1] if "--controller" in words else "navigator", others)]


def test_compare(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    first, second, file = (tmp_path / f"{name}.json" for name in ("a", "b", "out"))
    first.write_text(small_result(["timeout"] * 6))
    second.write_text(small_result(["arrived"] * 6))
    status, out, _ = run(capsys, "bench", "compare", first, second, "--json-out", file)
    assert status == 0
    assert out.startswith("small: better: 6 missions gained, 0 lost (p = 0.031)")
    assert finite(file.read_text())["suites"]["small"]["gained"] == list(range(6))
    status, out, _ = run(capsys, "bench", "compare", first, first, "--json-out", "-")
    assert finite(out)["suites"]["small"]["changed"] == []
    before = first.read_bytes()
    words = ["bench", "compare", first, second, "--json-out", first]
    assert "that is what is read here" in refused(run(capsys, *words))
    assert first.read_bytes() == before
    second.write_text(small_result(["arrived"] * 5))
    assert "only the first file has 5" in refused(run(capsys, "bench", "compare", first, second))


def test_run_takes_settings(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    (folder / "drive.toml").write_text(SCENARIO + "[navigator]\nperiod = 0.2\n")
    words = ["run", folder / "drive.toml", "--out", folder / "out", "--no-gif", "--json"]
    status, _, err = run(capsys, *words, "--set", "dwa.horizon=2.5", "--set", "reverse=false")
    assert status == 0, err
    config = finite((folder / "out" / "config.json").read_text())
    assert config["config"]["dwa"]["horizon"] == 2.5
    assert (config["config"]["reverse"], config["config"]["period"]) == (False, 0.2)
    assert config["scenario"]["navigator"]["dwa"] == {"horizon": 2.5}
    assert "'period'" in refused(run(capsys, *words, "--set", "peroid=0.1"))


def test_paper_takes_settings_where_they_matter(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ["paper", "--out", tmp_path, "--set"]
    assert "'horizon'" in refused(run(capsys, *words, "dwa.horizno=2"))
    assert "table1" in refused(run(capsys, "paper", "table1", *words[1:], "dwa.horizon=2"))


def test_a_run_that_is_interrupted_goes_on(tmp_path: Path) -> None:
    file, kept = tmp_path / "result.json", tmp_path / "result.json.rows.jsonl"
    script = Path(__file__).with_name("interrupted_bench.py")
    words = ["bench", "interrupted", "--data", tmp_path, "--workers", "2", "--json-out", file]
    bench = partial(
        subprocess.run,
        [sys.executable, script, *words],
        capture_output=True,
        start_new_session=True,
    )
    done = bench()
    assert done.returncode == 130, done.stderr
    assert done.stderr.splitlines()[-1] == b"dynastar: interrupted"
    assert not file.exists()
    _, first = map(json.loads, kept.read_text().splitlines())
    (tmp_path / "again").touch()
    assert bench().returncode == 0
    rows = json.loads(file.read_text())["rows"]
    assert [row["number"] for row in rows] == [0, 1, 2, 3]
    assert rows[0] == {key: first["row"][key] for key in rows[0]}  # by the same process: not again
    assert not kept.exists()
