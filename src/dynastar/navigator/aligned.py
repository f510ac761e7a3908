"""Turning between the map frame and the navigator's own, whose axes run along the map's cells.

Both have the same origin. They are the same for a map without yaw: then nothing is computed.
"""

import math
from collections.abc import Iterable
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from dynastar.config import shown
from dynastar.geometry import Goal, Pose2D, wrap_angle
from dynastar.path import Path
from dynastar.perception import MovingObstacle, Track

Floats = npt.NDArray[np.float64]
Disc = TypeVar("Disc", MovingObstacle, Track)

LARGEST = MovingObstacle(1e6, 1e6, 1e3, 1e3, 1e3)  # m and m/s, of one that a caller gives


def as_moving(
    movers: Iterable[MovingObstacle] | None, angle: float
) -> tuple[list[MovingObstacle] | None, str | None]:
    """Moving obstacles as floats, turned about the origin by an angle (rad), and a fault or None.

    One with a number that is not finite, or absurd, is a fault.
    """
    if movers is None:
        return None, None
    expected = "expected MovingObstacle(x, y, vx, vy, radius), all numbers"
    try:
        given = [MovingObstacle(*map(float, mover)) for mover in movers]
    except (TypeError, ValueError, OverflowError):
        return None, f"the moving obstacles are {shown(movers)}: {expected}"
    for one in given:
        if not _is_usable(one):
            most = f"none beyond {tuple(map(int, LARGEST))}, the radius not negative"
            return None, f"a moving obstacle is {tuple(one)}: {expected}, {most}"
    return [turned_disc(one, angle) for one in given], None


def _is_usable(one: MovingObstacle) -> bool:
    """Whether a moving obstacle that was given has finite numbers, none of them absurd."""
    within = (abs(value) <= most for value, most in zip(one, LARGEST, strict=True))
    return all(within) and one.radius >= 0.0


def turned(points: Floats, angle: float) -> Floats:
    """Points (n, 2) turned about the origin by an angle (rad)."""
    if angle == 0.0:
        return points
    cos, sin = math.cos(angle), math.sin(angle)
    return points @ np.array([[cos, sin], [-sin, cos]])


def turned_pose(pose: Pose2D, angle: float) -> Pose2D:
    """A pose turned about the origin by an angle (rad)."""
    if angle == 0.0:
        return pose
    x, y = turned(np.array(pose[:2]), angle).tolist()
    return Pose2D(x, y, wrap_angle(pose.theta + angle))


def turned_goal(goal: Goal, angle: float) -> Goal:
    """A goal turned about the origin by an angle (rad)."""
    x, y, heading = turned_pose(Pose2D(goal.x, goal.y, goal.heading or 0.0), angle)
    return Goal(x, y, None if goal.heading is None else heading)


def turned_path(path: Path, angle: float) -> Path:
    """A path turned about the origin by an angle (rad)."""
    return path if angle == 0.0 else Path(turned(path.points, angle))


def turned_disc(disc: Disc, angle: float) -> Disc:
    """A disc with its velocity turned about the origin by an angle (rad)."""
    if angle == 0.0:
        return disc
    (x, y), (vx, vy) = turned(np.array([[disc.x, disc.y], [disc.vx, disc.vy]]), angle).tolist()
    return disc._replace(x=x, y=y, vx=vx, vy=vy)
