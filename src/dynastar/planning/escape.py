"""The way out for a robot that stands too close to something: the shortest to where it fits."""

import math
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from dynastar.planning.search import Cell, Cells, SearchGrid

Mask = npt.NDArray[np.bool_]


def reach_of_escape(radius: float) -> int:
    """Number of cells within which a way out is searched, for a footprint of ``radius`` cells."""
    return math.ceil(4.0 * radius) + 4


def ways_out(blocked: Mask, inflated: Mask, cell: Cell, radius: float) -> Iterator[Cells]:
    """Ways (n, 2) of cells from ``cell`` to cells that are not inflated, the shortest first.

    They lead through unblocked cells, no further than ``reach_of_escape``. A blocked ``cell`` is
    first left straight for the nearest free one within ``radius`` + 2 cells; with radius 0 not.
    """
    reach = reach_of_escape(radius)
    top, left = max(cell[0] - reach, 0), max(cell[1] - reach, 0)
    window = np.s_[top : cell[0] + reach + 1, left : cell[1] + reach + 1]
    free = ~blocked[window]
    here = (cell[0] - top, cell[1] - left)
    first = here
    if not free[here]:
        rows, columns = np.nonzero(free)
        away = np.hypot(rows - here[0], columns - here[1])
        if radius <= 0.0 or len(away) == 0 or away.min() > radius + 2.0:
            return
        first = (int(rows[away.argmin()]), int(columns[away.argmin()]))
    around = SearchGrid(~free)
    lengths = around.flood(first)
    lengths[inflated[window]] = np.inf
    order = np.argsort(lengths, axis=None, kind="stable")
    for flat in order[: int(np.isfinite(lengths).sum())]:
        row, column = divmod(int(flat), lengths.shape[1])
        way = around.way_to((row, column))
        if first != here:
            way = np.vstack([np.array([here], np.int32), way])
        yield way + np.array([top, left], np.int32)
