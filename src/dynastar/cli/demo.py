"""``dynastar demo``: drive an example that comes with dynastar, or copy them all."""

import argparse
import shutil
import sys
from pathlib import Path

from dynastar.cli import run
from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.io.examples import example_scenarios, examples_folder


def execute(arguments: argparse.Namespace) -> int:
    """Runs an example as ``dynastar run`` does, or copies or lists the examples."""
    if arguments.list:
        print("\n".join(example_scenarios()))
        return 0
    if arguments.copy is not None:
        return _copy(arguments.copy)
    choose(arguments.name, example_scenarios(), "example")
    arguments.scenario = example_scenarios()[arguments.name]
    arguments.seed = arguments.preset = arguments.bag = None
    arguments.set = []
    return run.execute(arguments)


def _copy(folder: Path) -> int:
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"--copy {folder}: is there already; expected a new or an empty folder")
    shutil.copytree(
        examples_folder(), folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__")
    )
    print(f"the examples are in {folder}", file=sys.stderr)
    return 0
