"""Shortest ways along straight lines at any angle between cells' centres.

The graph has an edge between any two centres with a clear line between them, near a way or on the
whole map. A* tests an edge only where it would make a way shorter, and short enough to lead to one
that is shorter than the known way.
"""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import allocating, njit
from dynastar.planning.segments import Bytes, CellPoint, distance, is_clear, mask_bytes
from dynastar.planning.smoothing import Points, polyline_length

CORRIDOR = 3  # cells to either side of a way


@allocating
def fitting_centres(
    blocked: Bytes, points: Points, radius: float, reach: int
) -> npt.NDArray[np.float64]:
    """The centres (n, 2) within ``reach`` rows and columns of a polyline where a disc fits.

    The polyline needs a point in every cell that it passes, or nearly so. Its two ends come first
    in the result, before the centres.
    """
    rows, columns = blocked.shape
    taken = np.zeros((rows, columns), np.bool_)
    found = np.empty((2 + min(rows * columns, len(points) * (2 * reach + 1) ** 2), 2))
    found[0], found[1] = points[0], points[-1]
    count = 2
    for k in range(len(points)):
        row, column = int(points[k, 0]), int(points[k, 1])
        for r in range(max(row - reach, 0), min(row + reach + 1, rows)):
            for c in range(max(column - reach, 0), min(column + reach + 1, columns)):
                if not taken[r, c]:
                    taken[r, c] = True
                    centre = CellPoint(r + 0.5, c + 0.5)
                    if not blocked[r, c] and is_clear(blocked, centre, centre, radius):
                        found[count] = centre
                        count += 1
    return found[:count]


@njit(cache=True)
def shortest_lines(blocked: Bytes, centres: Points, radius: float, bound: float) -> Points:
    """The shortest polyline (k, 2) from the first to the second of ``centres`` over the others.

    A disc of ``radius`` can follow each of its segments. Empty if there is none of at most
    ``bound`` cells.
    """
    n = len(centres)
    ahead, g = np.empty(n), np.full(n, np.inf)
    before = np.full(n, -1)
    for i in range(n):
        ahead[i] = math.hypot(centres[i, 0] - centres[1, 0], centres[i, 1] - centres[1, 1])
    waiting = np.empty(n, np.int64)  # open: reached and not yet expanded
    unseen = np.arange(n)  # not yet expanded
    g[0], waiting[0] = 0.0, 0
    open_count, left = 1, n
    while open_count > 0:
        at = 0
        for k in range(1, open_count):
            if g[waiting[k]] + ahead[waiting[k]] < g[waiting[at]] + ahead[waiting[at]]:
                at = k
        here = waiting[at]
        open_count -= 1
        waiting[at] = waiting[open_count]
        if here == 1:
            break
        kept = 0
        at_here = CellPoint(centres[here, 0], centres[here, 1])
        for k in range(left):
            there = unseen[k]
            if there == here:
                continue
            unseen[kept] = there
            kept += 1
            at_there = CellPoint(centres[there, 0], centres[there, 1])
            length = g[here] + distance(at_here, at_there)
            if length >= g[there] or length + ahead[there] > bound:
                continue
            if is_clear(blocked, at_here, at_there, radius):
                if g[there] == np.inf:
                    waiting[open_count] = there
                    open_count += 1
                g[there], before[there] = length, here
        left = kept
    count, node = 0, 1
    while g[1] < np.inf and node >= 0:
        count, node = count + 1, before[node]
    line = np.empty((count, 2))
    node = 1
    for k in range(count):
        line[count - 1 - k] = centres[node]
        node = before[node]
    return line


@njit(cache=True)
def straighten_kernel(
    blocked: Bytes, points: Points, radius: float, reach: int, known: Points
) -> Points:
    """``straighten`` on arrays of one type; ``known`` is returned if no shorter line is found."""
    centres = fitting_centres(blocked, points, radius, reach)
    line = shortest_lines(blocked, centres, radius, polyline_length(known) + 1e-9)
    return line if len(line) > 0 else known


def straighten(
    blocked: npt.ArrayLike,
    points: npt.ArrayLike,
    radius: float,
    known: npt.ArrayLike | None = None,
    reach: int = CORRIDOR,
) -> Points:
    """The shortest polyline over cells' centres near a way that a disc can follow, at any angle.

    ``blocked`` is [rows, columns]; ``points`` (n, 2), (row, column) in fractions of cells, are the
    way, cell by cell; ``radius`` of the disc and ``reach`` of the centres from the way are in cells.
    ``known`` is a shorter way between the same ends, if there is one: a good one saves time. The
    result is never longer than either; see ``segment_clear`` for what counts as clear.
    """
    line = np.array(points, dtype=np.float64).reshape(-1, 2)
    if len(line) < 3:
        return line
    shorter = line if known is None else np.array(known, dtype=np.float64).reshape(-1, 2)
    return straighten_kernel(mask_bytes(blocked), line, float(radius), int(reach), shorter)
