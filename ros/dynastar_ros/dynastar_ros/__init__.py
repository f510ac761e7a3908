"""Executables, launch files and settings of dynastar's nodes, which are in the Python package dynastar."""

import sys

from dynastar.cli import main


def navigator() -> int:
    """Runs ``dynastar ros`` with the arguments of a launch file."""
    return main(["ros", *sys.argv[1:]])


def simulator() -> int:
    """Runs ``dynastar ros-sim`` with the arguments of a launch file."""
    return main(["ros-sim", *sys.argv[1:]])


def guard() -> int:
    """Runs ``dynastar ros-guard`` with the arguments of a launch file."""
    return main(["ros-guard", *sys.argv[1:]])
