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
from dynastar.robot import ROBOTS, Robot

LONGEST_PATH = 1e5  # m of a path to follow


def as_robot(grid: Any, robot: Any, config: Any) -> Robot:
    """The robot as it may drive, by its name or itself; InputError for a part of a wrong type."""
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
    if config.reverse:
        return robot
    return replace(robot, limits=robot.limits._replace(v_min=max(robot.limits.v_min, 0.0)))


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
