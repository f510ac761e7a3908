"""The scripts of `make bench`, which CI does not run: each can be loaded, so that none is left behind."""

import importlib
import re
import sys
from pathlib import Path

import pytest

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
