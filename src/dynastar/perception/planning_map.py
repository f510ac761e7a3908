"""The planning map: the map in cells that are small enough, and what was sensed since."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import inflate
from dynastar.config import summary
from dynastar.field import blocks
from dynastar.grid import OccupancyGrid, Unknown
from dynastar.masks import zone_around
from dynastar.perception.detection import Known
from dynastar.perception.local_map import ROUNDED, SEEN_FREE, SEEN_OCCUPIED, LocalMap

Mask = npt.NDArray[np.bool_]
Marks = Mask | npt.NDArray[np.uint8]
Part = tuple[slice, slice]


class Patch(NamedTuple):
    """Cells that changed: row and column of the first, and which of them are blocked now."""

    top: int
    left: int
    blocked: Mask


class PlanningMap:
    """The map cut into cells of ``resolution`` (m) at most, and the obstacles sensed.

    Local maps lie on the same cells: one of their cells covers ``merged`` x ``merged`` cells, more
    than one only where the map as given is much finer than ``resolution``. ``factor`` cells make one of
    the map as given. ``frame`` is that of ``grid``, turned about the origin so that its yaw is 0.
    ``barred`` are the keep-out cells that the robot may not drive on: all but those of ``zone``, the
    keep-out zone that it has still to leave.
    """

    def __init__(
        self, grid: OccupancyGrid, resolution: float = 0.05, unknown: Unknown = "blocked"
    ) -> None:
        self.factor = math.ceil(grid.resolution / resolution - ROUNDED)
        self.grid = grid.refined(self.factor)
        self.frame = self.grid.frame.aligned()
        self.merged = max(1, math.floor(resolution / self.frame.resolution + ROUNDED))
        self.prior = self.grid.blocked(unknown)
        self.blocked = self.prior.copy()
        self.seen, self.cleared = np.zeros_like(self.prior), np.zeros_like(self.prior)
        keepout = self.grid.keepout
        self._keepout: Mask = np.zeros_like(self.prior) if keepout is None else keepout
        self.barred = self._keepout
        self.zone: Mask | None = None
        self._unknown = self.grid.unknown & ~self._keepout
        near = inflate(self.grid.occupied, 1.0, outside_blocked=True)
        self.known = Known(near, self.frame)

    def __repr__(self) -> str:
        sensed = np.count_nonzero(self.blocked & ~self.prior)
        return summary(
            self, self.grid.size(), self.grid.extent(), f"{sensed} cells blocked by scans"
        )

    @property
    def lattice(self) -> tuple[float, tuple[float, float]]:
        """The side of a local map's cells and the corner (x, y) of one of them, metres."""
        return self.merged * self.frame.resolution, (self.frame.x, self.frame.y)

    def place_robot(self, x: float, y: float, radius: float) -> None:
        """Open the keep-out zone that holds (x, y) until the disc of ``radius`` (m) there has left it.

        A robot outside of a zone does not open it, however near the zone is.
        """
        row, column = self.frame.to_grid(x, y)
        if not (0 <= row < self.prior.shape[0] and 0 <= column < self.prior.shape[1]):
            return
        cell = int(row), int(column)
        if self._keepout[cell]:
            if self.zone is None or not self.zone[cell]:
                self._open(zone_around(self.grid, cell))
        elif self.zone is not None:
            centres = np.argwhere(self.zone) + 0.5
            away = np.maximum(np.abs(centres - (row, column)) - 0.5, 0.0)  # from the cells' squares
            if np.hypot(*away.T).min() >= radius / self.frame.resolution:
                self._open(None)

    def _open(self, zone: Mask | None) -> None:
        self.zone = zone
        self.barred = self._keepout if zone is None else self._keepout & ~zone

    def merge(self, local_map: LocalMap) -> Patch | None:
        """Mark what the local map shows occupied, clear what it shows free. Returns what changed."""
        part, within = self._window(local_map)
        rows, columns = part
        states = local_map.states
        if self.merged > 1:
            states = states.repeat(self.merged, axis=0).repeat(self.merged, axis=1)
        free, occupied = states[within] == SEEN_FREE, states[within] == SEEN_OCCUPIED
        seen = (self.seen[part] & ~free) | (occupied & ~self.known.mask[part])
        cleared = (self.cleared[part] | free) & self._unknown[part]
        changed = (seen != self.seen[part]) | (cleared != self.cleared[part])
        self.seen[part], self.cleared[part] = seen, cleared
        return self._patch(changed, rows.start, columns.start)

    def forget(self) -> Patch | None:
        """Drop the obstacles sensed. Returns what changed."""
        changed = self.seen.copy()
        self.seen[:] = False
        return self._patch(changed, 0, 0)

    def under(self, mask: Marks, local_map: LocalMap, outside: bool) -> Mask:
        """Whether ``mask`` is true, or not 0, anywhere in each cell (n, n) of a local map.

        ``mask`` is [rows, columns] of this map; it counts as ``outside`` beyond.
        """
        part, within = self._window(local_map)
        n, m = len(local_map.states), self.merged
        found = np.full((n * m, n * m), outside)
        found[within] = mask[part]
        return blocks(np.logical_or, found, m)

    def occupied_under(self, local_map: LocalMap) -> Mask:
        """Cells (n, n) of a local map that are occupied: there, on this map, or off this map."""
        blocked = self.blocked
        if self.zone is not None:
            blocked = blocked & ~(self.zone & ~self.seen)
        return (local_map.states == SEEN_OCCUPIED) | self.under(blocked, local_map, True)

    def speed_limit(self, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """The map's speed limit (m/s, inf for none) at points (n, 2)."""
        limits = np.full(len(points), np.inf)
        if self.grid.speed_limit is not None:
            cells = np.floor(self.frame.points_to_grid(points)).astype(np.int64)
            inside = ((cells >= 0) & (cells < self.prior.shape)).all(axis=1)
            rows, columns = cells[inside].T
            limits[inside] = self.grid.speed_limit[rows, columns]
        return limits

    def _window(self, local_map: LocalMap) -> tuple[Part, Part]:
        """The part of this map under a local map, and the part of the local map that it is under.

        Both are in cells of this map.
        """
        resolution, x0, y0, _ = self.frame
        n = self.merged * len(local_map.states)
        x, y = local_map.origin
        rows, columns = self.prior.shape

        def overlap(low: float, size: int) -> tuple[slice, slice]:
            first = round(low / resolution)
            start, stop = min(max(first, 0), size), min(max(first + n, 0), size)
            return slice(start, stop), slice(start - first, stop - first)

        rows_here, rows_there = overlap(y - y0, rows)
        columns_here, columns_there = overlap(x - x0, columns)
        return (rows_here, columns_here), (rows_there, columns_there)

    def _patch(self, changed: Mask, top: int, left: int) -> Patch | None:
        """Bring ``blocked`` up to date where it has changed. Returns the smallest box round that.

        ``changed`` are cells of the part that begins at row ``top`` and column ``left``.
        """
        rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
        if not len(rows):
            return None
        top, left = top + int(rows[0]), left + int(columns[0])
        box = np.s_[top : top + np.ptp(rows) + 1, left : left + np.ptp(columns) + 1]
        self.blocked[box] = (self.prior[box] & ~self.cleared[box]) | self.seen[box]
        return Patch(top, left, self.blocked[box])


class NoMap(PlanningMap):
    """Takes a planning map's place where there is no map: nothing is known of any place."""

    def __init__(self, resolution: float = 0.05) -> None:
        super().__init__(OccupancyGrid(np.array([[-1]], np.int8), resolution), resolution, "free")
        self.known = Known(np.zeros_like(self.prior), self.frame)

    def under(self, mask: Marks, local_map: LocalMap, outside: bool) -> Mask:
        """As for a map; off the map nothing is known, whatever ``outside`` says."""
        return super().under(mask, local_map, False)
