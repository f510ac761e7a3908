"""Smoothing (end of section III.A): pulls a path taut like a string, then rounds its corners."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import allocating, inner, njit
from dynastar.planning.segments import Bytes, CellPoint, distance, is_clear, mask_bytes, norm
from dynastar.planning.taut_kernel import Part, pulled_bend

Points = npt.NDArray[np.float64]

ROUNDS = 30  # in which every corner is pulled; each may halve the corners of open space
FINEST = 0.5  # cells between two corners, or they become one
IN_A_ROW = 4  # corners that are pulled straight from one point in a round
BEVELS = 2  # rounds in which every corner is cut, so at most 4 points come of one
SMALLEST_CUT = 0.05  # cells
STRAIGHT_ENOUGH = 0.9998  # cosine of a bend (about 1 degree) that needs no rounding


@inner
def point(points: Points, i: int) -> CellPoint:
    """Row ``i`` of a polyline."""
    return CellPoint(points[i, 0], points[i, 1])


@inner
def put(line: Points, i: int, at: CellPoint) -> None:
    """Write a point to row ``i`` of a polyline, by numbers: a slice takes long to compile."""
    line[i, 0], line[i, 1] = at.y, at.x


@inner
def append(line: Points, count: int, at: CellPoint) -> int:
    """Write a point after the first ``count`` points of a polyline. Returns the new number."""
    put(line, count, at)
    return count + 1


@njit(cache=True)
def polyline_length(points: Points) -> float:
    """Length of a polyline (n, 2)."""
    length = 0.0
    for i in range(len(points) - 1):
        length += distance(point(points, i), point(points, i + 1))
    return length


@njit(cache=True)
def bends(points: Points, line: Points) -> int:
    """Copy a polyline's ends and the points where it bends to ``line``. Returns their number."""
    count = 0
    for i in range(len(points)):
        here = point(points, i)
        if 0 < i < len(points) - 1:
            before, after = point(points, i - 1), point(points, i + 1)
            by, bx = here.y - before.y, here.x - before.x
            ay, ax = after.y - here.y, after.x - here.x
            if bx * ay == by * ax and by * ay + bx * ax > 0.0:
                continue
        count = append(line, count, here)
    return count


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
        here = point(line, i)
        dropped = False
        if count >= 2 and is_clear(blocked, point(line, count - 2), here, radius):
            count -= 1
            moved[count - 1] = dropped = True
        moved[count] = dropped
        count = append(line, count, here)
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
        put(pulled, 0, point(line, 0))
        fresh[0], kept[0] = False, moved[0]
        count, changed, straightened = 1, False, 0
        for i in range(1, n):
            here, fresh_here = point(line, i), False
            if straightened == IN_A_ROW:
                straightened = 0
            elif count >= 2:
                a, b = count - 2, count - 1
                if moved[i] or fresh[a] or fresh[b] or kept[a] or kept[b]:
                    part = Part(point(pulled, a), point(pulled, b), here)
                    bend = pulled_bend(blocked, part, radius)
                    straightened = straightened + 1 if bend.number == 0 else 0
                    if bend.number == 0:
                        count = b
                        fresh[a] = fresh_here = changed = True
                    elif bend.number == 1 or (bend.number == 2 and count + 1 + n - i <= most):
                        put(pulled, b, bend.first)
                        fresh[b] = changed = True
                        if bend.number == 2:
                            put(pulled, count, bend.last)
                            fresh[count], kept[count] = True, False
                            count += 1
            put(pulled, count, here)
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


@inner
def crossing(a: CellPoint, b: CellPoint, c: CellPoint, d: CellPoint) -> tuple[bool, CellPoint]:
    """Whether the ray from a by b meets the line c - d, and where."""
    uy, ux = b.y - a.y, b.x - a.x
    ty, tx = c.y - d.y, c.x - d.x
    across = ux * ty - uy * tx
    s = 0.0
    if across != 0.0:
        s = ((d.x - a.x) * ty - (d.y - a.y) * tx) / across
    return s > 0.0, CellPoint(a.y + s * uy, a.x + s * ux)


@allocating
def join_close(blocked: Bytes, points: Points, radius: float) -> Points:
    """Replace two corners closer than ``FINEST`` by the one where the lines to them meet, if clear."""
    line = points.copy()
    count = 1
    i = 1
    while i < len(points):
        here = point(points, i)
        if count >= 2 and i + 1 < len(points) and distance(here, point(line, count - 1)) < FINEST:
            a, b, d = point(line, count - 2), point(line, count - 1), point(points, i + 1)
            meets, corner = crossing(a, b, here, d)
            if (
                meets
                and distance(b, corner) < FINEST
                and is_clear(blocked, a, corner, radius)
                and is_clear(blocked, corner, d, radius)
            ):
                put(line, count - 1, corner)
                i += 1
                continue
        count = append(line, count, here)
        i += 1
    return line[:count].copy()


@allocating
def bevel(blocked: Bytes, points: Points, radius: float, largest: float) -> Points:
    """Cut every corner once, up to ``largest`` cells from it, as far as the disc can follow."""
    result = np.empty((2 * len(points), 2))
    count = append(result, 0, point(points, 0))
    for i in range(1, len(points) - 1):
        before, here, after = point(points, i - 1), point(points, i), point(points, i + 1)
        back_y, back_x = before.y - here.y, before.x - here.x
        ahead_y, ahead_x = after.y - here.y, after.x - here.x
        back_length, ahead_length = norm(back_y, back_x), norm(ahead_y, ahead_x)
        cut = min(largest, 0.4 * back_length, 0.4 * ahead_length)
        cosine = -(back_y * ahead_y + back_x * ahead_x) / max(back_length * ahead_length, 1e-12)
        done = cosine > STRAIGHT_ENOUGH
        while not done and cut >= SMALLEST_CUT:
            back, ahead = cut / back_length, cut / ahead_length
            a = CellPoint(here.y + back_y * back, here.x + back_x * back)
            b = CellPoint(here.y + ahead_y * ahead, here.x + ahead_x * ahead)
            done = is_clear(blocked, a, b, radius)
            if done:
                count = append(result, append(result, count, a), b)
            cut *= 0.5
        if not done or cosine > STRAIGHT_ENOUGH:
            count = append(result, count, here)
    count = append(result, count, point(points, -1))
    return result[:count].copy()


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
