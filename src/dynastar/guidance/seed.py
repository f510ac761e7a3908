"""Where the cost-to-go begins: the place at which the global path leaves the local map."""

import math

import numpy as np

from dynastar.compiled import njit

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


@njit(cache=True)
def path_exit_cell(points, arc, span, cost, reach):
    """Last cell (row, column) of a path inside the field ``cost``, and its arc length (m).

    ``points`` (n, 2) and ``arc`` (n,) are the path and its arc length, looked at every half cell over
    ``span`` (begin, end) in metres. The cell is that before the path leaves the field for the first
    time, moved back to the nearest one (within ``reach`` cells of the path) where the robot fits.
    """
    rows, columns = cost.values.shape
    begin, end = span
    count = max(2, int(math.ceil((end - begin) / (0.5 * cost.resolution))) + 1)
    cells = np.empty((count, 2), np.int64)
    last, segment = count - 1, 0
    for k in range(count):
        s = begin + (end - begin) * k / (count - 1)
        while segment < len(arc) - 2 and arc[segment + 1] < s:
            segment += 1
        x, y = points[segment, 0], points[segment, 1]
        if len(arc) > 1:
            length = max(arc[segment + 1] - arc[segment], 1e-12)
            fraction = min(max((s - arc[segment]) / length, 0.0), 1.0)
            x += fraction * (points[segment + 1, 0] - x)
            y += fraction * (points[segment + 1, 1] - y)
        row = int(math.floor((y - cost.y0) / cost.resolution))
        column = int(math.floor((x - cost.x0) / cost.resolution))
        cells[k, 0], cells[k, 1] = min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)
        if not (RIM <= row < rows - RIM and RIM <= column < columns - RIM):
            last = max(k - 1, 0)
            break
    for k in range(last, -1, -1):
        row, column = nearest_open(cost.values, cells[k, 0], cells[k, 1], reach)
        if cost.values[row, column] < np.inf:
            return row, column, begin + (end - begin) * k / (count - 1)
    return cells[last, 0], cells[last, 1], begin + (end - begin) * last / (count - 1)
