"""Odd command lines, each answered with one sentence; what a person gets who mistypes something."""

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from dynastar.cli import main
from test_cli import ROOM, SCENARIO, refused, run

PLAN = ["plan", "room.txt", "--start", "1.5", "1.5", "--goal", "7.5", "1.5"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "room.txt").write_text(ROOM)
    (tmp_path / "unknown.txt").write_text(ROOM.replace("#........#\n##", "#......??#\n##"))
    (tmp_path / "drive.toml").write_text(SCENARIO)
    (tmp_path / "loop.yaml").symlink_to("loop.yaml")
    (tmp_path / "map.yaml").write_text(
        f"image: {300 * 'n'}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    (tmp_path / "empty.txt").touch()
    (tmp_path / "folder").mkdir()
    (tmp_path / "pipe").mkdir()
    os.mkfifo(tmp_path / "pipe" / "map.txt")
    os.mkfifo(tmp_path / "pipe" / "drive.toml")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DYNASTAR_DATA", raising=False)
    return tmp_path


SAID = [
    ("plan room.txt --start 1.5 1.5 --goal 7.5 1.5 --raduis 0.2", "did you mean '--radius'?"),
    ("plan room.txt --start 1.5 1.5 90 --goal 7.5 1.5", "one argument too many: '90'"),
    ("plna room.txt", "unknown command 'plna' (did you mean 'plan'?)"),
    ("run drive.toml --preset papr", "did you mean 'paper'?"),
    ("paper tabel1", "did you mean 'table1'?"),
    ("bench barm", "did you mean 'barn'?"),
    ("plan room.txt --start 1.5 1.5 --goal 7.5 1.5 --planner improvd", "did you mean 'improved'?"),
    ("plan . --start 1.5 1.5 --goal 7.5 1.5", "this is a folder, expected a map's file, as"),
    ("plan folder --start 1.5 1.5 --goal 7.5 1.5", "this is a folder, expected a map's file"),
    ("run drive.toml --out room.txt", "that is a file; name a folder"),
    ("plan room.txt --start 1.5 1.5 --goal 7.5 1.5 --out folder", "that is a folder; name a file"),
    ("plan room.txt --start 1.5 1.5 --goal 5.5 2.5", "in an obstacle; the nearest place where"),
    ("plan unknown.txt --start 1.5 1.5 --goal 7.5 1.5", "is in unknown space; the nearest place"),
    ("plan unknown.txt --start 1.5 1.5 --goal 7.5 1.5", "(--unknown free)"),
    ("plan room.txt --start 1.5 1.5 --goal 7.5 1.5 --radius 0.6", "nearer than the radius of 0.6"),
    ("plan room.txt --start 1.5 1.5 --goal 7.5 1.5 --radius 1e308", "expected 0 to 100 m"),
    ("plan room.txt --start 1.5 1.5 --goal 75 1.5", "off the map, which spans x 0 to 10"),
    ("plan loop.yaml --start 1 1 --goal 2 2", "loop.yaml"),
    ("plan map.yaml --start 1 1 --goal 2 2", "File name too long"),
    ("plan empty.txt --start 1 1 --goal 2 2", "empty"),
    ("plan pipe/map.txt --start 1 1 --goal 2 2", "not a regular file"),
    ("run pipe/drive.toml", "not a regular file"),
    ("info nowhere.yaml", "there is no such file"),
    ("info room.txt --out -", "expected a file"),
    ("view some.npz --out -", "expected a file"),
    ("info folder", "this is a folder"),
    ("info loop.yaml", "loop.yaml"),
    ("info room.npz", "there is no such file"),
    ("schema --out folder", "that is a folder"),
    ("schema --out no/where.json", "its folder is not there"),
    ("bench paper --json-out folder", "that is a folder; name a file"),
    ("bench paper --json-out pipe/map.txt", "is no regular file"),
    ("bench paper --missions 0", "too small"),
    ("bench paper --missions 1.5", "1.5"),
    ("bench paper --seed -1", "negative"),
    ("bench paper --missions 1e3", "'1e3': expected a whole number, 1 or more"),
    ("bench paper --seed x", "'x': expected a whole number, 0 or more"),
    ("bench paper --replay x", "'x': expected a mission's number N, or N:R"),
    ("play --port x", "'x': expected 0 to 65535"),
    ("plan room.txt --start x 1 --goal 2 2", "'x': expected a number"),
    ("bench barn", "DYNASTAR_DATA"),
    ("bench barn --data folder", "has no worlds.tar.xz"),
    ("bench compare a.json", "compare"),
    ("bench paper --set dwa.horizn=2", "did you mean 'horizon'?"),
    ("run drive.toml --set latency=5", "legal is from 0 to 1 s"),
    ("run drive.toml --seed one", "one"),
    ("demo offce", "did you mean 'office'?"),
    ("demo --copy folder/../room.txt", "room.txt"),
    ("paper figures --out room.txt", "that is a file; name a folder"),
    ("", "COMMAND"),
    ("--bad", "COMMAND"),
]


@pytest.mark.parametrize(("line", "says"), SAID, ids=[line or "nothing" for line, _ in SAID])
def test_the_answer_says_what_would_be_right(
    capsys: pytest.CaptureFixture[str], folder: Path, line: str, says: str
) -> None:
    assert says in refused(run(capsys, *line.split()))


ODD = ["", " ", "-", "--", "nan", "inf", "-1", "1e400", "0x1", "é", "\0", "a" * 5000, "[1,2]", "*"]


@pytest.mark.parametrize("word", ODD, ids=[repr(word)[:9] for word in ODD])
def test_odd_words_in_any_place_end_in_one_sentence(
    capsys: pytest.CaptureFixture[str], folder: Path, word: str
) -> None:
    lines = [
        ["plan", word, "--start", 1.5, 1.5, "--goal", 7.5, 1.5],
        ["plan", "room.txt", "--start", word, 1.5, "--goal", 7.5, 1.5],
        [*PLAN, "--planner", word],
        [*PLAN, "--radius", f"{word}x"],
        [*PLAN, "--unknown", word],
        ["run", word],
        ["run", "drive.toml", "--set", word],
        ["info", word],
        ["bench", word],
        ["bench", "paper", "--select", f"{word}:x"],
        ["demo", f"{word}x"],
        ["paper", f"{word}x"],
    ]
    for line in lines:
        err = refused(run(capsys, *line))
        assert "Traceback" not in err
        assert len(err) < 6000


class Full:
    """A stream on a full disk."""

    encoding = "utf-8"

    def write(self, text: str) -> int:
        raise OSError(28, "No space left on device")


def test_bad_input_has_its_status_also_where_it_cannot_be_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("sys.stderr", Full())
    assert main(["info", "nope.yaml"]) == 2


def test_info_of_map_scenario_and_episode(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    status, out, _ = run(capsys, "info", "room.txt", "--out", "map.png")
    assert (status, "resolution  1.000 m" in out) == (0, True)
    assert "extent      x 0 to 10, y 0 to 6 m" in out
    status, out, _ = run(capsys, "info", "drive.toml", "--json", "--out", "scene.png")
    assert json.loads(out)["goals"] == "(3.5, 1.5) m"
    assert run(capsys, "run", "drive.toml", "--out", "d", "--no-gif")[0] == 0
    status, out, _ = run(capsys, "info", "d/episode.npz", "--out", "episode.png")
    assert re.search(r"^outcome +arrived", out, re.MULTILINE)
    for name in ("map.png", "scene.png", "episode.png"):
        assert (folder / name).read_bytes()[:4] == b"\x89PNG"


def test_results_have_units(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    _, out, _ = run(capsys, *PLAN)
    assert "length       6.000 m\n" in out
    assert " ms\n" in out


def test_what_is_read_is_not_replaced_by_an_output(
    capsys: pytest.CaptureFixture[str], folder: Path
) -> None:
    Image.fromarray(np.full((30, 40), 254, np.uint8)).save(folder / "room.png")
    (folder / "room.yaml").write_text(
        "image: room.png\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (folder / "room.toml").write_text('map = "room.yaml"\nstart = [1, 1]\ngoal = [3, 2]\n')
    image = (folder / "room.png").as_uri()
    (folder / "room.url.yaml").write_text(
        f"{{image: '{image}', resolution: 0.1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.65, "
        "free_thresh: 0.196}\n"
    )
    before = (folder / "room.png").read_bytes()
    plan = ["plan", "room.yaml", "--start", "1", "1", "--goal", "3", "2"]
    for words in (["info", "room.yaml"], ["info", "room.toml"], ["info", "room.url.yaml"], plan):
        words = [str(folder / word) if word.startswith("room.") else word for word in words]
        assert main([*words, "--out", str(folder / "room.png")]) == 2
        assert "that is what is read here; name another file" in capsys.readouterr().err
        assert main([*words, "--out", str(folder / "a.bmp")]) == 2
        assert "expected a file in .png, .svg, .pdf" in capsys.readouterr().err
    assert (folder / "room.png").read_bytes() == before


def test_a_folder_does_not_hide_a_name_that_is_built_in(
    capsys: pytest.CaptureFixture[str], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    (folder / "jackal").mkdir()
    assert main(["check", "--robot", "jackal", "--no-time"]) in (0, 1)
    assert "0.508 m long" in capsys.readouterr().out
    (folder / "mine").mkdir()
    assert main(["check", "--robot", "mine", "--no-time"]) == 2
    assert "mine: this is a directory" in capsys.readouterr().err


def test_outputs_are_written_through_links(folder: Path) -> None:
    (folder / "real.json").write_text("old")
    (folder / "link.json").symlink_to("real.json")
    assert main(["schema", "--out", "link.json"]) == 0
    assert (folder / "link.json").is_symlink()
    assert "$schema" in json.loads((folder / "real.json").read_text())


def test_a_warning_is_one_line_and_the_command_goes_on(
    capsys: pytest.CaptureFixture[str], folder: Path
) -> None:
    header = (folder / "map.yaml").read_text().replace(300 * "n", "grey.pgm")
    (folder / "grey.yaml").write_text(header)
    (folder / "grey.pgm").write_bytes(b"P5 40 40 255\n" + 800 * b"\xfe" + 800 * b"\xcd")
    status, out, err = run(capsys, "info", "grey.yaml")
    assert (status, "100.0 %" in out) == (0, True)
    assert err.startswith(
        "dynastar: warning: grey.yaml: free_thresh 0.25 makes the grey of unknown"
    )
    assert err.count("\n") == 1
