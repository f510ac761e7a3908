"""Robots that options name."""

from typing import Any

from dynastar import io
from dynastar.cli.parsing import path
from dynastar.config import choose
from dynastar.navigator import NavigatorConfig
from dynastar.robot import ROBOTS, Robot


def robot_arguments(name: str | None, own_period: bool = False) -> list[str]:
    """ROS arguments that give a node the robot that ``--robot`` names; none without it.

    With ``own_period`` the period stays the node's.
    """
    from dynastar.ros.settings import ros_arguments

    if name is None:
        return []
    robot, config = named_robot(name)
    if own_period:
        config = config._replace(period=NavigatorConfig().period)
    return ros_arguments(robot, config)


def named_robot(name: str) -> tuple[Robot, NavigatorConfig]:
    """A robot that comes with dynastar, with default settings, or the one in a file."""
    if _is_file(name):
        return io.load_robot(path(name))
    return choose(name, ROBOTS, "robot"), NavigatorConfig()


def named_faults(name: str) -> dict[str, Any]:
    """What the file that ``--robot`` names tells for the robot's simulation."""
    return io.load_faults(path(name)) if _is_file(name) else {}


def _is_file(name: str) -> bool:
    file = path(name)
    return bool(file.suffix) or (file.exists() and not (file.is_dir() and name in ROBOTS))
