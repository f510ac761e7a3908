"""``dynastar check`` as a process and as a call: sentences, JSON, report, exit status, errors."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from dynastar.cli import main
from recordings import foreign

OWN = """\
latency = 0.1
[robot]
base = "pioneer3dx"
[robot.limits]
v_max = 0.5
[sensor]
range_bound = 0.03
heading_bound = 0.01
"""
TOO_FAST = OWN.replace("v_max = 0.5", "v_max = 3.0\nv_brake = 0.3")
DOOR = "\n".join(
    ["#" * 120, *[f"#{'.' * 58}##{'.' * 58}#"] * 30, *[f"#{'.' * 118}#"] * 8]
    + [*[f"#{'.' * 58}##{'.' * 58}#"] * 30, "#" * 120]
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(OWN)
    Path("fast.toml").write_text(TOO_FAST)
    Path("door.toml").write_text(
        f"map = {{rows = {json.dumps(DOOR.splitlines())}, resolution = 0.1}}\n"
        f"start = [1.0, 1.0]\ngoal = [2.0, 1.0]\n{OWN}"
    )
    return tmp_path


def run(capsys, *words):
    """Status, stdout and stderr of a command."""
    try:
        status = main(["check", *map(str, words)])
    except SystemExit as stop:
        status = int(str(stop.code))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_a_process_checks_a_robot_and_this_computer(folder):
    command = [sys.executable, "-m", "dynastar", "check", "--robot", "mine.toml"]
    done = subprocess.run(
        [*command, "--set", "period=1.0", "--set", "scan_age=2.0"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "On this computer a tick takes" in done.stdout
    *lines, last = done.stdout.splitlines()
    assert last.endswith("0 problem")
    levels = {line[:9].strip() for line in lines}
    assert levels <= {"ok", "warning", ""}
    assert max(map(len, lines)) <= 100


def test_a_problem_is_status_1_and_goes_away_with_what_is_advised(folder, capsys):
    words = "--robot", "fast.toml", "--no-time"
    status, out, _ = run(capsys, *words)
    assert status == 1
    assert "\nproblem  A stop from v_max, 3 m/s" in out
    found = {one["name"]: one for one in json.loads(run(capsys, *words, "--json")[1])["findings"]}
    fastest = re.search(r"Declare v_max = ([\d.]+)", found["braking"]["advice"])[1]
    assert float(fastest) <= found["braking"]["values"]["fastest"]
    Path("fast.toml").write_text(TOO_FAST.replace("3.0", f"{float(fastest)}"))
    assert run(capsys, "--robot", "fast.toml", "--no-time")[0] == 0


def test_json_has_every_finding_with_its_values(folder, capsys):
    status, out, _ = run(capsys, "--scenario", "door.toml", "--no-time", "--json")
    data = json.loads(out)
    assert status == 0
    assert data["level"] in ("ok", "warning")
    assert {"doors", "braking", "beams", "delays", "cells"} <= {f["name"] for f in data["findings"]}
    assert all({"name", "level", "text", "advice", "values"} == set(f) for f in data["findings"])
    [door] = data["passages"]
    assert (door["width"], door["x"]) == (pytest.approx(0.8), pytest.approx(6.0, abs=0.2))


def test_a_robot_and_a_map_that_are_given_replace_those_of_the_scenario(folder, capsys):
    words = ["--scenario", "door.toml", "--robot", "jackal", "--no-time"]
    assert "0.508 m long" in run(capsys, *words)[1]
    Path("open.txt").write_text("\n".join(["." * 30] * 30))
    assert "no passages" in run(capsys, *words, "--map", "open.txt")[1]


def test_a_report_has_its_pictures_and_the_findings(folder, capsys):
    foreign(folder / "bag")
    words = ["--robot", "turtlebot3_burger", "--scenario", "door.toml", "--bag", "bag"]
    status, _, err = run(capsys, *words, "--no-time", "--out", "out/check")
    assert status in (0, 1)
    assert "report.html" in err
    report = Path("out/check/report.html").read_text()
    data = json.loads(Path("out/check/check.json").read_text())
    for finding in data["findings"]:
        assert f'<td class="{finding["level"]}">' in report
        assert finding["name"] in report
    for picture in ("passages.png", "stop.svg", "gaps.svg"):
        assert f'src="{picture}"' in report
        assert Path("out/check", picture).stat().st_size > 1000
    with Image.open("out/check/passages.png") as image:
        assert min(image.size) > 300


def test_without_matplotlib_there_is_a_report_without_pictures(folder):
    code = (
        "import sys; sys.modules['matplotlib'] = None; from dynastar.cli import main; "
        "sys.exit(main(['check', '--robot', 'mine.toml', '--no-time', '--out', 'out']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "without pictures" in done.stderr
    assert "<img" not in Path("out/report.html").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give --robot or --scenario"),
        (["--robot", "pioner3dx"], "did you mean 'pioneer3dx'"),
        (["--robot", "none.toml"], "no such file"),
        (["--robot", "."], "directory"),
        (["--robot", "mine.toml", "--map", "none.yaml"], "none.yaml"),
        (["--robot", "mine.toml", "--bag", "none"], "no such recording"),
        (["--robot", "mine.toml", "--topic", "scan=/a"], "--topic goes with --bag"),
        (["--robot", "mine.toml", "--bag", "none", "--topic", "scan"], "NAME=TOPIC"),
        (["--robot", "mine.toml", "--set", "perod=0.1"], "did you mean 'period'"),
        (["--robot", "mine.toml", "--set", "period=9"], "0.01 to 1"),
        (["--robot", "mine.toml", "--out", "mine.toml"], "--out"),
        (["--scenario", "mine.toml"], "missing key 'map'"),
        (["mine.toml"], "one argument too many"),
    ],
)
def test_bad_input_is_status_2_and_one_line(folder, capsys, words, said):
    status, out, err = run(capsys, *words, "--no-time")
    assert (status, out, len(err.splitlines())) == (2, "", 1), err
    assert said in err
