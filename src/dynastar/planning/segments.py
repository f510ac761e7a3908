"""Exact tests whether a disc can go along a straight line past the squares of blocked cells.

Everything is in cell coordinates: cell [r, c] is the square from (r, c) to (r + 1, c + 1).
"""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit

Bytes = npt.NDArray[np.uint8]

EPSILON = 5e-10  # cells; a gap this much too small is none


@njit(cache=True)
def norm(y: float, x: float) -> float:
    """Length of (y, x), without the guard against overflow that makes ``hypot`` slow."""
    return math.sqrt(y * y + x * x)


@inner
def crosses_box(
    ay: float, ax: float, by: float, bx: float,
    low_y: float, low_x: float, high_y: float, high_x: float,
) -> bool:  # fmt: skip
    """Whether the segment a - b meets the closed box (Liang-Barsky)."""
    enter, leave = 0.0, 1.0
    for at, step, low, high in ((ay, by - ay, low_y, high_y), (ax, bx - ax, low_x, high_x)):
        if step == 0.0:
            if at < low or at > high:
                return False
            continue
        first, last = (low - at) / step, (high - at) / step
        enter = max(enter, min(first, last))
        leave = min(leave, max(first, last))
    return enter <= leave


@inner
def gap_to_point(ay: float, ax: float, by: float, bx: float, y: float, x: float) -> float:
    """Distance from the segment a - b to a point."""
    dy, dx = by - ay, bx - ax
    square = dy * dy + dx * dx
    t = 0.0
    if square > 0.0:
        t = min(max(((y - ay) * dy + (x - ax) * dx) / square, 0.0), 1.0)
    return norm(ay + t * dy - y, ax + t * dx - x)


@inner
def gap_to_cell(ay: float, ax: float, by: float, bx: float, r: float, c: float) -> float:
    """Distance from the segment a - b to the square of a cell, 0 if they meet."""
    if crosses_box(ay, ax, by, bx, r, c, r + 1.0, c + 1.0):
        return 0.0
    gap = math.inf
    for y, x in ((ay, ax), (by, bx)):
        beyond_y, beyond_x = abs(y - r - 0.5) - 0.5, abs(x - c - 0.5) - 0.5
        gap = min(gap, norm(max(beyond_y, 0.0), max(beyond_x, 0.0)))
    for y, x in ((r, c), (r, c + 1.0), (r + 1.0, c), (r + 1.0, c + 1.0)):
        gap = min(gap, gap_to_point(ay, ax, by, bx, y, x))
    return gap


@inner
def point_is_stopped(
    blocked: Bytes, ay: float, ax: float, by: float, bx: float, r: int, c: int
) -> bool:
    """Whether a point going from a to b enters a blocked cell, or slips between it and another.

    It may touch a blocked cell, but not pass the seam between two that share a side, nor the
    corner that two share diagonally. Each pair is tested from its lower cell.
    """
    e = EPSILON
    rows, columns = blocked.shape
    top, right = r + 1.0, c + 1.0
    has_above, has_right, has_left = r + 1 < rows, c + 1 < columns, c > 0
    top_of_two = top + 1.0 if has_above and blocked[r + 1, c] else top
    right_of_two = right + 1.0 if has_right and blocked[r, c + 1] else right
    if crosses_box(ay, ax, by, bx, r + e, c + e, top_of_two - e, right - e):
        return True
    if crosses_box(ay, ax, by, bx, r + e, c + e, top - e, right_of_two - e):
        return True
    joined_right = has_above and has_right and blocked[r + 1, c + 1]
    joined_left = has_above and has_left and blocked[r + 1, c - 1]
    if joined_right and gap_to_point(ay, ax, by, bx, top, right) < e:
        return True
    return joined_left and gap_to_point(ay, ax, by, bx, top, float(c)) < e


@njit(cache=True)
def is_clear(blocked: Bytes, ay: float, ax: float, by: float, bx: float, radius: float) -> bool:
    """Whether a disc of ``radius`` can go from a to b on the map without touching a blocked cell.

    For each row only the columns near the part of the segment within the radius are tested.
    """
    rows, columns = blocked.shape
    need = radius - EPSILON
    if min(ay, by) < need or min(ax, bx) < need:
        return False
    if max(ay, by) > rows - need or max(ax, bx) > columns - need:
        return False
    reach = max(radius, 0.0) + EPSILON
    dy, dx = by - ay, bx - ax
    per_dy = 1.0 / dy if abs(dy) > EPSILON else 0.0  # 0 for one that stays in its rows
    first = max(math.floor(min(ay, by) - reach), 0)
    last = min(math.floor(max(ay, by) + reach), rows - 1)
    for r in range(first, last + 1):
        enter, leave = 0.0, 1.0
        if per_dy != 0.0:
            low, high = (r - reach - ay) * per_dy, (r + 1 + reach - ay) * per_dy
            enter, leave = max(min(low, high), 0.0), min(max(low, high), 1.0)
        x0, x1 = ax + enter * dx, ax + leave * dx
        left = max(math.floor(min(x0, x1) - reach), 0)
        right = min(math.floor(max(x0, x1) + reach), columns - 1)
        for c in range(left, right + 1):
            if blocked[r, c]:
                if need > 0.0:
                    if gap_to_cell(ay, ax, by, bx, float(r), float(c)) < need:
                        return False
                elif point_is_stopped(blocked, ay, ax, by, bx, r, c):
                    return False
    return True


@njit(cache=True)
def first_contact(blocked: Bytes, points: npt.NDArray[np.float64], radius: float) -> float:
    """Length along the polyline (n, 2) to where a disc first touches something, or -1."""
    gone = 0.0
    for i in range(len(points) - 1):
        ay, ax, by, bx = points[i, 0], points[i, 1], points[i + 1, 0], points[i + 1, 1]
        length = norm(by - ay, bx - ax)
        if not is_clear(blocked, ay, ax, by, bx, radius):
            free, stopped = 0.0, 1.0
            while (stopped - free) * length > 1e-3:
                middle = 0.5 * (free + stopped)
                y, x = ay + middle * (by - ay), ax + middle * (bx - ax)
                if is_clear(blocked, ay, ax, y, x, radius):
                    free = middle
                else:
                    stopped = middle
            return gone + free * length
        gone += length
    return -1.0


def mask_bytes(blocked: npt.ArrayLike) -> Bytes:
    """A mask for the kernels: contiguous, writable bytes (one type, one compilation)."""
    mask = np.ascontiguousarray(blocked, dtype=bool)
    return (mask if mask.flags.writeable else mask.copy()).view(np.uint8)


def segment_clear(
    blocked: npt.ArrayLike, a: npt.ArrayLike, b: npt.ArrayLike, radius: float
) -> bool:
    """Whether a disc can go straight from ``a`` to ``b`` without touching a blocked cell.

    ``blocked`` is [rows, columns]; ``a`` and ``b`` are (row, column) in fractions of cells and
    ``radius`` is in cells. The whole square of a blocked cell and the space outside the map are
    blocked. A disc of radius 0 may touch squares but not slip between two that touch each other.
    """
    ay, ax = map(float, np.asarray(a, dtype=np.float64))
    by, bx = map(float, np.asarray(b, dtype=np.float64))
    return bool(is_clear(mask_bytes(blocked), ay, ax, by, bx, float(radius)))
