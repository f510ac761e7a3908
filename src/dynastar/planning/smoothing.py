"""Smoothing (end of section III.A): pulls a path taut like a string, then rounds its corners."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.planning.segments import Bytes, is_clear, mask_bytes, norm
from dynastar.planning.taut_kernel import pulled_bend

Points = npt.NDArray[np.float64]

ROUNDS = 30  # in which every corner is pulled; each may halve the corners of open space
FINEST = 0.5  # cells between two corners, or they become one
IN_A_ROW = 4  # corners that are pulled straight from one point in a round
BEVELS = 2  # rounds in which every corner is cut, so at most 4 points come of one
SMALLEST_CUT = 0.05  # cells
STRAIGHT_ENOUGH = 0.9998  # cosine of a bend (about 1 degree) that needs no rounding


@njit(cache=True)
def polyline_length(points: Points) -> float:
    """Length of a polyline (n, 2)."""
    length = 0.0
    for i in range(len(points) - 1):
        length += norm(points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1])
    return length


@njit(cache=True)
def bends(points: Points, line: Points) -> int:
    """Copy a polyline's ends and the points where it bends to ``line``. Returns their number."""
    count = 0
    for i in range(len(points)):
        if 0 < i < len(points) - 1:
            by, bx = points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1]
            ay, ax = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
            if bx * ay == by * ax and by * ay + bx * ax > 0.0:
                continue
        line[count, 0], line[count, 1] = points[i, 0], points[i, 1]
        count += 1
    return count


@njit(cache=True)
def gap(points: Points, i: int, y: float, x: float) -> float:
    """Distance from a polyline's point ``i`` to (y, x)."""
    return norm(y - points[i, 0], x - points[i, 1])


@njit(cache=True)
def leave_out(
    blocked: Bytes, line: Points, n: int, radius: float, moved: npt.NDArray[np.bool_]
) -> int:
    """Drop those corners of the first ``n`` points that a clear straight line can replace.

    Returns the number of points left; ``moved`` marks the neighbours of the dropped ones.
    """
    count = 1
    moved[0] = False
    for i in range(1, n):
        y, x = line[i, 0], line[i, 1]
        dropped = False
        if count >= 2 and is_clear(blocked, line[count - 2, 0], line[count - 2, 1], y, x, radius):
            count -= 1
            moved[count - 1] = dropped = True
        line[count, 0], line[count, 1] = y, x
        moved[count] = dropped
        count += 1
    return count


@njit(cache=True)
def pull_taut(blocked: Bytes, points: Points, radius: float) -> Points:
    """Pull every corner, round after round, until none gets shorter.

    A round pulls a corner once, and only if the corner or a neighbour has moved since the last
    pull. After ``IN_A_ROW`` corners that were pulled straight, the next corner is left for the next
    round. In open space few corners then remain for each round, so long ways stay cheap.
    """
    most = 3 * len(points) + 64
    line, pulled = np.empty((most, 2)), np.empty((most, 2))
    moved, fresh = np.ones(most, np.bool_), np.empty(most, np.bool_)
    kept = np.empty(most, np.bool_)
    n = bends(points, line)
    for _ in range(ROUNDS):
        pulled[0], fresh[0], kept[0] = line[0], False, moved[0]
        count, changed, straightened = 1, False, 0
        for i in range(1, n):
            y, x = line[i, 0], line[i, 1]
            fresh_here = False
            if straightened == IN_A_ROW:
                straightened = 0
            elif count >= 2:
                a, b = count - 2, count - 1
                if moved[i] or fresh[a] or fresh[b] or kept[a] or kept[b]:
                    ay, ax, by, bx = pulled[a, 0], pulled[a, 1], pulled[b, 0], pulled[b, 1]
                    how, py, px, qy, qx = pulled_bend(blocked, ay, ax, by, bx, y, x, radius)
                    straightened = straightened + 1 if how == 0 else 0
                    if how == 0:
                        count = b
                        fresh[a] = fresh_here = changed = True
                    elif how == 1 or (how == 2 and count + 1 + n - i <= most):
                        pulled[b, 0], pulled[b, 1] = py, px
                        fresh[b] = changed = True
                        if how == 2:
                            pulled[count, 0], pulled[count, 1] = qy, qx
                            fresh[count], kept[count] = True, False
                            count += 1
            pulled[count, 0], pulled[count, 1] = y, x
            fresh[count], kept[count] = fresh_here, moved[i]
            count += 1
        n = count
        line, pulled = pulled, line
        moved, fresh = fresh, moved
        if not changed:
            count = leave_out(blocked, line, n, radius, moved)
            if count == n:
                break
            n = count
    return line[:n].copy()


