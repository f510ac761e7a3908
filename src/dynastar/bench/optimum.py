"""The shortest ways for a point, found by looking at every pair of places: bounds, not planners."""

import numpy as np
import numpy.typing as npt

from dynastar.planning import straighten
from dynastar.planning.any_angle import shortest_lines
from dynastar.planning.segments import mask_bytes
from dynastar.planning.smoothing import polyline_length

BESIDE = 1e-7  # cells from a corner to the place where a way may turn round it

Points = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def shortest_over_centres(occupied: Mask, way: Points) -> Points:
    """The shortest line (n, 2) of straight pieces between free cells' centres, from a way's end to end.

    ``way`` (n, 2), (row, column) in fractions of cells, goes cell by cell.
    """
    near = straighten(occupied, way, 0.0)
    return straighten(occupied, way, 0.0, near, reach=len(occupied))


def shortest_over_corners(occupied: Mask, way: Points) -> Points:
    """The shortest line (n, 2) of all between a way's ends: it turns at corners of cells alone."""
    places = np.vstack([way[[0, -1]], _beside_corners(occupied)])
    blocked = mask_bytes(occupied)
    return np.asarray(shortest_lines(blocked, places, 0.0, polyline_length(way)))


def _beside_corners(occupied: Mask) -> Points:
    """The places (n, 2) just off each corner that stands out, on the side that is free."""
    low_left, low_right = occupied[:-1, :-1], occupied[:-1, 1:]
    high_left, high_right = occupied[1:, :-1], occupied[1:, 1:]
    found = []
    for y, x, behind, here, beside in (
        (1, 1, low_left, high_right, (low_right, high_left)),
        (-1, -1, high_right, low_left, (low_right, high_left)),
        (1, -1, low_right, high_left, (low_left, high_right)),
        (-1, 1, high_left, low_right, (low_left, high_right)),
    ):
        stands_out = behind & ~here & ~beside[0] & ~beside[1]
        found.append(np.argwhere(stands_out) + 1 + BESIDE * np.array([y, x]))
    return np.vstack(found)
