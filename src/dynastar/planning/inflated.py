"""The cells where a disc fits on a map whose obstacles change."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.clearance import inflate
from dynastar.planning.bounds import check_window
from dynastar.planning.parts import Parts, find_parts
from dynastar.planning.search import Cell, Cells, SearchGrid
from dynastar.planning.segments import CellPoint, first_contact, is_clear, mask_bytes

Mask = npt.NDArray[np.bool_]
Point = tuple[float, float]
Window = tuple[slice, slice]


class InflatedGrid:
    """The blocked cells [rows, columns] of a map and their inflation by ``radius`` cells.

    P of Eq. 2 counts the blocked cells; a cell of the map is ``cell`` of these cells wide.
    """

    def __init__(self, blocked: Mask, radius: float, cell: int) -> None:
        self.radius = radius
        self.bytes = mask_bytes(blocked)  # 1 where a cell is blocked
        self._search = SearchGrid(inflate(self.bytes, radius), self.bytes, cell)
        self._stale: tuple[int, int, int, int] | None = None  # marked: top, left, bottom, right
        self._parts: Parts | None = None
        self.is_marked = False  # other cells are blocked than at first

    @property
    def blocked(self) -> Mask:
        """True where a cell is blocked, [rows, columns]; read-only."""
        mask = self.bytes.view(np.bool_)
        mask.flags.writeable = False
        return mask

    @property
    def search(self) -> SearchGrid:
        """The inflated grid, up to date with all marks."""
        self._inflate_stale()
        return self._search

    @property
    def parts(self) -> Parts:
        """The connected parts outside the inflation, up to date with all marks."""
        if self._parts is None:
            self._parts = find_parts(self.search.near)
        return self._parts

    def parts_in(self, window: Window) -> npt.NDArray[np.int32]:
        """Number of the connected part [rows, columns] that each cell of a window is in, or 0."""
        rows, columns = (
            np.arange(n)[part] for n, part in zip(self.bytes.shape, window, strict=True)
        )
        return self.parts.at(rows[:, None], columns)

    def mark(self, row0: int, col0: int, patch_blocked: npt.ArrayLike) -> None:
        """Replace the window at (row0, col0), true where a cell is blocked.

        The inflation follows when ``search`` is next used. Raises OutOfMap if the window leaves the
        map.
        """
        patch = np.asarray(patch_blocked, dtype=bool)
        check_window(row0, col0, patch.shape, self.bytes.shape)
        bottom, right = row0 + patch.shape[0], col0 + patch.shape[1]
        self.bytes[row0:bottom, col0:right] = patch
        self._search.recount()
        self._parts, self.is_marked = None, True
        if self._stale is not None:
            top, left, low, side = self._stale
            row0, col0 = min(row0, top), min(col0, left)
            bottom, right = max(bottom, low), max(right, side)
        self._stale = row0, col0, bottom, right

    def fitting_cell(self, point: Point) -> Cell | None:
        """Nearest cell from whose centre the disc can go straight to a point, or None.

        ``point`` is (row, column) in fractions of cells; its own cell and the 8 around it count.
        """
        search = self.search
        row, column = int(point[0]), int(point[1])
        near = [(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        near.sort(key=lambda cell: math.dist(point, (cell[0] + 0.5, cell[1] + 0.5)))
        for r, c in near:
            if not search.is_free((r, c)):
                continue
            centre = CellPoint(r + 0.5, c + 0.5)
            if is_clear(self.bytes, CellPoint(*point), centre, self.radius):
                return r, c
        return None

    def places_near(self, point: Point, distance: float) -> Cells:
        """Cells (n, 2) from which the disc comes within ``distance`` cells of a point, nearest first.

        A cell counts if ``as_near_as_fits`` ends that near to the point.
        """
        reach = math.ceil(distance) + 1
        top, left = max(int(point[0]) - reach, 0), max(int(point[1]) - reach, 0)
        bottom, right = int(point[0]) + reach + 1, int(point[1]) + reach + 1
        fits = self.search.free[top:bottom, left:right] != 0
        cells = (np.argwhere(fits) + (top, left)).astype(np.int32)
        away = np.hypot(*(cells + 0.5 - point).T)
        order = np.argsort(away, kind="stable")
        cells, near = cells[order], away[order] <= distance
        for i in np.flatnonzero(~near & (away[order] <= distance + 1.0)):
            end = self.as_near_as_fits((int(cells[i, 0]), int(cells[i, 1])), point)
            near[i] = math.dist(end, point) <= distance
        return cells[near]

    def as_near_as_fits(self, cell: Cell, point: Point) -> Point:
        """How far the disc can go straight from a cell's centre towards a point."""
        line = np.array([(cell[0] + 0.5, cell[1] + 0.5), point])
        at = first_contact(self.bytes, line, self.radius)
        if at < 0.0:
            return point
        y, x = line[0] + (line[1] - line[0]) * (at / math.dist(*line))
        return float(y), float(x)

    def _inflate_stale(self) -> None:
        """Inflate again what was marked since the last search."""
        if self._stale is None:
            return
        row0, col0, bottom, right = self._stale
        self._stale = None
        rows, columns = self.bytes.shape
        reach = math.ceil(self.radius + 0.5)
        top, left = max(row0 - reach, 0), max(col0 - reach, 0)
        bottom, right = min(bottom + reach, rows), min(right + reach, columns)
        seen_top, seen_left = max(top - reach, 0), max(left - reach, 0)
        seen = inflate(
            self.bytes[seen_top : bottom + reach, seen_left : right + reach], self.radius
        )
        self._search.update(
            top,
            left,
            seen[top - seen_top : bottom - seen_top, left - seen_left : right - seen_left],
        )
