"""The scripts of `benchmarks`, most of which CI does not run: each can be loaded, one draws its picture."""

import importlib
import re
import sys
from pathlib import Path

import pytest
from PIL import Image

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
OTHERS = "rclpy", "gymnasium"  # of the environments in which these scripts are run
NAMES = sorted(file.stem for file in BENCHMARKS.glob("*.py"))
sys.path.append(str(BENCHMARKS))


@pytest.mark.parametrize("name", NAMES)
def test_a_script_finds_all_that_it_imports(name):
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name not in OTHERS:
            raise
        pytest.skip(f"{error.name} is not installed")


def test_make_bench_names_scripts_that_are_there():
    named = re.findall(r"benchmarks/(\w+)\.py", (BENCHMARKS.parent / "Makefile").read_text())
    assert len(named) > 5
    assert set(named) <= set(NAMES)


def test_the_picture_of_a_tick_is_drawn(tmp_path, monkeypatch, capsys):
    picture = tmp_path / "tick.png"
    monkeypatch.setattr(sys, "argv", ["how_it_drives.py", "--out", str(picture)])
    importlib.import_module("how_it_drives").main()
    assert "refused: {" in capsys.readouterr().out
    with Image.open(picture) as drawn:
        assert drawn.width > 800
