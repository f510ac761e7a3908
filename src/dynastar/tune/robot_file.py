"""A robot with its declared settings as the tables of a file for ``--robot``."""

from collections.abc import Mapping
from typing import Any

from dynastar.navigator import NavigatorConfig
from dynastar.navigator.config import changes
from dynastar.robot import ROBOTS, Robot

UNKNOWN = "pioneer3dx"  # base of the file where the robot is not known


def robot_tables(robot: Robot) -> dict[str, Any]:
    """The tables [robot] and [sensor] of a robot."""
    footprint: dict[str, Any] = {"radius": robot.footprint.circumscribed}
    if not robot.footprint.is_disc:
        footprint = {"polygon": robot.footprint.vertices.tolist()}
    base = robot.name if robot.name in ROBOTS else UNKNOWN
    return {
        "robot": {"base": base, **footprint, "limits": robot.limits._asdict()},
        "sensor": robot.lidar._asdict(),
    }


def declared_table(
    robot: Robot | None, config: NavigatorConfig, faults: Mapping[str, Any]
) -> dict[str, Any] | None:
    """The file of a robot with its settings that are not the default, and ``faults`` for its simulation.

    None without a robot.
    """
    if robot is None:
        return None
    return {**robot_tables(robot), **faults, "navigator": changes(NavigatorConfig(), config)}
