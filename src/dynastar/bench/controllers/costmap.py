"""A static costmap: the map, and what the lidar has seen since, marked and cleared beam by beam."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, compose
from dynastar.grid import OccupancyGrid, Unknown
from dynastar.scan import LaserScan

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FINEST = 0.03  # m, size of a cell, unless the map is finer or too large
MOST_CELLS = 800_000
REACH = 8.0  # m, up to which beams mark and clear
PADDING = 0.01  # m, added to the footprint where contact is looked for
EDGE_SPACING = 0.03  # m, so that no cell slips between
_SUBCELL = 4  # bits of a cell's fraction that polygons are drawn with


class Costmap:
    """Cells that are blocked: by the map, or because a beam ended there and none has passed since.

    Everything seen counts as static, as in the costmaps of Nav2 [Macenski2020]: who walks away is
    cleared by the next beams through there. ``mapped`` are the cells that the map blocks.
    """

    def __init__(self, grid: OccupancyGrid, unknown: Unknown) -> None:
        factor = max(1, round(grid.resolution / FINEST))
        while factor > 1 and grid.rows * grid.columns * factor**2 > MOST_CELLS:
            factor -= 1
        self.factor = factor  # cells to the side of a cell of the map
        self.grid = grid.refined(factor)
        self.resolution = self.grid.resolution
        self.mapped: Mask = self.grid.blocked(unknown)
        self._hits = np.zeros(self.mapped.shape, bool)
        self.blocked: Mask = self.mapped.copy()

    def see(self, pose: Pose2D, scan: LaserScan) -> tuple[int, int, Mask] | None:
        """Takes in a scan from the robot at ``pose``.

        Returns the window that changed, as (first row, first column, blocked cells), or None.
        """
        sensor = compose(pose, scan.mount)
        ranges = scan.ranges.astype(np.float64)
        known = ~np.isnan(ranges) & (ranges >= max(scan.range_min, 1e-6))
        hit = known & (ranges <= min(REACH, scan.range_max - 1e-3))
        reach = min(REACH, scan.range_max)
        clear = np.where(known, np.minimum(ranges - self.resolution, reach), 0.0).clip(0.0)
        angles = scan.angles + sensor.theta
        swept = self._swept(sensor, angles, clear)
        ends = self._cells(sensor, angles[hit], ranges[hit])
        corners = np.vstack([swept, ends]) if len(ends) else swept
        shape = np.array(self.blocked.shape)
        low = np.floor(corners.min(axis=0)).astype(int).clip(0, shape)
        high = (np.floor(corners.max(axis=0)).astype(int) + 1).clip(0, shape)
        if (high <= low).any():
            return None
        window = np.zeros(high - low, np.uint8)
        drawn = np.round((swept[:, ::-1] - low[::-1] - 0.5) * 2**_SUBCELL).astype(np.int32)
        cv2.fillPoly(window, [drawn], 1, shift=_SUBCELL)
        part = np.s_[low[0] : high[0], low[1] : high[1]]
        hits = self._hits[part]
        hits[window.view(bool)] = False
        cells = np.floor(ends).astype(int) - low
        cells = cells[((cells >= 0) & (cells < high - low)).all(axis=1)]
        hits[cells[:, 0], cells[:, 1]] = True
        now = hits | self.mapped[part]
        if np.array_equal(now, self.blocked[part]):
            return None
        self.blocked[part] = now
        return int(low[0]), int(low[1]), now

    def keep(self, corner: tuple[int, int], cells: Mask) -> None:
        """Leaves out of the next ``see`` what was seen in a window but not in its ``cells``."""
        (top, left), (rows, columns) = corner, cells.shape
        self._hits[top : top + rows, left : left + columns] &= cells

    def forget(self) -> None:
        """Back to the map alone."""
        self._hits[:] = False
        self.blocked = self.mapped.copy()

    def _swept(self, sensor: Pose2D, angles: Floats, clear: Floats) -> Floats:
        """The polygon, in (row, column), between beams as far as the shorter of two neighbours."""
        shorter = np.minimum(clear[:-1], clear[1:])
        at = np.column_stack([angles[:-1], angles[1:]]).ravel()
        fan = self._cells(sensor, at, np.repeat(shorter, 2))
        return np.vstack([self._cells(sensor, np.zeros(1), np.zeros(1)), fan])

    def _cells(self, sensor: Pose2D, angles: Floats, ranges: Floats) -> Floats:
        ends = np.column_stack(
            [sensor.x + ranges * np.cos(angles), sensor.y + ranges * np.sin(angles)]
        )
        return self.grid.frame.points_to_grid(ends)

    def window(self, pose: Pose2D, reach: float) -> tuple[Mask, tuple[int, int]]:
        """The cells within ``reach`` metres of ``pose`` that are blocked, and the first of them."""
        row, column = self.grid.frame.to_grid(pose.x, pose.y)
        half = reach / self.resolution
        rows, columns = self.blocked.shape
        top, left = max(int(row - half), 0), max(int(column - half), 0)
        bottom, right = min(int(row + half) + 2, rows), min(int(column + half) + 2, columns)
        blocked = self.blocked[top : max(bottom, top + 1), left : max(right, left + 1)]
        return blocked, (top, left)

    def surroundings(self, pose: Pose2D, reach: float) -> "Surroundings":
        """The blocked cells within ``reach`` metres of ``pose``, to look for contact in."""
        return Surroundings(self.grid, *self.window(pose, reach))


def covering(footprint: Footprint) -> Floats:
    """Discs (k, 3) of x, y and radius, metres, that a footprint is checked by.

    A disc is itself; a polygon is its inscribed disc and small ones along its edge.
    """
    middle = np.array([[0.0, 0.0, footprint.inscribed]])
    if footprint.is_disc:
        return middle
    ring = np.vstack([footprint.vertices, footprint.vertices[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))])
    at = np.linspace(0.0, arc[-1], math.ceil(arc[-1] / EDGE_SPACING), endpoint=False)
    edge = np.column_stack([np.interp(at, arc, ring[:, 0]), np.interp(at, arc, ring[:, 1])])
    return np.vstack([middle, np.column_stack([edge, np.zeros(len(edge))])])


class Surroundings:
    """Distances (m) to what is blocked near the robot."""

    def __init__(self, grid: OccupancyGrid, blocked: Mask, corner: tuple[int, int]) -> None:
        self._frame, self._corner = grid.frame, np.array(corner)
        free = np.pad((~blocked).astype(np.uint8), 1)  # what lies outside is not free
        self._field = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)

    def gaps(self, poses: Floats, discs: Floats) -> Floats:
        """Metres (n,) from ``covering`` discs (k, 3) at poses (n, 3) to what is blocked, or less."""
        cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
        x = poses[:, :1] + cos * discs[:, 0] - sin * discs[:, 1]
        y = poses[:, 1:2] + sin * discs[:, 0] + cos * discs[:, 1]
        cells = self._frame.points_to_grid(np.column_stack([x.ravel(), y.ravel()]))
        # Between the centres of cells, linearly.
        at = (cells - self._corner + 0.5).clip(0.0, np.array(self._field.shape) - 1.001)
        row, column = np.floor(at).astype(int).T
        up, right = (at - np.floor(at)).T
        field = self._field
        below = field[row, column] * (1.0 - right) + field[row, column + 1] * right
        above = field[row + 1, column] * (1.0 - right) + field[row + 1, column + 1] * right
        away = (below * (1.0 - up) + above * up).reshape(x.shape) - 0.5
        gaps: Floats = (away * self._frame.resolution - discs[:, 2]).min(axis=1) - PADDING
        return gaps
