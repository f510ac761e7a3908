"""Which cell of the chart lies under each cell of the obstacle layer."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.obstacles.layer import SEEN_OCCUPIED, UNSEEN


@njit(cache=True)
def cells_under(n, resolution, x0, y0, frame_resolution, frame_x, frame_y, yaw, rows, columns):
    """Window [low, high) of the chart's cells under a layer's, and for each of those its index there.

    The layer has n x n cells and its low corner at (x0, y0); the frame is the chart's, of rows x
    columns cells. An index (n, n) counts through the flattened window; its size stands for what lies
    off the chart.
    """
    cos, sin = math.cos(yaw), math.sin(yaw)
    low, high = np.array((rows, columns), np.int64), np.zeros(2, np.int64)
    under = np.empty((n, n, 2), np.int32)
    for i in range(n):
        dy = (i + 0.5) * resolution + y0 - frame_y
        for j in range(n):
            dx = (j + 0.5) * resolution + x0 - frame_x
            row = int(math.floor((cos * dy - sin * dx) / frame_resolution))
            column = int(math.floor((cos * dx + sin * dy) / frame_resolution))
            under[i, j, 0], under[i, j, 1] = row, column
            low[0], low[1] = min(low[0], row), min(low[1], column)
            high[0], high[1] = max(high[0], row + 1), max(high[1], column + 1)
    low = np.maximum(low, 0)
    high = np.minimum(high, np.array((rows, columns), np.int64))
    size = np.maximum(high - low, 0)
    index = np.empty((n, n), np.int64)
    for i in range(n):
        for j in range(n):
            row, column = under[i, j, 0], under[i, j, 1]
            inside = low[0] <= row < high[0] and low[1] <= column < high[1]
            index[i, j] = (
                (row - low[0]) * size[1] + column - low[1] if inside else size[0] * size[1]
            )
    return low, high, index


@njit(cache=True)
def seen_under(states, index, occupied, free):
    """Fills the flattened windows ``occupied`` and ``free`` from a layer's states."""
    occupied[:] = False
    free[:] = False
    for i in range(states.shape[0]):
        for j in range(states.shape[1]):
            at = index[i, j]
            if at < occupied.size and states[i, j] != UNSEEN:
                if states[i, j] == SEEN_OCCUPIED:
                    occupied[at] = True
                else:
                    free[at] = True
