"""The narrowest passages between the larger free regions of a map."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynastar.clearance import distance_to_squares
from dynastar.grid import OccupancyGrid, Unknown

Floats = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]
Cells = npt.NDArray[np.int64]

OFF_CENTRE = math.sqrt(
    2.0
)  # cells by which a gap is wider than twice the clearance of its best cell
WIDER = 0.5  # cells of clearance that a region has more than its passage: it is 1 or 2 cells wider
STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))  # to half of a cell's neighbours


@dataclass(frozen=True)
class Passage:
    """The narrowest place of the widest way between two regions of a map.

    ``x``, ``y`` and ``width`` are metres; ``area`` (m2) is that of the smaller region.
    """

    x: float
    y: float
    width: float
    area: float


def passages(grid: OccupancyGrid, unknown: Unknown, area: float, width: float) -> list[Passage]:
    """The passages between regions of at least ``area`` (m2), narrowest first.

    The clearance of a map has basins round its local maxima. They are joined at the widest place
    between them, the widest first; where that joins two large regions, there is a passage. Gaps that
    are narrower than ``width`` (m) count as walls.
    """
    blocked = grid.blocked(unknown)
    if blocked.all():
        return []
    clearance = distance_to_squares(blocked)
    basin, peaks, sizes = _basins(clearance)
    a = grid.resolution
    joined = _joined(_edges(clearance, basin), peaks, sizes, area / (a * a))
    found = []
    for cell, cells in joined:
        row, column = np.unravel_index(cell, blocked.shape)
        gap = _gap(blocked, int(row), int(column), float(clearance[row, column]))
        x, y = grid.frame.to_world(gap.row, gap.column)
        found.append(Passage(x, y, a * gap.width, cells * a * a))
    return sorted((one for one in found if one.width >= width), key=lambda one: one.width)


def _basins(clearance: Floats) -> tuple[Cells, Floats, Cells]:
    """For each cell (flat) the number of its basin, and each basin's peak (cells) and size.

    A cell belongs to the local maximum that steepest ascent leads to. Blocked cells have -1.
    """
    shape = clearance.shape
    own = np.arange(clearance.size).reshape(shape)
    best, up = clearance.copy(), own.copy()
    for step in (*STEPS, *((-i, -j) for i, j in STEPS)):
        here, there = _shifted(step)
        higher = clearance[there] > best[here]
        tied = (clearance[there] == best[here]) & (own[there] > up[here])
        change = (higher | tied) & (np.minimum(clearance[here], clearance[there]) >= _least(step))
        best[here][change] = clearance[there][change]
        up[here][change] = own[there][change]
    root = up.ravel()
    while True:
        further = root[root]
        if np.array_equal(further, root):
            break
        root = further
    free = clearance.ravel() > 0.0
    tops, basin = np.unique(root[free], return_inverse=True)
    numbers = np.full(clearance.size, -1)
    numbers[free] = basin
    return numbers, clearance.ravel()[tops], np.bincount(basin, minlength=len(tops))


def _least(step: tuple[int, int]) -> float:
    """The clearance (cells) that a step needs: a diagonal one must not pass between two corners."""
    return 1.0 if all(step) else 0.0


def _shifted(step: tuple[int, int]) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Slices of all cells that have a neighbour a ``step`` away, and of these neighbours."""
    here, there = [], []
    for move in step:
        here.append(slice(max(-move, 0), -move if move > 0 else None))
        there.append(slice(max(move, 0), move if move < 0 else None))
    return (here[0], here[1]), (there[0], there[1])


@dataclass(frozen=True)
class _Edges:
    """Where basins meet: the basins, the cell (flat) and its clearance, the widest first."""

    first: Cells
    second: Cells
    cell: Cells
    clearance: Floats


def _edges(clearance: Floats, basin: Cells) -> _Edges:
    """The widest place between each two basins that touch."""
    own, of = np.arange(clearance.size).reshape(clearance.shape), basin.reshape(clearance.shape)
    parts = []
    for step in STEPS:
        here, there = _shifted(step)
        low = np.minimum(clearance[here], clearance[there])
        meet = (of[here] != of[there]) & (low >= _least(step)) & (low > 0.0)
        cell = np.where(clearance[here] <= clearance[there], own[here], own[there])
        parts.append((of[here][meet], of[there][meet], cell[meet], low[meet]))
    first, second, cell, low = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    first, second = np.minimum(first, second), np.maximum(first, second)
    order = np.lexsort((-low, second, first))
    first, second, cell, low = first[order], second[order], cell[order], low[order]
    new = np.ones(len(first), bool)
    new[1:] = (np.diff(first) != 0) | (np.diff(second) != 0)
    first, second, cell, low = first[new], second[new], cell[new], low[new]
    order = np.argsort(-low, kind="stable")
    return _Edges(first[order], second[order], cell[order], low[order])


def _joined(edges: _Edges, peaks: Floats, sizes: Cells, least: float) -> list[tuple[int, int]]:
    """The cells (flat) that join two large regions, each with the cells of the smaller of them.

    A region is large if it has ``least`` cells and is wider than the place.
    """
    parent, peak, size = list(range(len(peaks))), peaks.tolist(), sizes.tolist()

    def top(one: int) -> int:
        while parent[one] != one:
            parent[one] = parent[parent[one]]
            one = parent[one]
        return one

    found = []
    columns = (edges.first, edges.second, edges.cell, edges.clearance)
    for first, second, cell, low in zip(*(column.tolist() for column in columns), strict=True):
        a, b = top(first), top(second)
        if a == b:
            continue
        wide = min(peak[a], peak[b]) >= low + WIDER
        if wide and min(size[a], size[b]) >= least:
            found.append((cell, min(size[a], size[b])))
        parent[b], peak[a], size[a] = a, max(peak[a], peak[b]), size[a] + size[b]
    return found


@dataclass(frozen=True)
class _Gap:
    """Width of a gap and the point in its middle, in cells."""

    width: float
    row: float
    column: float


def _gap(blocked: Mask, row: int, column: int, clearance: float) -> _Gap:
    """The gap at a cell, between the two nearest blocked squares on its two sides.

    ``clearance`` (cells) is the distance of the cell's centre from the nearest square. Beyond the map all
    is blocked.
    """
    reach = int(clearance) + 3
    at = np.arange(-reach, reach + 1)
    rows, columns = np.meshgrid(row + at, column + at, indexing="ij")
    on = (rows >= 0) & (rows < blocked.shape[0]) & (columns >= 0) & (columns < blocked.shape[1])
    closed = ~on
    closed[on] = blocked[rows[on], columns[on]]
    offsets = np.argwhere(closed) - reach
    away = np.hypot(*np.maximum(np.abs(offsets) - 0.5, 0.0).T)
    near = offsets[away <= clearance + 1.5]
    nearest = offsets[np.argmin(away)]
    side = near @ nearest
    one, other = near[side > 0], near[side < 0]
    if len(other) == 0:
        return _Gap(2.0 * clearance, row + 0.5, column + 0.5)
    beside = np.maximum(np.abs(one[:, None] - other[None]) - 1.0, 0.0)
    apart = np.hypot(beside[..., 0], beside[..., 1])
    first, second = np.unravel_index(apart.argmin(), apart.shape)
    up, right = 0.5 * (one[first] + other[second]) + 0.5
    width = np.clip(apart.min(), 2.0 * clearance, 2.0 * clearance + OFF_CENTRE)
    return _Gap(float(width), row + float(up), column + float(right))
