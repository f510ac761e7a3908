"""What the sensor saw round the robot, in a window that moves along: free, occupied or unseen."""

import math
from itertools import product
from typing import Annotated, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import lower_bounds
from dynastar.config import Field, self_checking
from dynastar.perception import local_map_kernels as kernels
from dynastar.perception.placed_scan import PlacedScan

Disc = tuple[float, float, float]  # x, y, radius, m
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

UNSEEN, SEEN_FREE, SEEN_OCCUPIED = np.arange(3, dtype=np.uint8)  # states of a cell
OFF_CENTRE = 1.0 / 12.0  # of the window's side, by which the robot may be off its middle
SAME = 1e-3  # cells, by which lattices may be apart that count as one
ALL = slice(None), slice(None)
LIDARS = 8  # bits of ``hit_by``
ROUNDED = 1e-6  # relative error of a resolution that was a float32, as in ROS messages


@self_checking
class LocalMapConfig(NamedTuple):
    """The local map's settings."""

    size: Annotated[float, Field("side of the window", "m", 2.0, 100.0)] = 10.0
    memory: Annotated[
        float,
        Field("time after which a cell that is out of sight is unseen again", "s", 1.0, 3600.0),
    ] = 30.0
    narrowest: Annotated[float, Field("smallest width of an obstacle", "m", 0.001, 1.0)] = 0.1


