"""What the sensor saw round the robot, in a window that moves along: free, occupied or unseen."""

import math
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import lower_bounds
from dynastar.config import Field, self_checking
from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.perception import local_map_kernels as kernels
from dynastar.scan import LaserScan

UNSEEN, SEEN_FREE, SEEN_OCCUPIED = 0, 1, 2
Points = npt.NDArray[np.float64]


@self_checking
class LocalMapConfig(NamedTuple):
    """The local map's settings."""

    resolution: Annotated[float, Field("side of a cell, or less", "m", 0.01, 1.0)] = 0.05
    size: Annotated[float, Field("side of the window, in proportion", "m", 2.0, 100.0)] = 10.0
    memory: Annotated[
        float,
        Field("time after which a cell that is out of sight is unseen again", "s", 1.0, 3600.0),
    ] = 30.0
    narrowest: Annotated[float, Field("smallest width of an obstacle", "m", 0.001, 1.0)] = 0.1


class LocalMap:
    """A square of cells in the map frame that follows the robot, and when each was last seen how."""

    def __init__(self, config: LocalMapConfig = LocalMapConfig()) -> None:
        n = 2 * max(4, math.ceil(0.5 * config.size / config.resolution))
        self.config = config
        self.row0 = self.column0 = 0  # lattice index of cell [0, 0], even
        self.free_at = np.full((n, n), kernels.NEVER)
        self.hit_at = np.full((n, n), kernels.NEVER)
        self.states = np.zeros((n, n), np.uint8)
        self.open = np.zeros((n, n), np.uint8)
        self.field = np.zeros((n, n), np.float32)
        self._barred = np.zeros((n, n), np.bool_)
        self._spare = np.empty((n, n))
        self._grid: OccupancyGrid | None = None

    @property
    def origin(self) -> tuple[float, float]:
        """The window's low corner (x, y) in metres."""
        a = self.config.resolution
        return self.column0 * a, self.row0 * a

    @property
    def frame(self) -> tuple[float, float, float]:
        """The side of a cell and the window's low corner, metres."""
        return (self.config.resolution, *self.origin)

    def set_grid(self, grid: OccupancyGrid) -> None:
        """The map, for its keep-out cells; what stands on it has to be seen to count as free."""
        self._grid = grid
        self._bar()

    def forget(self) -> None:
        """Turns all of the window into unseen."""
        self.free_at.fill(kernels.NEVER)
        self.hit_at.fill(kernels.NEVER)

    def follow(self, x: float, y: float) -> None:
        """Keeps (x, y) near the middle of the window; cells that leave it are forgotten."""
        a, n = self.config.resolution, len(self.free_at)
        rows = math.floor(y / a) - n // 2 - self.row0
        columns = math.floor(x / a) - n // 2 - self.column0
        rows, columns = (
            rows - rows % 2,
            columns - columns % 2,
        )  # fields of half the resolution stay aligned
        if max(abs(rows), abs(columns)) * a < self.config.size / 12:
            return
        for name in ("free_at", "hit_at"):
            kernels.shift(getattr(self, name), self._spare, rows, columns, kernels.NEVER)
            kept = getattr(self, name)
            setattr(self, name, self._spare)
            self._spare = kept
        self.row0, self.column0 = self.row0 + rows, self.column0 + columns
        self._bar()

    def assume_free(self, x: float, y: float, radius: float, now: float, fresh: bool) -> None:
        """Takes the disc round the robot as free where nothing was hit: it stands there.

        At the start (``fresh``) the whole disc where the map shows nothing; later only what was
        seen free before is kept from being forgotten.
        """
        a = self.config.resolution
        x0, y0 = self.origin
        if not fresh:
            kernels.keep_free(self.free_at, self.hit_at, self.frame, (x, y, radius), now)
            return
        reach = math.ceil(radius / a) + 1
        row, column = math.floor(y / a) - self.row0, math.floor(x / a) - self.column0
        part = np.s_[
            max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1
        ]
        rows, columns = np.ogrid[part]
        inside = np.hypot((columns + 0.5) * a + x0 - x, (rows + 0.5) * a + y0 - y) <= radius
        free, hit = self.free_at[part], self.hit_at[part]
        shown = inside & (hit < now - self.config.memory) & ~self._occupied_on_map(part)
        free[shown] = np.maximum(free[shown], now)

    def see(
        self,
        scan: LaserScan,
        sensor: Pose2D,
        points: Points,
        moving: npt.NDArray[np.bool_],
        range_error: float,
        heading_error: float,
    ) -> None:
        """Takes in one scan from the ``sensor`` pose; ``points`` are its ends, ``moving`` leaves out."""
        increment = scan.angle_increment
        full, errors = scan.full_circle, (range_error, heading_error)
        limits = scan.range_min, scan.range_max
        narrowest = self.config.narrowest
        gaps = kernels.free_ranges(scan.ranges, limits, increment, full, errors, narrowest)
        beams = scan.angle_min, increment
        kernels.mark_free(self.free_at, self.frame, gaps, beams, full, tuple(sensor), scan.stamp)
        kernels.mark_hits(self.hit_at, self.frame, points, moving, scan.stamp)

    def erase(self, x: float, y: float, radius: float) -> None:
        """Forgets the hits in a disc: what was there has turned out to move."""
        kernels.mark_disc(self.hit_at, self.frame, (x, y, radius), kernels.NEVER)

    def update(self, now: float) -> None:
        """Brings ``states``, ``open`` and ``field`` (metres between cell centres) up to date."""
        kernels.compose_states(
            self.free_at,
            self.hit_at,
            self._barred,
            now - self.config.memory,
            self.states,
            self.open,
        )
        self.field = lower_bounds(self.open, self.config.resolution)  # the rim is closed

    def _bar(self) -> None:
        self._barred[:] = False
        if self._grid is None or self._grid.keepout is None:
            return
        cells, on_map = self._map_cells(np.s_[:, :])
        self._barred[on_map] = self._grid.keepout[cells[..., 0][on_map], cells[..., 1][on_map]]

    def _occupied_on_map(self, part: tuple[slice, slice]) -> npt.NDArray[np.bool_]:
        cells, on_map = self._map_cells(part)
        result = np.zeros(on_map.shape, np.bool_)
        if self._grid is not None:
            result = ~on_map
            inside = cells[on_map]
            result[on_map] = self._grid.occupied[inside[:, 0], inside[:, 1]]
        return result

    def _map_cells(
        self, part: tuple[slice, slice]
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
        """The map's cell under the centre of each of the window's, and whether there is one."""
        a = self.config.resolution
        rows, columns = np.mgrid[: len(self.free_at), : len(self.free_at)][:, *part]
        x0, y0 = self.origin
        points = np.column_stack(
            [((columns + 0.5) * a + x0).ravel(), ((rows + 0.5) * a + y0).ravel()]
        )
        if self._grid is None:
            return np.zeros((*rows.shape, 2), np.int64), np.zeros(rows.shape, np.bool_)
        cells = np.floor(self._grid.frame.points_to_grid(points)).astype(np.int64)
        on_map = (
            (cells >= 0).all(axis=1)
            & (cells[:, 0] < self._grid.rows)
            & (cells[:, 1] < self._grid.columns)
        )
        return cells.reshape(*rows.shape, 2), on_map.reshape(rows.shape)