@njit(cache=True)
def join_close(blocked: Bytes, points: Points, radius: float) -> Points:
    """Replace two corners closer than ``FINEST`` by the one where the lines to them meet, if clear."""
    line = points.copy()
    count = 1
    i = 1
    while i < len(points):
        if (
            count >= 2
            and i + 1 < len(points)
            and gap(points, i, line[count - 1, 0], line[count - 1, 1]) < FINEST
        ):
            a, b, c, d = line[count - 2], line[count - 1], points[i], points[i + 1]
            u, t = b - a, c - d
            across = u[1] * t[0] - u[0] * t[1]
            if across != 0.0:
                s = ((d[1] - a[1]) * t[0] - (d[0] - a[0]) * t[1]) / across
                y, x = a[0] + s * u[0], a[1] + s * u[1]
                if (
                    s > 0.0
                    and gap(line, count - 1, y, x) < FINEST
                    and is_clear(blocked, a[0], a[1], y, x, radius)
                    and is_clear(blocked, y, x, d[0], d[1], radius)
                ):
                    line[count - 1, 0], line[count - 1, 1] = y, x
                    i += 1
                    continue
        line[count] = points[i]
        count += 1
        i += 1
    return line[:count].copy()


@njit(cache=True)
def bevel(blocked: Bytes, points: Points, radius: float, largest: float) -> Points:
    """Cut every corner once, up to ``largest`` cells from it, as far as the disc can follow."""
    result = np.empty((2 * len(points), 2))
    result[0] = points[0]
    count = 1
    for i in range(1, len(points) - 1):
        corner = points[i]
        back, ahead = points[i - 1] - corner, points[i + 1] - corner
        back_length, ahead_length = norm(back[0], back[1]), norm(ahead[0], ahead[1])
        cut = min(largest, 0.4 * back_length, 0.4 * ahead_length)
        cosine = -(back[0] * ahead[0] + back[1] * ahead[1]) / max(back_length * ahead_length, 1e-12)
        done = cosine > STRAIGHT_ENOUGH
        while not done and cut >= SMALLEST_CUT:
            a, b = corner + back * (cut / back_length), corner + ahead * (cut / ahead_length)
            done = is_clear(blocked, a[0], a[1], b[0], b[1], radius)
            if done:
                result[count], result[count + 1] = a, b
                count += 2
            cut *= 0.5
        if not done or cosine > STRAIGHT_ENOUGH:
            result[count] = corner
            count += 1
    result[count] = points[-1]
    return result[: count + 1].copy()


@njit(cache=True)
def smooth_kernel(blocked: Bytes, points: Points, radius: float, rounding: float) -> Points:
    """``smooth`` on arrays of one type; returns no points if a given one is not finite."""
    length = polyline_length(points)
    if not math.isfinite(length):
        return np.empty((0, 2))
    smoothed = pull_taut(blocked, points, radius)
    joined = join_close(blocked, smoothed, radius)
    if polyline_length(joined) <= length:
        smoothed = joined
    if rounding > 0.0:
        for _ in range(BEVELS):
            smoothed = bevel(blocked, smoothed, radius, rounding)
    return smoothed


def smooth(
    blocked: npt.ArrayLike,
    points: npt.ArrayLike,
    radius: float,
    rounding: float = 0.0,
) -> Points:
    """A shorter polyline from the first to the last of ``points`` that a disc can follow.

    ``blocked`` is [rows, columns]; ``points`` (n, 2) are (row, column) in fractions of cells;
    ``radius`` of the disc and ``rounding``, the distance from a corner at which its rounding may
    begin, are in cells. The result is never longer, and it keeps the radius from blocked cells if
    the given polyline does; see ``segment_clear`` for what is clear. Raises ValueError for a point,
    radius or rounding that is not finite, and for a radius or rounding below 0.
    """
    line = np.array(points, dtype=np.float64).reshape(-1, 2)
    if not (0.0 <= radius < math.inf and 0.0 <= rounding < math.inf):
        raise ValueError(
            f"radius and rounding are {radius} and {rounding}: expected finite numbers of cells, 0 or more"
        )
    if len(line) < 3:
        return line
    smoothed = smooth_kernel(mask_bytes(blocked), line, float(radius), float(rounding))
    if len(smoothed) == 0:
        bad = line[~np.isfinite(line).all(axis=1)][:1].tolist()
        raise ValueError(f"a polyline to smooth has the point {bad}: expected finite numbers")
    return smoothed
