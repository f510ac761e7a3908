"""Smoothing (end of section III.A): the string is pulled taut, then its corners are rounded."""

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.planning.segments import Bytes, is_clear, mask_bytes

Points = npt.NDArray[np.float64]

PULLS = 8  # at most; most strings are taut after four
SHORTER = 1e-4  # cells; less is no gain
BEVELS = 2  # rounds in which every corner is cut, so at most 4 points come of one
SMALLEST_CUT = 0.05  # cells
STRAIGHT_ENOUGH = 0.9998  # cosine of a bend (about 1 degree) that needs no rounding


@njit(cache=True)
def clear_between(blocked: Bytes, points: Points, i: int, j: int, radius: float) -> bool:
    """Whether a disc can go straight from point ``i`` to point ``j``."""
    return is_clear(blocked, points[i, 0], points[i, 1], points[j, 0], points[j, 1], radius)


@njit(cache=True)
def pull(blocked: Bytes, points: Points, radius: float) -> Points:
    """From every point straight on to one far ahead that can be seen.

    Looking ahead doubles its stride while it sees and then bisects, so it costs the logarithm of
    what it skips; the next point is always within reach.
    """
    kept = np.empty_like(points)
    kept[0] = points[0]
    count, here, last = 1, 0, len(points) - 1
    while here < last:
        seen, unseen = here + 1, last + 1
        while seen < last:
            ahead = min(2 * seen - here, last)
            if not clear_between(blocked, points, here, ahead, radius):
                unseen = ahead
                break
            seen = ahead
        while unseen - seen > 1 and seen < last:
            middle = (seen + unseen) // 2
            if clear_between(blocked, points, here, middle, radius):
                seen = middle
            else:
                unseen = middle
        kept[count] = points[seen]
        count += 1
        here = seen
    return kept[:count].copy()


@njit(cache=True)
def dense_reversed(points: Points) -> Points:
    """The polyline backwards, with a point at least every cell."""
    pieces = np.empty(len(points) - 1, np.int64)
    for i in range(len(points) - 1):
        step = points[i + 1] - points[i]
        pieces[i] = max(1, int(np.ceil(np.hypot(step[0], step[1]))))
    dense = np.empty((pieces.sum() + 1, 2))
    at = len(dense) - 1
    for i in range(len(points) - 1):
        for j in range(pieces[i]):
            dense[at] = points[i] + (points[i + 1] - points[i]) * (j / pieces[i])
            at -= 1
    dense[0] = points[-1]
    return dense


@njit(cache=True)
def polyline_length(points: Points) -> float:
    """Length of a polyline (n, 2)."""
    length = 0.0
    for i in range(len(points) - 1):
        length += np.hypot(points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1])
    return length


@njit(cache=True)
def pull_taut(blocked: Bytes, points: Points, radius: float) -> Points:
    """Pulls forwards and backwards, letting go anywhere on the string, until it gets no shorter."""
    taut = pull(blocked, points, radius)
    length = polyline_length(taut)
    backwards, idle = False, 0
    for _ in range(PULLS):
        if len(taut) < 3 or idle == 2:
            break
        tried = pull(blocked, dense_reversed(taut), radius)
        tried_length = polyline_length(tried)
        backwards = not backwards
        if tried_length < length - SHORTER:
            taut, length, idle = tried, tried_length, 0
        else:
            taut, idle = taut[::-1].copy(), idle + 1
    return taut[::-1].copy() if backwards else taut


@njit(cache=True)
def bevel(blocked: Bytes, points: Points, radius: float, largest: float) -> Points:
    """Cuts every corner once, up to ``largest`` cells from it, as far as the disc can follow."""
    result = np.empty((2 * len(points), 2))
    result[0] = points[0]
    count = 1
    for i in range(1, len(points) - 1):
        corner = points[i]
        back, ahead = points[i - 1] - corner, points[i + 1] - corner
        back_length, ahead_length = np.hypot(back[0], back[1]), np.hypot(ahead[0], ahead[1])
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
    """``smooth`` on arrays of one type."""
    smoothed = pull_taut(blocked, points, radius)
    if rounding > 0.0:
        for _ in range(BEVELS):
            smoothed = bevel(blocked, smoothed, radius, rounding)
    return smoothed


def smooth(
    blocked: npt.ArrayLike, points: npt.ArrayLike, radius: float, rounding: float = 0.0
) -> Points:
    """A shorter polyline from the first to the last of ``points`` that a disc can follow.

    ``blocked`` is [rows, columns]; ``points`` (n, 2) are (row, column) in fractions of cells;
    ``radius``, the disc's, and ``rounding``, how far from a corner its rounding may begin, are in
    cells. The result is nowhere closer to a blocked cell than the radius if the polyline given is
    not, and never longer; see ``segment_clear`` for what counts.
    """
    line = np.array(points, dtype=np.float64).reshape(-1, 2)
    if len(line) < 3:
        return line
    return smooth_kernel(mask_bytes(blocked), line, float(radius), float(rounding))