class LocalMap:
    """A square of cells that follows the robot, and when each was last seen how.

    The window lies on a lattice of cells of ``resolution`` (m), one of which has its low corner at
    ``corner`` (x, y). ``boxes`` are those of the hits in the cells that are occupied.

    ``hit_by`` has a bit for each lidar, set by its hits and cleared where it sees the cell free. A cell
    with such a bit is occupied until the hit is forgotten: what one lidar sees, another that looks over
    it does not clear.
    """

    def __init__(
        self,
        config: LocalMapConfig = LocalMapConfig(),
        resolution: float = 0.05,
        corner: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        n = 2 * max(4, math.ceil(0.5 * config.size / resolution))
        self.config, self.resolution, self.corner = config, resolution, corner
        self.row0 = self.column0 = 0  # lattice index of cell [0, 0], even
        self.free_at = np.full((n, n), kernels.NEVER)
        self.hit_at = np.full((n, n), kernels.NEVER)
        self.hit_by = np.zeros((n, n), np.uint8)
        self.boxes = np.full((n, n), whole_cell(resolution))
        self.states = np.zeros((n, n), np.uint8)
        self.open = np.zeros((n, n), np.bool_)
        self.field = np.zeros((n, n), np.float32)
        self._updated = -math.inf  # s

    @property
    def origin(self) -> tuple[float, float]:
        """The window's low corner (x, y) in metres."""
        x, y = self.corner
        return x + self.column0 * self.resolution, y + self.row0 * self.resolution

    @property
    def frame(self) -> tuple[float, float, float]:
        """The side of a cell and the window's low corner, metres."""
        return (self.resolution, *self.origin)

    def lies_on(self, resolution: float, corner: tuple[float, float]) -> bool:
        """Whether this window's cells are cells of another lattice too."""
        offsets = [(a - b) / resolution for a, b in zip(self.corner, corner, strict=True)]
        off = max(abs(offset - round(offset)) for offset in offsets)
        return abs(self.resolution / resolution - 1.0) < ROUNDED and off < SAME

    def moved_onto(self, resolution: float, corner: tuple[float, float]) -> "LocalMap":
        """A window on another lattice.

        A cell is as free as the one under its centre, and has the newest hit whose box it overlaps.
        """
        other = LocalMap(self.config, resolution, corner)
        middle = 0.5 * len(self.states) * self.resolution
        x0, y0 = self.origin
        other.follow(x0 + middle, y0 + middle)
        centres = (np.arange(len(other.states)) + 0.5) * resolution
        x, y = other.origin
        rows = np.floor((centres + y - y0) / self.resolution).astype(np.int64)
        columns = np.floor((centres + x - x0) / self.resolution).astype(np.int64)
        other.free_at = picked(self.free_at, rows, columns, kernels.NEVER)
        self._move_hits(other)
        other._updated = self._updated
        return other

    def _move_hits(self, other: "LocalMap") -> None:
        """Stamp the hits into the cells of another window that their boxes overlap."""
        a, (x0, y0) = other.resolution, self.origin
        rows, columns = np.nonzero(self.hit_by)
        boxes, stamps = self.boxes[rows, columns], self.hit_at[rows, columns]
        lidars = self.hit_by[rows, columns]
        x, y = x0 + (columns + 0.5) * self.resolution, y0 + (rows + 0.5) * self.resolution
        within = (
            0.5 * self.resolution - SAME * a
        )  # a box that stands for all of its cell reaches further
        low_x, high_x = (np.clip(boxes[side], -within, within) for side in ("low_x", "high_x"))
        low_y, high_y = (np.clip(boxes[side], -within, within) for side in ("low_y", "high_y"))
        parts = np.linspace(0.0, 1.0, math.ceil(self.resolution / a) + 1)
        for right, up in product(parts, parts):
            column = np.floor((x + low_x + right * (high_x - low_x) - other.origin[0]) / a)
            row = np.floor((y + low_y + up * (high_y - low_y) - other.origin[1]) / a)
            inside = (row >= 0) & (row < len(other.states))
            inside &= (column >= 0) & (column < len(other.states))
            at = row[inside].astype(np.int64), column[inside].astype(np.int64)
            np.maximum.at(other.hit_at, at, stamps[inside])
            np.bitwise_or.at(other.hit_by, at, lidars[inside])

    def forget(self) -> None:
        """Mark all of the window as unseen."""
        self.free_at.fill(kernels.NEVER)
        self.hit_at.fill(kernels.NEVER)
        self.hit_by.fill(0)

    def follow(self, x: float, y: float) -> None:
        """Keep (x, y) near the middle of the window; cells that leave it are forgotten."""
        a, n = self.resolution, len(self.states)
        x0, y0 = self.corner
        up = math.floor((y - y0) / a) - n // 2 - self.row0
        right = math.floor((x - x0) / a) - n // 2 - self.column0
        up, right = up - up % 2, right - right % 2  # fields of half the resolution stay aligned
        if max(abs(up), abs(right)) * a < OFF_CENTRE * self.config.size:
            return
        rows, columns = np.arange(n) + up, np.arange(n) + right
        self.free_at = picked(self.free_at, rows, columns, kernels.NEVER)
        self.hit_at = picked(self.hit_at, rows, columns, kernels.NEVER)
        self.hit_by = picked(self.hit_by, rows, columns, 0)
        self.boxes = picked(self.boxes, rows, columns, whole_cell(a))
        self.row0, self.column0 = self.row0 + up, self.column0 + right

    def assume_free(self, disc: Disc, now: float, mapped: Mask) -> None:
        """Take a disc round the robot as free, but for hits and the cells ``mapped`` (n, n)."""
        box, inside = self._cells_in(disc)
        free_at = self.free_at[box]
        free = inside & ~mapped[box] & ~self._occupied(now, box)
        free_at[free] = np.maximum(free_at[free], now)

    def keep_free(self, disc: Disc, now: float) -> None:
        """Keep the cells round the robot that were free at the last update from being forgotten."""
        box, inside = self._cells_in(disc)
        free_at = self.free_at[box]
        known = (free_at < now) & (free_at >= self._updated - self.config.memory)
        free_at[inside & known & ~self._occupied(now, box)] = now

    def see(self, scan: PlacedScan, moving: Mask, lidar: int = 0) -> None:
        """Mark what a scan shows; ``moving`` (k,) are the points not to be marked as hits.

        ``lidar`` is the number of the lidar, of which up to LIDARS are told apart.
        """
        bit, now = 1 << lidar % LIDARS, scan.sensor.stamp
        kernels.mark_free((self.free_at, self.hit_by), self.frame, scan.free, scan.sensor, bit)
        layers = self.free_at, self.hit_at, self.hit_by, self.boxes
        times = now, now - self.config.memory
        kernels.mark_hits(layers, self.frame, scan.points, moving, times, bit)

    def _occupied(self, now: float, box: tuple[slice, slice] = ALL) -> Mask:
        """The cells of a box with a hit that is not forgotten."""
        return (self.hit_by[box] > 0) & (self.hit_at[box] >= now - self.config.memory)

    def erase(self, disc: Disc) -> None:
        """Forget the hits in a disc: an obstacle there has turned out to move."""
        box, inside = self._cells_in(disc)
        self.hit_at[box][inside] = kernels.NEVER
        self.hit_by[box][inside] = 0

    def _cells_in(self, disc: Disc) -> tuple[tuple[slice, slice], Mask]:
        """A box of cells round a disc, and which of these have their centre in it."""
        (x, y, radius), (a, x0, y0) = disc, self.frame
        rows, columns = (
            slice(max(0, math.floor((at - radius) / a)), max(0, math.floor((at + radius) / a) + 1))
            for at in (y - y0, x - x0)
        )
        centres = (np.arange(len(self.states)) + 0.5) * a
        dx, dy = x0 + centres[columns] - x, y0 + centres[rows, None] - y
        return (rows, columns), dx * dx + dy * dy <= radius * radius

    def update(self, now: float, barred: Mask, trusted: Mask | None = None) -> None:
        """Bring ``states``, ``open`` and ``field`` up to date; the rim is never open.

        ``field`` is the distance (m) between centres to the nearest cell that is not open. ``barred``
        (n, n) are keep-out cells, which are not open though they may be free. ``trusted`` (n, n) are
        open while unseen.
        """
        self._updated = now
        occupied = self._occupied(now)
        free = ~occupied & (self.free_at >= now - self.config.memory)
        self.states = free * SEEN_FREE + occupied * SEEN_OCCUPIED
        self.open = free & ~barred
        if trusted is not None:
            self.open |= trusted & ~free & ~occupied
        self.open[[0, -1]] = self.open[:, [0, -1]] = False
        self.field = lower_bounds(self.open.view(np.uint8), self.resolution)


def whole_cell(resolution: float) -> npt.NDArray[Any]:
    """The box (one record) of an obstacle anywhere in or near a cell: half a diagonal each way."""
    half = resolution / math.sqrt(2.0)
    return np.array((-half, half, -half, half), kernels.BOX)


def picked(
    values: npt.NDArray[Any], rows: Indices, columns: Indices, fill: Any
) -> npt.NDArray[Any]:
    """``values[rows][:, columns]``, with ``fill`` where an index lies outside."""
    result = values.take(rows, axis=0, mode="clip").take(columns, axis=1, mode="clip")
    result[(rows < 0) | (rows >= values.shape[0])] = fill
    result[:, (columns < 0) | (columns >= values.shape[1])] = fill
    return result
