"""The way out for a robot that is closer to something than its radius."""

import math

import numpy as np

from dynastar.errors import NoPath, StartOccupied
from dynastar.planning.inflated import InflatedGrid
from dynastar.planning.neighbours import components
from dynastar.planning.search import Cell, Cells, SearchGrid


def reach_of_escape(radius: float) -> int:
    """Number of cells within which a way out is searched, for a footprint of ``radius`` cells."""
    return math.ceil(4.0 * radius) + 4


def way_out(grid: InflatedGrid, start: Cell, goal: Cell) -> Cells:
    """Shortest way (n, 2) out of the inflation to a cell from which a path leads to ``goal``.

    The way leads through unblocked cells, at most ``reach_of_escape`` rows and columns from
    ``start``. A blocked start is first left straight for the nearest unblocked cell within the
    radius + 2 cells, unless the radius is 0. If all exits are connected with each other nearby, the
    nearest is taken, and the search from it has to find out whether it leads on.

    Raises StartOccupied if there is no exit, and NoPath if there are several that are not connected
    nearby, and none leads on.
    """
    reach = reach_of_escape(grid.radius)
    top, left = max(start[0] - reach, 0), max(start[1] - reach, 0)
    window = np.s_[top : start[0] + reach + 1, left : start[1] + reach + 1]
    near = SearchGrid(grid.blocked[window])
    here = start[0] - top, start[1] - left
    first = here if near.is_free(here) else _nearest_free(near, here, grid.radius)
    if first is None:
        raise StartOccupied(f"no unblocked cell is near enough to the blocked cell {start}")
    free = ~grid.search.occupied
    lengths = near.flood(first)
    lengths[~free[window]] = np.inf
    exits = np.isfinite(lengths)
    if not exits.any():
        raise StartOccupied(f"no cell outside the inflation is reached from cell {start}")
    parts = components(free[window])[exits]
    if (parts != parts[0]).any():  # else the whole map need not be labelled
        parts = components(free)
        lengths[parts[window] != parts[goal]] = np.inf
        if np.isinf(lengths).all():
            raise NoPath(f"no way out of the inflation leads from cell {start} to cell {goal}")
    row, column = divmod(int(lengths.argmin()), lengths.shape[1])
    way = near.way_to((row, column))
    if first != here:
        way = np.vstack([np.array([here], np.int32), way])
    return way + np.array([top, left], np.int32)


def _nearest_free(grid: SearchGrid, cell: Cell, radius: float) -> Cell | None:
    """Nearest free cell of a grid, or None if it is farther than ``radius`` + 2 cells."""
    rows, columns = np.nonzero(~grid.occupied)
    away = np.hypot(rows - cell[0], columns - cell[1])
    if radius <= 0.0 or len(away) == 0 or away.min() > radius + 2.0:
        return None
    return int(rows[away.argmin()]), int(columns[away.argmin()])
