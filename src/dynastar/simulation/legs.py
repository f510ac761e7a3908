"""The legs of people, which a lidar near the ground sees in place of their bodies."""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

LEG_RADIUS = 0.07  # m
APART = 0.18  # m between the two, across the way
STEP = 0.6  # m that a foot is set before the other
MOVED = 1e-4  # m, less of which turns nobody


class Legs:
    """Two discs for each of ``count`` people: one foot stands while the other swings past it.

    They head where they moved last, at first along x.
    """

    def __init__(self, count: int) -> None:
        self._last = np.full((count, 2), np.nan)
        self._heading = np.zeros(count)
        self._walked = STEP * np.arange(count) * 0.618  # nobody walks in step

    def discs(self, centres: Floats) -> Floats:
        """The discs (2 m, 3) of people who are at ``centres`` (m, 2) now: x, y and radius in metres."""
        moved = centres - self._last
        distance = np.nan_to_num(np.hypot(*moved.T))
        walks = distance > MOVED
        self._heading[walks] = np.arctan2(*moved[walks].T[::-1])
        self._walked += distance
        self._last = centres.copy()
        ahead = np.column_stack([np.cos(self._heading), np.sin(self._heading)])
        across = 0.5 * APART * np.column_stack([-ahead[:, 1], ahead[:, 0]])
        feet = []
        for phase, side in ((0.0, -1.0), (0.5, 1.0)):
            place = np.abs((self._walked / (2.0 * STEP) + phase) % 1.0 - 0.5)  # 0.5 to 0 to 0.5
            feet.append(centres + (2.0 * place - 0.5)[:, None] * STEP * ahead + side * across)
        both = np.vstack(feet)
        return np.column_stack([both, np.full(len(both), LEG_RADIUS)])
