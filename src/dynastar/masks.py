"""Keep-out zones and speed limits as masks over a map, as Nav2's costmap filters have them."""

import math
from collections.abc import Iterator
from itertools import product
from typing import Annotated, Literal, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.config import Field, self_checking
from dynastar.errors import MapError
from dynastar.grid import OCCUPIED_FROM, OccupancyGrid

Cells = npt.NDArray[np.int64]

ROUNDED = 1e-6  # relative error of a resolution that was a float32, as in ROS messages
AT_ONCE = 2**18  # cells that a mask is laid over at a time, to bound the memory


@self_checking
class SpeedScale(NamedTuple):
    """Meaning of the values of a speed mask, 0 to 100: ``base + multiplier * value``."""

    type: Annotated[
        Literal["percent", "absolute"], Field("per cent of the robot's top speed, or m/s")
    ] = "percent"
    base: Annotated[float, Field("limit where the mask is 0", "", -1e3, 1e3)] = 100.0
    multiplier: Annotated[float, Field("of the mask's value", "", -1e3, 1e3)] = -1.0


def with_keepout(grid: OccupancyGrid, mask: OccupancyGrid) -> OccupancyGrid:
    """``grid`` with keep-out zones where ``mask``, of any resolution, is occupied."""
    keepout = np.zeros(grid.values.shape, np.bool_)
    for index, values in _laid_over(grid, mask, mask.values >= OCCUPIED_FROM):
        keepout.flat[index[values >= OCCUPIED_FROM]] = True
    if grid.keepout is not None:
        keepout |= grid.keepout
    return OccupancyGrid(grid.values, grid.frame, keepout, grid.speed_limit)


def zone_around(grid: OccupancyGrid, cell: tuple[int, int]) -> npt.NDArray[np.bool_] | None:
    """The keep-out zone [rows, columns] that holds a cell: the cells without obstacles connected with it.

    None if the cell is occupied, or in no zone.
    """
    if grid.keepout is None or not grid.keepout[cell] or grid.occupied[cell]:
        return None
    inside = grid.keepout & ~grid.occupied
    _, parts = cv2.connectedComponents(inside.view(np.uint8), connectivity=4)
    zone: npt.NDArray[np.bool_] = parts == parts[cell]
    return zone


def with_speed_limits(
    grid: OccupancyGrid, mask: OccupancyGrid, v_max: float, scale: SpeedScale = SpeedScale()
) -> OccupancyGrid:
    """``grid`` with speed limits (m/s) from ``mask``, of any resolution, and the robot's ``v_max``.

    Where the mask is unknown, 0 or absent there is no limit, nor where the scale says 0, as in Nav2.
    Raises MapError where it says less than that.
    """
    by_value = _limits_by_value(v_max, scale)
    limits = np.full(grid.values.shape, math.inf, np.float32)
    for index, values in _laid_over(grid, mask, by_value[mask.values.view(np.uint8)] < math.inf):
        np.minimum.at(limits.reshape(-1), index, by_value[values.view(np.uint8)])
    if (limits < 0.0).any():
        lowest = limits.min() / (0.01 * v_max if scale.type == "percent" else 1.0)
        raise MapError(
            f"a speed mask has limits down to {lowest:g} with base {scale.base:g} and "
            f"multiplier {scale.multiplier:g}: expected 0 or more"
        )
    if grid.speed_limit is not None:
        np.minimum(limits, grid.speed_limit, out=limits)
    return OccupancyGrid(grid.values, grid.frame, grid.keepout, limits)


def _limits_by_value(v_max: float, scale: SpeedScale) -> npt.NDArray[np.float32]:
    """Speed limits (m/s) for each value of a mask as uint8, [256]; inf for none."""
    values = np.arange(256, dtype=np.uint8).view(np.int8).astype(np.float64)
    limits = scale.base + scale.multiplier * values
    limits[(values <= 0) | (limits == 0.0)] = math.inf
    if scale.type == "percent":
        limits *= 0.01 * v_max
    return limits.astype(np.float32)


def _laid_over(
    grid: OccupancyGrid, mask: OccupancyGrid, counts: npt.NDArray[np.bool_]
) -> Iterator[tuple[Cells, npt.NDArray[np.int8]]]:
    """Cells of ``grid`` (flat indices) and the mask's values there, bit by bit.

    A cell has the value at its centre, and those of all of the mask's cells that count and have their
    centre in it, or a corner where the mask is finer: so no zone is lost.
    """
    is_finer = mask.resolution < grid.resolution * (1.0 - ROUNDED)
    values = mask.values.reshape(-1)
    if not is_finer:
        for part in _bits(grid.values.size):
            here, over = _under(grid, part, (0.5, 0.5), mask)
            yield here, values[over]
    inset = (ROUNDED, 1.0 - ROUNDED) if is_finer else (0.5,)
    for part in _bits(values.size):
        for offset in product(inset, inset):
            over, here = _under(mask, part[counts.reshape(-1)[part]], offset, grid)
            yield here, values[over]


def _bits(size: int) -> Iterator[Cells]:
    """The numbers below ``size``, some at a time."""
    for first in range(0, size, AT_ONCE):
        yield np.arange(first, min(first + AT_ONCE, size))


def _under(
    grid: OccupancyGrid, cells: Cells, offset: tuple[float, ...], other: OccupancyGrid
) -> tuple[Cells, Cells]:
    """Those of a grid's cells that lie on another by a point at ``offset`` in them, and its cells there."""
    points = np.column_stack(np.divmod(cells, grid.columns)) + offset
    found = np.floor(other.frame.points_to_grid(grid.frame.points_to_world(points))).astype(
        np.int64
    )
    inside = ((found >= 0) & (found < (other.rows, other.columns))).all(axis=1)
    return cells[inside], found[inside] @ (other.columns, 1)
