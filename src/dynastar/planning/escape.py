"""The way out for a robot that is closer to something than its radius, or in a keep-out zone."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import inflate
from dynastar.errors import NoPath, StartOccupied
from dynastar.planning.inflated import InflatedGrid, Window
from dynastar.planning.neighbours import components
from dynastar.planning.search import Cell, Cells, SearchGrid
from dynastar.planning.smoothing import Points, smooth

Mask = npt.NDArray[np.bool_]

NEIGHBOURING = (
    1.5  # times the clearance that a start lacks: an exit so near is that of a space beside it
)


class WayOut(NamedTuple):
    """The cells (n, 2) from a start to a cell outside the inflation, and the clearance kept there.

    The ``clearance``, in cells, is that from all blocked cells but those of ``zone``, the keep-out
    zone [rows, columns] in which the first ``inside`` cells lie. ``parts`` are the numbers of the
    connected parts that other ways out lead to, too.
    """

    cells: Cells
    clearance: float
    zone: Mask | None = None
    inside: int = 0
    parts: npt.NDArray[np.int32] = np.empty(0, np.int32)


NO_WAY = WayOut(np.empty((0, 2), np.int32), 0.0)  # of a start outside the inflation


def reach_of_escape(radius: float) -> int:
    """Number of cells within which a way out is searched, for a footprint of ``radius`` cells."""
    return math.ceil(4.0 * radius) + 4


def way_out(
    grid: InflatedGrid, start: Cell, places: Cells | None = None, zone: Mask | None = None
) -> WayOut:
    """Shortest way out of the inflation to a cell connected with one of ``places`` (n, 2), or any.

    The way lies within ``reach_of_escape`` rows and columns of ``start`` and of the keep-out zone in
    which the start lies. It keeps the clearance that the start has, less the width of a cell, up to
    the radius, and crosses that zone only to leave it. A start that is about as near to an exit as
    it lacks clearance is beside open space and leaves into that; from within a narrow place any
    exit will do. A blocked start outside of a zone is first left straight for the nearest unblocked
    cell within the radius + 2 cells, unless the radius is 0.

    Raises StartOccupied if there is no exit, and NoPath if none leads on.
    """
    window = _window(grid, start, zone)
    corner = np.array([part.start for part in window], np.int32)
    here = start[0] - int(corner[0]), start[1] - int(corner[1])
    blocked = grid.blocked if zone is None else grid.blocked & ~zone
    clearance = _clearance(blocked, start, grid.radius)
    kept = grid.radius if clearance >= grid.radius else max(clearance - 1.0, 0.0)
    parts = grid.parts_in(window)
    leads_on = parts > 0
    if places is not None:
        leads_on &= np.isin(parts, grid.parts.at(*places.T))
    closed = _inflated(blocked, window, kept)
    if zone is not None:  # close the space outside from which no way leads on
        spaces = components(~closed & ~zone[window])
        closed |= ~zone[window] & ~np.isin(spaces, spaces[leads_on])
    near = SearchGrid(closed)
    first = here if near.is_free(here) else _nearest_free(near, here, grid.radius)
    if first is None:
        raise StartOccupied(f"no unblocked cell is near enough to the blocked cell {start}")
    lengths = near.flood(first)
    nearest = lengths[parts > 0].min(initial=np.inf)
    if zone is None and nearest == np.inf:
        raise StartOccupied(f"no cell outside the inflation is reached from cell {start}")
    if zone is None and nearest <= NEIGHBOURING * (grid.radius - clearance) + 2.0:
        lengths[lengths > nearest + 1.0 + 1e-9] = np.inf  # a tie of rounded lengths is kept
    lengths[~leads_on] = np.inf
    if np.isinf(lengths).all():
        raise NoPath(f"no way out of the inflation leads on from cell {start}")
    row, column = divmod(int(lengths.argmin()), lengths.shape[1])
    ways_to = np.unique(parts[np.isfinite(lengths)])
    way = near.way_to((row, column)) + corner
    if first != here:
        way = np.vstack([np.array([start], np.int32), way])
    if zone is not None:
        way, inside = _left_once(grid, way, places, zone)
        return WayOut(way, kept, zone, inside, ways_to)
    return WayOut(way, kept, parts=ways_to)


def smoothed(grid: InflatedGrid, line: Points, way: WayOut) -> Points:
    """A shorter line (n, 2) along a way out that keeps the same clearance.

    ``line`` leads along the centres of all of the way's cells.
    """
    if way.zone is None:
        return smooth(grid.bytes, line, way.clearance)
    left = len(line) - len(way.cells) + way.inside  # the first point outside the zone
    inside = smooth(grid.blocked & ~way.zone, line[: left + 1], way.clearance)
    return np.vstack([inside[:-1], smooth(grid.bytes, line[left:], way.clearance)])


def _left_once(
    grid: InflatedGrid, way: Cells, places: Cells | None, zone: Mask
) -> tuple[Cells, int]:
    """A way out of a zone that does not enter it again, and how many of its cells are inside."""
    within = zone[way[:, 0], way[:, 1]]
    inside = int(np.argmin(within))
    if within[inside:].any():
        row, column = map(int, way[inside])
        way = np.vstack([way[:inside], way_out(grid, (row, column), places).cells])
    return way, inside


def _window(grid: InflatedGrid, start: Cell, zone: Mask | None) -> Window:
    """The rows and columns in which a way out is searched."""
    reach, parts = reach_of_escape(grid.radius), []
    for axis in (0, 1):
        held = np.array(start[axis : axis + 1])
        if zone is not None:
            held = np.flatnonzero(zone.any(axis=1 - axis))
        parts.append(slice(max(int(held[0]) - reach, 0), int(held[-1]) + reach + 1))
    return parts[0], parts[1]


def _clearance(blocked: Mask, cell: Cell, radius: float) -> float:
    """Cells from a cell's centre to the nearest blocked square, or the edge, up to ``radius``."""
    reach = math.ceil(radius) + 1
    top, left = max(cell[0] - reach, 0), max(cell[1] - reach, 0)
    rows, columns = np.nonzero(blocked[top : cell[0] + reach + 1, left : cell[1] + reach + 1])
    away = np.hypot(
        np.maximum(np.abs(rows + top - cell[0]) - 0.5, 0.0),
        np.maximum(np.abs(columns + left - cell[1]) - 0.5, 0.0),
    )
    edge = min(*cell, blocked.shape[0] - 1 - cell[0], blocked.shape[1] - 1 - cell[1]) + 0.5
    if blocked[cell]:
        return 0.0
    return float(min(away.min(initial=np.inf), edge, radius))


def _inflated(blocked: Mask, window: Window, radius: float) -> Mask:
    """The window of ``blocked`` inflated by ``radius`` cells; what lies off the map is blocked."""
    reach = math.ceil(radius) + 1
    top, left = (max(part.start - reach, 0) for part in window)
    grown = inflate(blocked[top : window[0].stop + reach, left : window[1].stop + reach], radius)
    return grown[
        window[0].start - top : window[0].stop - top, window[1].start - left : window[1].stop - left
    ]


def _nearest_free(grid: SearchGrid, cell: Cell, radius: float) -> Cell | None:
    """Nearest free cell of a grid, or None if it is farther than ``radius`` + 2 cells."""
    rows, columns = np.nonzero(~grid.occupied)
    away = np.hypot(rows - cell[0], columns - cell[1])
    if radius <= 0.0 or len(away) == 0 or away.min() > radius + 2.0:
        return None
    return int(rows[away.argmin()]), int(columns[away.argmin()])
