"""Occlusion: unseen space as a distance field of possible bodies.

A cell is cleared while nobody can have come to it since it was last seen: until the time of the scan
plus the distance to the nearest possible body, over ``hidden_speed``. Bodies of a radius fit where
no cleared and no occupied cell is nearer than that.
"""

from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.clearance import FAR
from dynastar.compiled import njit
from dynastar.field import Field
from dynastar.perception.local_map import picked

Floats = npt.NDArray[np.float32]

HIDDEN_RADIUS = 0.25  # m, of a body that unseen space may hold
SLACK = 0.1  # m by which a person may come nearer than promised before the robot is at rest
FACTOR = 2  # cells of the local map to one of this field


class Hidden(NamedTuple):
    """Distances (m) to the nearest centre of a possible body, over the local map."""

    distance: Field
    radius: float
    speed: float
    slack: float


class HiddenSpace:
    """Keeps until when every cell of the local map is cleared of unseen bodies.

    ``cells`` are those along a side of the local map; ``resolution`` (m) and ``corner`` (x, y) are its
    lattice's.
    """

    def __init__(
        self,
        cells: int,
        resolution: float,
        speed: float,
        corner: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        n = cells // FACTOR
        self.speed, self._lattice_corner = speed, corner
        self._resolution = resolution * FACTOR
        self._cleared_until = np.full((n, n), -np.inf)
        self._distance = np.full((n, n), 0.0, np.float32)
        self._masks = (
            np.empty((n, n), np.bool_),
            np.empty((n, n), np.uint8),
            np.empty((n, n), np.uint8),
        )
        self._corner = (0, 0)

    def forget(self) -> None:
        """Nothing is cleared any more."""
        self._cleared_until[:] = -np.inf

    def update(
        self,
        corner: tuple[int, int],
        seen_free: npt.NDArray[np.bool_],
        occupied: npt.NDArray[np.bool_],
        now: float,
    ) -> Hidden:
        """Takes in which cells (n, n) of the local map the last scans saw free, and which are occupied.

        ``corner`` is the lattice index (row, column) of the local map's first cell.
        """
        self._move_to(corner)
        cleared_until, a = self._cleared_until, self._resolution
        seen, uncleared, soft = self._masks
        sort_cells(seen_free, occupied, cleared_until, now, seen, uncleared, soft)
        near_cleared = cv2.distanceTransform(uncleared, cv2.DIST_L2, 5)
        near_solid = cv2.distanceTransform(soft, cv2.DIST_L2, 5)
        if find_bodies(near_cleared, near_solid, HIDDEN_RADIUS / a, uncleared):
            self._distance = cv2.distanceTransform(uncleared, cv2.DIST_L2, 5) * np.float32(a)
        else:
            self._distance = np.full(cleared_until.shape, FAR, np.float32)
        keep_clear(cleared_until, seen, self._distance, HIDDEN_RADIUS, now, max(self.speed, 1e-6))
        distance = np.ascontiguousarray(self._distance, np.float32)
        (x0, y0), (row, column) = self._lattice_corner, corner
        field = Field(distance, x0 + column * a / FACTOR, y0 + row * a / FACTOR, a)
        return Hidden(field, HIDDEN_RADIUS, self.speed, SLACK)

    def _move_to(self, corner: tuple[int, int]) -> None:
        """Moves the window to a corner in cells of the local map; what comes in is not cleared."""
        n = len(self._cleared_until)
        up, right = ((a - b) // FACTOR for a, b in zip(corner, self._corner, strict=True))
        if (up, right) != (0, 0):
            rows, columns = np.arange(n) + up, np.arange(n) + right
            self._cleared_until = picked(self._cleared_until, rows, columns, -np.inf)
        self._corner = corner


@njit(cache=True)
def sort_cells(seen_free, occupied, cleared_until, now, seen, uncleared, soft):
    """Sorts this field's cells by those of the local map, ``FACTOR`` x ``FACTOR`` to one.

    ``seen`` are those all of which were just seen free, ``uncleared`` (uint8) is 0 where nobody can be
    by now, ``soft`` (uint8) 0 where something stands.
    """
    rows, columns = seen.shape
    for row in range(rows):
        for column in range(columns):
            free, solid = True, False
            for i in range(FACTOR * row, FACTOR * row + FACTOR):
                for j in range(FACTOR * column, FACTOR * column + FACTOR):
                    free &= seen_free[i, j]
                    solid |= occupied[i, j]
            seen[row, column] = free
            uncleared[row, column] = not (free or cleared_until[row, column] > now)
            soft[row, column] = not solid


@njit(cache=True)
def find_bodies(near_cleared, near_solid, radius, nobody):
    """Mark where a hidden person's centre may be: 0 in ``nobody`` (uint8), else 1.

    Returns True if there is any such cell. A body of ``radius`` (cells) fits where nothing cleared
    and nothing solid is nearer, and hides where what is cleared is no more than a cell further away
    than what is solid.
    """
    found = False
    rows, columns = nobody.shape
    for row in range(rows):
        for column in range(columns):
            cleared, solid = near_cleared[row, column], near_solid[row, column]
            body = cleared >= radius and solid >= radius and cleared <= solid + 1.0
            nobody[row, column] = not body
            found |= body
    return found


@njit(cache=True)
def keep_clear(cleared_until, seen, distance, radius, now, speed):
    """Notes until when (s) nobody can have come to the cells that were just seen."""
    rows, columns = seen.shape
    for row in range(rows):
        for column in range(columns):
            if seen[row, column]:
                reach = max(distance[row, column] - radius, 0.0)
                cleared_until[row, column] = now + reach / speed
