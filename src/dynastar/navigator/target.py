"""The local target: where the local window meets the global path (section V, step 2)."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.dwa import Surroundings
from dynastar.dwa.clearance_kernels import centre_clearance
from dynastar.geometry import Pose2D, wrap_angle
from dynastar.path import Path

SPACING = 0.1  # m between the points of the path that are tried
AWAY = math.radians(65.0)  # off the straight way from what is too near
NEAREST = 0.4  # m, a target to steer by is further
BEHIND = 2.8  # rad off the heading from which a target is as good as behind


@njit(cache=True)
def _sees(field, x0, y0, resolution, clearance, ax, ay, bx, by):
    """Whether the straight line from a to b keeps ``clearance`` from everything not observed free."""
    length = math.hypot(bx - ax, by - ay)
    n = max(1, int(math.ceil(2.0 * length / resolution)))
    for i in range(1, n + 1):
        x, y = ax + (bx - ax) * i / n, ay + (by - ay) * i / n
        column, row = int(math.floor((x - x0) / resolution)), int(math.floor((y - y0) / resolution))
        if not (0 <= row < field.shape[0] and 0 <= column < field.shape[1]):
            return False
        if field[row, column] < clearance:
            return False
    return True


@njit(cache=True)
def farthest_visible(field, x0, y0, resolution, clearance, x, y, points):
    """Index of the farthest of ``points`` (n, 2), in the path's order, that (x, y) sees; or -1."""
    for i in range(len(points) - 1, -1, -1):
        if _sees(field, x0, y0, resolution, clearance, x, y, points[i, 0], points[i, 1]):
            return i
    return -1


def local_target(
    path: Path,
    s: float,
    position: tuple[float, float],
    lookahead: float,
    clearances: tuple[float, ...],
    around: Surroundings,
) -> tuple[tuple[float, float], bool]:
    """The farthest point of the path that can be seen up to ``lookahead`` metres on from ``s``.

    A line of sight has to keep the first of ``clearances`` (m, falling) that any point allows. With
    the target, whether there is any; if there is none far enough to steer by, the path just ahead.
    """
    points: npt.NDArray[np.float64] = path.resampled(s, s + lookahead, SPACING)
    field = around.field, around.x0, around.y0, around.resolution
    for clearance in clearances:
        i = farthest_visible(*field, clearance, *position, points)
        if i >= 0 and (i == len(points) - 1 or math.dist(points[i], position) > NEAREST):
            return (float(points[i, 0]), float(points[i, 1])), True
    return path.at(s + NEAREST), False


def leading_away(
    target: tuple[float, float], position: tuple[float, float], around: Surroundings
) -> tuple[float, float]:
    """A target for a robot that stands too near to something: towards ``target``, but not nearer.

    The direction is the one nearest to the target's among those up to ``AWAY`` off the field's
    gradient, which points away from what is near.
    """
    x, y = position
    h = around.resolution
    field = around.field, around.x0, around.y0, around.resolution
    gx = centre_clearance(*field, x + h, y) - centre_clearance(*field, x - h, y)
    gy = centre_clearance(*field, x, y + h) - centre_clearance(*field, x, y - h)
    if math.hypot(gx, gy) < 0.2 * h:
        return target  # as near on the other side
    away = math.atan2(gy, gx)
    off = wrap_angle(math.atan2(target[1] - y, target[0] - x) - away)
    heading = away + max(-AWAY, min(AWAY, off))
    return x + NEAREST * math.cos(heading), y + NEAREST * math.sin(heading)


def on_one_side(
    target: tuple[float, float], pose: Pose2D, omega: float
) -> tuple[tuple[float, float], float]:
    """The target and its bearing (rad) off the pose's heading.

    Behind the robot it is taken to lie on the side that it turns to already, or it would dither.
    """
    bearing = wrap_angle(math.atan2(target[1] - pose.y, target[0] - pose.x) - pose.theta)
    if abs(bearing) <= BEHIND:
        return target, bearing
    bearing = BEHIND if omega >= 0.0 else -BEHIND
    return at_bearing(pose, bearing), bearing


def at_bearing(pose: Pose2D, bearing: float) -> tuple[float, float]:
    """A target (m) two metres away at ``bearing`` (rad) off the pose's heading."""
    theta = pose.theta + bearing
    return pose.x + 2.0 * math.cos(theta), pose.y + 2.0 * math.sin(theta)
