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
from dynastar.field import Field, blocks
from dynastar.perception.local_map import picked

Mask = npt.NDArray[np.bool_]

HIDDEN_RADIUS = 0.25  # m, of a body that unseen space may hold
APPROACH = 0.1  # m by which a person may come nearer than promised before the robot is at rest
COARSENING = 2  # cells of the local map to one of this field


class Hidden(NamedTuple):
    """Distances (m) to the nearest centre of a possible body, and how fast that may move (m/s)."""

    distance: Field
    speed: float

    def later(self, seconds: float) -> "Hidden":
        """The same when the bodies may have moved for some seconds more."""
        if seconds <= 0.0:
            return self
        nearer = self.distance.values - np.float32(self.speed * seconds)
        return self._replace(distance=self.distance._replace(values=nearer))


class HiddenSpace:
    """Keeps until when every cell of the local map is cleared of unseen bodies.

    ``cells`` are those along a side of the local map; ``resolution`` (m) and ``corner`` (x, y) are its
    lattice's.
    """

    def __init__(
        self, cells: int, resolution: float, speed: float, corner: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        n = cells // COARSENING
        self.speed, self._lattice_corner = speed, corner
        self._resolution = resolution * COARSENING
        self._cleared_until = np.full((n, n), -np.inf)
        self._corner = (0, 0)

    def forget(self) -> None:
        """Nothing is cleared any more."""
        self._cleared_until[:] = -np.inf

    def update(
        self, corner: tuple[int, int], seen_free: Mask, occupied: Mask, now: float
    ) -> Hidden:
        """Update from the cells (n, n) of the local map that scans saw free lately, and the occupied ones.

        ``corner`` is the lattice index (row, column) of the local map's first cell.
        """
        self._move_to(corner)
        a, speed = self._resolution, max(self.speed, 1e-6)
        seen = blocks(np.logical_and, seen_free, COARSENING)
        to_cleared = _distances(seen | (self._cleared_until > now))
        to_solid = _distances(blocks(np.logical_or, occupied, COARSENING))
        fits = np.minimum(to_cleared, to_solid) >= HIDDEN_RADIUS / a
        bodies = fits & (to_cleared <= to_solid + 1.0)  # not behind what is cleared
        far = _distances(bodies) * np.float32(a) if bodies.any() else np.full(bodies.shape, FAR)
        distance = far.astype(np.float32)
        reach = np.maximum(distance[seen].astype(np.float64) - HIDDEN_RADIUS, 0.0)
        self._cleared_until[seen] = now + reach / speed
        (x0, y0), (row, column) = self._lattice_corner, corner
        field = Field(distance, x0 + column * a / COARSENING, y0 + row * a / COARSENING, a)
        return Hidden(field, self.speed)

    def _move_to(self, corner: tuple[int, int]) -> None:
        """Move the window to a corner in cells of the local map; what comes in is not cleared."""
        n = len(self._cleared_until)
        up, right = ((a - b) // COARSENING for a, b in zip(corner, self._corner, strict=True))
        if (up, right) != (0, 0):
            rows, columns = np.arange(n) + up, np.arange(n) + right
            self._cleared_until = picked(self._cleared_until, rows, columns, -np.inf)
        self._corner = corner


def _distances(marked: Mask) -> npt.NDArray[np.float64]:
    """Cells from the centre of each cell to that of the nearest ``marked`` one."""
    unmarked = (~marked).view(np.uint8)
    return cv2.distanceTransform(unmarked, cv2.DIST_L2, cv2.DIST_MASK_5).astype(np.float64)
