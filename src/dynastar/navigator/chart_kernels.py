"""What the obstacle layer shows, taken over into the chart's cells that lie under it."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.obstacles.layer import SEEN_OCCUPIED, UNSEEN

OFF = -1  # the index of what lies off the chart


@njit(cache=True)
def cells_under(n, resolution, x0, y0, frame_resolution, frame_x, frame_y, yaw, rows, columns):
    """Which cell of the chart lies under each of a layer's, and the window [low, high) they are in.

    The layer has n x n cells and its low corner at (x0, y0); the frame is the chart's, of rows x
    columns cells. The cell is an index (n, n) into the flattened chart, or ``OFF``.
    """
    cos, sin = math.cos(yaw), math.sin(yaw)
    low, high = np.array((rows, columns), np.int64), np.zeros(2, np.int64)
    under = np.empty((n, n), np.int64)
    for i in range(n):
        dy = (i + 0.5) * resolution + y0 - frame_y
        for j in range(n):
            dx = (j + 0.5) * resolution + x0 - frame_x
            row = int(math.floor((cos * dy - sin * dx) / frame_resolution))
            column = int(math.floor((cos * dx + sin * dy) / frame_resolution))
            inside = 0 <= row < rows and 0 <= column < columns
            under[i, j] = row * columns + column if inside else OFF
            if inside:
                low[0], low[1] = min(low[0], row), min(low[1], column)
                high[0], high[1] = max(high[0], row + 1), max(high[1], column + 1)
    return low, high, under


@njit(cache=True)
def take_over(states, under, low, high, marks, known, unknown, seen, cleared):
    """Brings ``seen`` and ``cleared`` up to date; returns the window (row, end, column, end) that changed.

    Seen is what a layer's ``states`` show occupied off the ``known`` obstacles, until they show it
    free; cleared is what they show free of the ``unknown``. ``marks`` is room to work in.
    """
    marks[low[0] : high[0], low[1] : high[1]] = 0
    flat = marks.reshape(-1)
    for i in range(states.shape[0]):
        for j in range(states.shape[1]):
            if states[i, j] != UNSEEN and under[i, j] != OFF:
                flat[under[i, j]] |= 1 if states[i, j] == SEEN_OCCUPIED else 2
    top, bottom, left, right = np.int64(1) << 62, 0, np.int64(1) << 62, 0
    for row in range(low[0], high[0]):
        for column in range(low[1], high[1]):
            occupied = (marks[row, column] & 1) != 0 and not known[row, column]
            free = (marks[row, column] & 2) != 0
            is_seen = occupied or (seen[row, column] and not free)
            is_cleared = (cleared[row, column] or free) and unknown[row, column]
            if is_seen != seen[row, column] or is_cleared != cleared[row, column]:
                seen[row, column], cleared[row, column] = is_seen, is_cleared
                top, bottom = min(top, row), max(bottom, row + 1)
                left, right = min(left, column), max(right, column + 1)
    return top, bottom, left, right


@njit(cache=True)
def stands_under(under, prior, seen, cleared, blocked):
    """Fills ``blocked`` (n, n): whether something stands under each of a layer's cells, or no chart."""
    prior, seen, cleared = prior.reshape(-1), seen.reshape(-1), cleared.reshape(-1)
    for i in range(under.shape[0]):
        for j in range(under.shape[1]):
            at = under[i, j]
            blocked[i, j] = at == OFF or (prior[at] and not cleared[at]) or seen[at]
