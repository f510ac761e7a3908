"""Where the cost-to-go begins: the place at which the global path leaves the local map."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.field import Field
from dynastar.path import Path

RIM = 2  # cells at the border of the local map that a path has left it in


@njit(cache=True)
def nearest_open(cost, row, column, reach):
    """The nearest cell where the robot fits, up to ``reach`` cells away, else the cell itself."""
    rows, columns = cost.shape
    if cost[row, column] < np.inf:
        return row, column
    best_row, best_column, nearest = row, column, 2 * reach * reach + 1
    for i in range(max(row - reach, 0), min(row + reach + 1, rows)):
        for j in range(max(column - reach, 0), min(column + reach + 1, columns)):
            square = (i - row) * (i - row) + (j - column) * (j - column)
            if cost[i, j] < np.inf and square < nearest:
                best_row, best_column, nearest = i, j, square
    return best_row, best_column


def path_exit_cell(
    path: Path, span: tuple[float, float], cost: Field, reach: int
) -> tuple[int, int, float]:
    """Last cell (row, column) of a path inside the field ``cost``, and its arc length (m).

    The path is looked at every half cell over ``span`` (begin, end) in metres. The cell is that before
    it leaves the field for the first time, moved back to the nearest one (within ``reach`` cells of the
    path) where the robot fits.
    """
    (begin, end), arc, shape = span, path.arc, np.array(cost.values.shape)
    count = max(2, math.ceil((end - begin) / (0.5 * cost.resolution)) + 1)
    s = begin + (end - begin) * np.arange(count) / (count - 1)
    before = np.searchsorted(arc[1:-1], s)  # the points of the path before and after each place
    after = np.minimum(before + 1, len(arc) - 1)
    fraction = np.clip((s - arc[before]) / np.maximum(arc[after] - arc[before], 1e-12), 0.0, 1.0)
    first, second = path.points[before], path.points[after]
    places = first + fraction[:, None] * (second - first) - (cost.x0, cost.y0)
    cells = np.floor(places[:, ::-1] / cost.resolution).astype(np.int64)
    inside = ((cells >= RIM) & (cells < shape - RIM)).all(axis=1)
    last = count - 1 if inside.all() else max(int(np.argmin(inside)) - 1, 0)
    way = np.clip(cells[: last + 1], 0, shape - 1).tolist()
    for k in range(last, -1, -1):
        row, column = nearest_open(cost.values, *way[k], reach)
        if cost.values[row, column] < np.inf:
            return row, column, float(s[k])
    return (*way[last], float(s[last]))
