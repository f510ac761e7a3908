"""What a navigator is given, checked: its parts, and a path to follow."""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.geometry import Goal, as_goal
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.pose_history import FARTHEST
from dynastar.path import Path
from dynastar.robot import ROBOTS, Limits, Robot

LONGEST_PATH = 1e5  # m of a path to follow


def as_robot(grid: Any, robot: Any, config: Any) -> Robot:
    """The robot as it may drive, by its name or itself; InputError for a part of a wrong type.

    A drive that is faster than told by ``drive_error`` also has to brake so much harder than told, and
    its brakes are only as strong as declared. So it is told to brake so much more gently.
    """
    robot = choose(robot, ROBOTS, "robot") if isinstance(robot, str) else robot
    for what, value, kind in (
        ("a map", grid, OccupancyGrid),
        ("a robot", robot, Robot),
        ("a navigator's settings", config, NavigatorConfig),
    ):
        if not isinstance(value, kind):
            names = f", or one of {', '.join(ROBOTS)}" if kind is Robot else ""
            expected = f"{kind.__name__}{names}"
            raise InputError(f"{what}: got {type(value).__name__}, expected {expected}")
    assert isinstance(robot, Robot)
    limits, faster = robot.limits, 1.0 + config.drive_error
    told = limits._asdict() | {
        "v_min": limits.v_min if config.reverse else max(limits.v_min, 0.0),
        "v_brake": limits.v_brake / faster,
        "omega_brake": limits.omega_brake / faster,
    }
    return replace(robot, limits=Limits._make(told.values()))  # perhaps below what may be declared


def as_given_path(path: Path | npt.ArrayLike, heading: float | None) -> tuple[Path, Goal]:
    """A path to follow, and its end as a goal. Raises InputError as ``Navigator.follow``."""
    path = path if isinstance(path, Path) else Path(path)  # type: ignore[arg-type]
    far = float(np.abs(path.points).max())
    if far > FARTHEST or path.length > LONGEST_PATH:
        raise InputError(
            f"a path is {path.length:g} m long and leads {far:g} m from the map's origin: expected "
            f"at most {LONGEST_PATH:g} m, within {FARTHEST:g} m"
        )
    return path, as_goal((*path.points[-1].tolist(), heading))
