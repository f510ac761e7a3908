"""Fields of numbers on square cells, and how kernels read them between the cells' centres."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner


class Field(NamedTuple):
    """A number in every cell: ``values`` [rows, columns], low corner (x0, y0) and cell side in metres.

    Of a distance field the values are metres from a cell's centre to the nearest marked cell's.
    """

    values: npt.NDArray[np.floating]
    x0: float
    y0: float
    resolution: float


def blocks(combine: np.ufunc, cells: npt.NDArray[Any], side: int) -> npt.NDArray[Any]:
    """``combine`` of all ``side`` x ``side`` cells of each block; rows and columns are multiples of it."""
    rows = combine.reduce(cells.reshape(-1, side, cells.shape[1]), axis=1)
    return np.asarray(combine.reduce([rows[:, j::side] for j in range(side)]))


@inner
def is_inside(field, x, y):
    """Whether a point lies between the centres of the field's outermost cells."""
    rows, columns = field.values.shape
    per_cell = 1.0 / field.resolution
    fx, fy = (x - field.x0) * per_cell - 0.5, (y - field.y0) * per_cell - 0.5
    return (fx >= 0.0) & (fy >= 0.0) & (fx < columns - 1.0) & (fy < rows - 1.0)


@inner
def locate(field, x, y):
    """The cell whose centre lies below and left of a point, and how far beyond it that is in cells.

    Returns (row, column, up, right). A point outside counts as the nearest one inside.
    """
    rows, columns = field.values.shape
    per_cell = 1.0 / field.resolution
    fx, fy = (x - field.x0) * per_cell - 0.5, (y - field.y0) * per_cell - 0.5
    fx, fy = min(max(fx, 0.0), columns - 1.001), min(max(fy, 0.0), rows - 1.001)
    row, column = int(fy), int(fx)
    return row, column, fy - row, fx - column


@inner
def bilinear(field, x, y):
    """The field's value at a point, bilinear between the cells' centres."""
    row, column, up, right = locate(field, x, y)
    below, above = field.values[np.uint64(row)], field.values[np.uint64(row + 1)]
    i, j = np.uint64(column), np.uint64(column + 1)
    return (1.0 - up) * ((1.0 - right) * below[i] + right * below[j]) + up * (
        (1.0 - right) * above[i] + right * above[j]
    )
