"""How near a robot is to a walker, and how the walker goes round the robot."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist, wrap_angle

Floats = npt.NDArray[np.float64]

ROUND_GAP = 0.16  # m between the circle of a detour and the robot's circumscribed circle
SAMPLE = 0.1  # s between the points of a script in the search for its way out
SEARCHED = 30.0  # s of the script that are searched
ARC_STEP = 0.1  # rad between two points of a detour


class Encounter(NamedTuple):
    """Gap (m) between footprint and walker, and speed (m/s) of its nearest point to the walker."""

    gap: float
    approach: float


class Detour:
    """A path (k, 2) m, walked at ``speed`` (m/s), to where the script is at ``clock`` (s)."""

    def __init__(self, points: Floats, clock: float, speed: float) -> None:
        self.clock, self.speed = clock, speed
        self._points, self._walked = points, 0.0
        self._arc = np.concatenate([[0.0], np.hypot(*np.diff(points, axis=0).T).cumsum()])

    @property
    def done(self) -> bool:
        """Whether its end is reached."""
        return self._walked >= float(self._arc[-1])

    def walk(self, seconds: float) -> Floats:
        """The place (2,) so many seconds on."""
        self._walked += self.speed * seconds
        return np.array([np.interp(self._walked, self._arc, axis) for axis in self._points.T])


def encounter(
    pose: Pose2D, twist: Twist, footprint: Footprint, centre: Floats, radius: float
) -> Encounter:
    """Gap from a footprint at ``pose`` to a disc, and how fast its nearest point comes nearer."""
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    dx, dy = centre - pose[:2]
    x, y = cos * dx + sin * dy, cos * dy - sin * dx
    if footprint.is_disc:
        away = math.hypot(x, y)
        along = x / away if away > 0.0 else 1.0
        return Encounter(away - footprint.circumscribed - radius, twist.v * along)
    near_x, near_y, inside = _nearest_point(footprint.vertices, x, y)
    away = math.hypot(x - near_x, y - near_y)
    sign = -1.0 if inside else 1.0
    scale = sign / away if away > 0.0 else 0.0
    nx, ny = scale * (x - near_x), scale * (y - near_y)
    approach = (twist.v - twist.omega * near_y) * nx + twist.omega * near_x * ny
    return Encounter(sign * away - radius, approach)


def _nearest_point(vertices: Floats, x: float, y: float) -> tuple[float, float, bool]:
    """The nearest point of a polygon's outline (k, 2) to (x, y), and whether (x, y) is inside."""
    edges = np.roll(vertices, -1, axis=0) - vertices
    offset = np.array([x, y]) - vertices
    share = np.clip((offset * edges).sum(axis=1) / (edges**2).sum(axis=1), 0.0, 1.0)
    nearest = vertices + share[:, np.newaxis] * edges
    index = int(np.argmin(np.hypot(x - nearest[:, 0], y - nearest[:, 1])))
    inside = (edges[:, 0] * offset[:, 1] - edges[:, 1] * offset[:, 0] >= 0.0).all()
    return float(nearest[index, 0]), float(nearest[index, 1]), bool(inside)


def find_detour(
    start: Floats,
    radius: float,
    robot: tuple[Floats, float],
    script: tuple[Callable[[float], Floats], float],
    gaps: Callable[[Floats], Floats],
) -> tuple[Floats, float] | None:
    """Path (k, 2) round the robot and the script's time at its end; None where no side is free.

    ``robot`` is its centre (2,) and circumscribed radius, ``script`` the walker's place by time and
    the time from which on it is searched for the way out of the circle of the detour. A walker whose
    script ends before that, since it is gone then, has no detour to make: the path is ``start``.
    """
    centre, reach = robot
    ring = reach + radius + ROUND_GAP
    place_at, begun = script
    for clock in begun + SAMPLE * np.arange(round(SEARCHED / SAMPLE)):
        out = place_at(clock)
        if np.isnan(out).any():
            return start[np.newaxis], float(clock)
        if math.dist(out, centre) >= ring:
            break
    else:
        return None
    begin, end = (math.atan2(y, x) for x, y in (start - centre, out - centre))
    turn = wrap_angle(end - begin)
    for side in (turn, turn - math.copysign(math.tau, turn)):
        angles = begin + np.linspace(0.0, side, math.ceil(abs(side) / ARC_STEP) + 1)
        around = centre + ring * np.column_stack([np.cos(angles), np.sin(angles)])
        if gaps(around).min() >= radius:
            return np.vstack([start, around, out]), float(clock)
    return None
