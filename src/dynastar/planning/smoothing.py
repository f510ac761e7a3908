"""Smoothing (end of section III.A): pulls a path taut like a string, then rounds its corners."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import allocating, inner, njit
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


@allocating
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
        pulled[0, 0], pulled[0, 1] = line[0, 0], line[0, 1]
        fresh[0], kept[0] = False, moved[0]
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


@allocating
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
            ay, ax = line[count - 2, 0], line[count - 2, 1]
            dy, dx = points[i + 1, 0], points[i + 1, 1]
            uy, ux = line[count - 1, 0] - ay, line[count - 1, 1] - ax
            ty, tx = points[i, 0] - dy, points[i, 1] - dx
            across = ux * ty - uy * tx
            if across != 0.0:
                s = ((dx - ax) * ty - (dy - ay) * tx) / across
                y, x = ay + s * uy, ax + s * ux
                if (
                    s > 0.0
                    and gap(line, count - 1, y, x) < FINEST
                    and is_clear(blocked, ay, ax, y, x, radius)
                    and is_clear(blocked, y, x, dy, dx, radius)
                ):
                    line[count - 1, 0], line[count - 1, 1] = y, x
                    i += 1
                    continue
        line[count, 0], line[count, 1] = points[i, 0], points[i, 1]
        count += 1
        i += 1
    return line[:count].copy()


@allocating
def bevel(blocked: Bytes, points: Points, radius: float, largest: float) -> Points:
    """Cut every corner once, up to ``largest`` cells from it, as far as the disc can follow."""
    result = np.empty((2 * len(points), 2))
    count = append(result, 0, points[0, 0], points[0, 1])
    for i in range(1, len(points) - 1):
        y, x = points[i, 0], points[i, 1]
        back_y, back_x = points[i - 1, 0] - y, points[i - 1, 1] - x
        ahead_y, ahead_x = points[i + 1, 0] - y, points[i + 1, 1] - x
        back_length, ahead_length = norm(back_y, back_x), norm(ahead_y, ahead_x)
        cut = min(largest, 0.4 * back_length, 0.4 * ahead_length)
        cosine = -(back_y * ahead_y + back_x * ahead_x) / max(back_length * ahead_length, 1e-12)
        done = cosine > STRAIGHT_ENOUGH
        while not done and cut >= SMALLEST_CUT:
            back, ahead = cut / back_length, cut / ahead_length
            ay, ax = y + back_y * back, x + back_x * back
            by, bx = y + ahead_y * ahead, x + ahead_x * ahead
            done = is_clear(blocked, ay, ax, by, bx, radius)
            if done:
                count = append(result, append(result, count, ay, ax), by, bx)
            cut *= 0.5
        if not done or cosine > STRAIGHT_ENOUGH:
            count = append(result, count, y, x)
    count = append(result, count, points[-1, 0], points[-1, 1])
    return result[:count].copy()


@inner
def append(line: Points, count: int, y: float, x: float) -> int:
    """Write a point to row ``count`` of a line, by numbers: a slice takes long to compile."""
    line[count, 0], line[count, 1] = y, x
    return count + 1


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


def without_repeats(line: Points) -> Points:
    """A polyline (n, 2) without the points that repeat the one before."""
    steps = np.abs(np.diff(line, axis=0)).max(axis=1)
    return line[np.concatenate([[True], steps > 1e-9])]
