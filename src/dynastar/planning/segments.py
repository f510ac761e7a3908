"""Exact tests whether a disc can go along a straight line past the squares of blocked cells.

Everything is in cell coordinates: cell [r, c] is the square from (r, c) to (r + 1, c + 1).
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit

Bytes = npt.NDArray[np.uint8]

EPSILON = 5e-10  # cells; a gap this much too small is none


class CellPoint(NamedTuple):
    """A point in cell coordinates, or the vector from one to another."""

    y: float
    x: float


@njit(cache=True)
def norm(y: float, x: float) -> float:
    """Length of (y, x), without the guard against overflow that makes ``hypot`` slow."""
    return math.sqrt(y * y + x * x)


@inner
def distance(a: CellPoint, b: CellPoint) -> float:
    """Distance between two points."""
    return norm(b.y - a.y, b.x - a.x)


@inner
def crosses_box(a: CellPoint, b: CellPoint, low: CellPoint, high: CellPoint) -> bool:
    """Whether the segment a - b meets the closed box from ``low`` to ``high`` (Liang-Barsky)."""
    enter, leave = 0.0, 1.0
    for at, step, least, most in (
        (a.y, b.y - a.y, low.y, high.y),
        (a.x, b.x - a.x, low.x, high.x),
    ):
        if step == 0.0:
            if at < least or at > most:
                return False
            continue
        first, last = (least - at) / step, (most - at) / step
        enter = max(enter, min(first, last))
        leave = min(leave, max(first, last))
    return enter <= leave


@inner
def gap_to_point(a: CellPoint, b: CellPoint, point: CellPoint) -> float:
    """Distance from the segment a - b to a point."""
    dy, dx = b.y - a.y, b.x - a.x
    square = dy * dy + dx * dx
    t = 0.0
    if square > 0.0:
        t = min(max(((point.y - a.y) * dy + (point.x - a.x) * dx) / square, 0.0), 1.0)
    return norm(a.y + t * dy - point.y, a.x + t * dx - point.x)


@inner
def gap_to_cell(a: CellPoint, b: CellPoint, r: float, c: float) -> float:
    """Distance from the segment a - b to the square of a cell, 0 if they meet."""
    if crosses_box(a, b, CellPoint(r, c), CellPoint(r + 1.0, c + 1.0)):
        return 0.0
    gap = math.inf
    for end in (a, b):
        beyond_y, beyond_x = abs(end.y - r - 0.5) - 0.5, abs(end.x - c - 0.5) - 0.5
        gap = min(gap, norm(max(beyond_y, 0.0), max(beyond_x, 0.0)))
    for y, x in ((r, c), (r, c + 1.0), (r + 1.0, c), (r + 1.0, c + 1.0)):
        gap = min(gap, gap_to_point(a, b, CellPoint(y, x)))
    return gap


@inner
def point_is_stopped(blocked: Bytes, a: CellPoint, b: CellPoint, r: int, c: int) -> bool:
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
    low = CellPoint(r + e, c + e)
    if crosses_box(a, b, low, CellPoint(top_of_two - e, right - e)):
        return True
    if crosses_box(a, b, low, CellPoint(top - e, right_of_two - e)):
        return True
    joined_right = has_above and has_right and blocked[r + 1, c + 1]
    joined_left = has_above and has_left and blocked[r + 1, c - 1]
    if joined_right and gap_to_point(a, b, CellPoint(top, right)) < e:
        return True
    return joined_left and gap_to_point(a, b, CellPoint(top, float(c))) < e


@njit(cache=True)
def is_clear(blocked: Bytes, a: CellPoint, b: CellPoint, radius: float) -> bool:
    """Whether a disc of ``radius`` can go from a to b on the map without touching a blocked cell.

    For each row only the columns near the part of the segment within the radius are tested.
    """
    rows, columns = blocked.shape
    need = radius - EPSILON
    if min(a.y, b.y) < need or min(a.x, b.x) < need:
        return False
    if max(a.y, b.y) > rows - need or max(a.x, b.x) > columns - need:
        return False
    reach = max(radius, 0.0) + EPSILON
    dy, dx = b.y - a.y, b.x - a.x
    per_dy = 1.0 / dy if abs(dy) > EPSILON else 0.0  # 0 for one that stays in its rows
    first = max(math.floor(min(a.y, b.y) - reach), 0)
    last = min(math.floor(max(a.y, b.y) + reach), rows - 1)
    for r in range(first, last + 1):
        enter, leave = 0.0, 1.0
        if per_dy != 0.0:
            low, high = (r - reach - a.y) * per_dy, (r + 1 + reach - a.y) * per_dy
            enter, leave = max(min(low, high), 0.0), min(max(low, high), 1.0)
        x0, x1 = a.x + enter * dx, a.x + leave * dx
        left = max(math.floor(min(x0, x1) - reach), 0)
        right = min(math.floor(max(x0, x1) + reach), columns - 1)
        for c in range(left, right + 1):
            if blocked[r, c]:
                if need > 0.0:
                    if gap_to_cell(a, b, float(r), float(c)) < need:
                        return False
                elif point_is_stopped(blocked, a, b, r, c):
                    return False
    return True


@njit(cache=True)
def first_contact(blocked: Bytes, points: npt.NDArray[np.float64], radius: float) -> float:
    """Length along the polyline (n, 2) to where a disc first touches something, or -1."""
    gone = 0.0
    for i in range(len(points) - 1):
        a, b = CellPoint(points[i, 0], points[i, 1]), CellPoint(points[i + 1, 0], points[i + 1, 1])
        length = distance(a, b)
        if not is_clear(blocked, a, b, radius):
            free, stopped = 0.0, 1.0
            while (stopped - free) * length > 1e-3:
                middle = 0.5 * (free + stopped)
                between = CellPoint(a.y + middle * (b.y - a.y), a.x + middle * (b.x - a.x))
                if is_clear(blocked, a, between, radius):
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
    first = CellPoint(*map(float, np.asarray(a, dtype=np.float64)))
    last = CellPoint(*map(float, np.asarray(b, dtype=np.float64)))
    return bool(is_clear(mask_bytes(blocked), first, last, float(radius)))
