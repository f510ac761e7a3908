"""Robots that options name."""

from dynastar import io
from dynastar.cli.parsing import path
from dynastar.config import choose
from dynastar.navigator import NavigatorConfig
from dynastar.robot import ROBOTS, Robot


def named_robot(name: str) -> tuple[Robot, NavigatorConfig]:
    """A robot that comes with dynastar, with default settings, or the one in a file."""
    file = path(name)
    if file.suffix or (file.exists() and not (file.is_dir() and name in ROBOTS)):
        return io.load_robot(file)
    return choose(name, ROBOTS, "robot"), NavigatorConfig()
