"""How far it is to what is blocked: distance fields in metres, and exact inflation."""

import math

import cv2
import numpy as np
import numpy.typing as npt

Mask = npt.NDArray[np.bool_]
Field = npt.NDArray[np.float32]

CHAMFER = 1.0 / 1.02  # the chamfer overestimates by less than 2 %
WIDE = 16  # cells, up to which inflating by a mask is the faster way
ROUNDING = 1e-3  # cells, more than the error of a distance
FAR = 1e9  # m, the clearance where nothing is blocked


def distance_field(blocked: npt.ArrayLike, resolution: float) -> Field:
    """Metres from every cell's centre to the centre of the nearest blocked cell.

    ``blocked`` is [rows, columns], ``resolution`` the side of a cell in metres; the result is
    float32 of the same shape, exact but for its rounding, and ``FAR`` everywhere if nothing is
    blocked. What lies outside the map does not count.
    """
    mask = np.asarray(blocked, dtype=bool)
    if not mask.any():
        return np.full(mask.shape, FAR, np.float32)
    return distances(np.ascontiguousarray(~mask).view(np.uint8), resolution)


def distances(free: npt.NDArray[np.uint8], resolution: float) -> Field:
    """``distance_field`` of cells of which some are 0, blocked, and the others 1, free."""
    field = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.multiply(field, np.float32(resolution), out=field)


def lower_bounds(free: npt.NDArray[np.uint8], resolution: float) -> Field:
    """``distances`` up to 2 % smaller, several times as fast: a chamfer of 5 x 5 [Borgefors1986]."""
    field = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_5)
    return np.multiply(field, np.float32(resolution * CHAMFER), out=field)


def inflate(blocked: npt.ArrayLike, radius_cells: float, outside_blocked: bool = True) -> Mask:
    """Where the centre of a disc of ``radius_cells`` cells may not be, exactly.

    A cell is inflated if it is blocked, or its centre is nearer than the radius to the square of a
    blocked cell. On a grid inflated so, a step to a neighbour, diagonal ones between free cells
    included, keeps the radius all the way. ``outside_blocked`` counts what lies beyond the map as
    blocked, so that the disc stays on it.
    """
    mask = np.ascontiguousarray(blocked, dtype=bool)
    reach = math.ceil(radius_cells + 0.5) - 1  # cells with (reach - 0.5) < radius
    if radius_cells <= 0.0 or reach < 1:
        return mask.copy()
    if reach > WIDE:
        return _inflate_widely(mask, radius_cells, outside_blocked)
    away = np.maximum(np.abs(np.arange(-reach, reach + 1)) - 0.5, 0.0)
    disc = np.hypot(away[:, None], away[None, :]) < radius_cells
    grown = cv2.dilate(
        mask.view(np.uint8),
        disc.astype(np.uint8),
        borderType=cv2.BORDER_CONSTANT,
        borderValue=int(outside_blocked),
    )
    return grown.view(np.bool_)


def _inflate_widely(mask: Mask, radius: float, outside_blocked: bool) -> Mask:
    """``inflate`` by the distance to the nearest centre, which only decides up to 0.21 cells.

    The nearest square is 0.5 to 0.71 cells nearer than the nearest centre. Cells in between are
    compared with all blocked cells that are as far away as that.
    """
    reach = min(math.ceil(radius), max(mask.shape)) + 1  # what is farther is off the map
    padded = np.pad(mask, reach, constant_values=outside_blocked)
    away = distance_field(padded, 1.0)[reach:-reach, reach:-reach]
    grown = away < radius + 0.5 - ROUNDING
    rows, columns = np.nonzero(~grown & (away < radius + math.sqrt(0.5) + ROUNDING))
    at = np.arange(-reach, reach + 1)
    beyond = np.maximum(np.abs(at) - 0.5, 0.0)
    far = np.hypot(at[:, None], at) > radius + 0.5 - 2.0 * ROUNDING
    close = np.zeros(len(rows), dtype=bool)
    for up, right in np.argwhere(far & (np.hypot(beyond[:, None], beyond) < radius)):
        close |= padded[rows + up, columns + right]
    grown[rows, columns] = close
    return grown


def distance_to_squares(blocked: Mask, outside_blocked: bool = True) -> Field:
    """Cells from every cell's centre to the square of the nearest blocked cell.

    The square's nearest point is its centre, a corner or the middle of an edge, so that a distance
    field of half the resolution is exact.
    """
    padded = np.pad(blocked, 1, constant_values=outside_blocked)
    points = np.zeros((2 * padded.shape[0] + 1, 2 * padded.shape[1] + 1), dtype=bool)
    for i in range(3):
        for j in range(3):
            points[i : i + 2 * padded.shape[0] : 2, j : j + 2 * padded.shape[1] : 2] |= padded
    return distance_field(points, 0.5)[3:-3:2, 3:-3:2]
