"""Where somebody may be hidden: unseen space as a distance field of possible bodies.

A cell is cleared while nobody can have come to it since it was last seen: until the time of the scan
plus the distance to the nearest possible body, over ``hidden_speed``. Bodies of a radius fit where
no cleared and no occupied cell is nearer than that.
"""

from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.clearance import FAR

Floats = npt.NDArray[np.float32]

HIDDEN_RADIUS = 0.25  # m, of a body that unseen space may hold
SLACK = 0.1  # m that somebody may come nearer than the promise has it before a robot stands
FACTOR = 2  # cells of the local map to one of this field


class Hidden(NamedTuple):
    """Distances (m) to the nearest centre of a possible body, over the local map."""

    distance: Floats
    x0: float
    y0: float
    resolution: float
    radius: float
    speed: float
    slack: float


class HiddenSpace:
    """Keeps until when every cell of the local map is cleared of unseen bodies."""

    def __init__(self, cells: int, resolution: float, speed: float) -> None:
        n = cells // FACTOR
        self.speed = speed
        self._resolution = resolution * FACTOR
        self._cleared_until = np.full((n, n), -np.inf)
        self._distance = np.full((n, n), 0.0, np.float32)
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
        n = len(self._cleared_until)
        self._shift(corner)
        rows = slice(0, n * FACTOR)
        seen = block_all(seen_free[rows, rows])
        solid = block_any(occupied[rows, rows])
        cleared = seen | (self._cleared_until > now)
        a = self._resolution
        near_cleared = cv2.distanceTransform((~cleared).astype(np.uint8), cv2.DIST_L2, 5) * a
        near_solid = cv2.distanceTransform((~solid).astype(np.uint8), cv2.DIST_L2, 5) * a
        bodies = (near_cleared >= HIDDEN_RADIUS) & (near_solid >= HIDDEN_RADIUS)
        bodies &= near_cleared <= near_solid + a
        if bodies.any():
            self._distance = cv2.distanceTransform((~bodies).astype(np.uint8), cv2.DIST_L2, 5) * a
        else:
            self._distance = np.full((n, n), FAR, np.float32)
        reach = np.maximum(self._distance - HIDDEN_RADIUS, 0.0)
        self._cleared_until = np.where(
            seen, now + reach / max(self.speed, 1e-6), self._cleared_until
        )
        return Hidden(
            np.ascontiguousarray(self._distance, np.float32),
            corner[1] * a / FACTOR,
            corner[0] * a / FACTOR,
            a,
            HIDDEN_RADIUS,
            self.speed,
            SLACK,
        )

    def _shift(self, corner: tuple[int, int]) -> None:
        down = (corner[0] - self._corner[0]) // FACTOR
        right = (corner[1] - self._corner[1]) // FACTOR
        self._corner = corner
        if down == 0 and right == 0:
            return
        n = len(self._cleared_until)
        moved = np.full((n, n), -np.inf)
        if abs(down) < n and abs(right) < n:
            to = np.s_[max(-down, 0) : n - max(down, 0), max(-right, 0) : n - max(right, 0)]
            of = np.s_[max(down, 0) : n - max(-down, 0), max(right, 0) : n - max(-right, 0)]
            moved[to] = self._cleared_until[of]
        self._cleared_until = moved


def block_all(mask: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Whether all of each FACTOR x FACTOR block is set."""
    return mask[::2, ::2] & mask[1::2, ::2] & mask[::2, 1::2] & mask[1::2, 1::2]


def block_any(mask: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Whether any of each FACTOR x FACTOR block is set."""
    return mask[::2, ::2] | mask[1::2, ::2] | mask[::2, 1::2] | mask[1::2, 1::2]
