"""What the local map shows, taken over into the planning map's cells that lie under it."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.perception.local_map import SEEN_FREE, SEEN_OCCUPIED


@njit(cache=True)
def cells_under(n, resolution, corner, frame, shape):
    """The planning map's cell under each of a local map's, and the window [low, high) they are in.

    The local map has n x n cells and its low corner at ``corner`` (x, y); ``frame`` (resolution, x, y,
    yaw) and ``shape`` are the planning map's. A cell is an index (n, n) into the flattened planning map,
    or the one behind its last for what lies off it.
    """
    frame_resolution, frame_x, frame_y, yaw = frame
    rows, columns = shape
    cos, sin = math.cos(yaw), math.sin(yaw)
    low, high = np.array((rows, columns), np.int64), np.zeros(2, np.int64)
    under = np.empty((n, n), np.int64)
    for i in range(n):
        dy = (i + 0.5) * resolution + corner[1] - frame_y
        for j in range(n):
            dx = (j + 0.5) * resolution + corner[0] - frame_x
            row = int(math.floor((cos * dy - sin * dx) / frame_resolution))
            column = int(math.floor((cos * dx + sin * dy) / frame_resolution))
            inside = 0 <= row < rows and 0 <= column < columns
            under[i, j] = row * columns + column if inside else rows * columns
            if inside:
                low[0], low[1] = min(low[0], row), min(low[1], column)
                high[0], high[1] = max(high[0], row + 1), max(high[1], column + 1)
    return np.minimum(low, high), high, under


@njit(cache=True)
def take_over(states, window, marks, known, unknown, seen, cleared):
    """Brings ``seen`` and ``cleared`` up to date; returns the window (row, end, column, end) that changed.

    Seen is what a local map's ``states`` show occupied off the ``known`` obstacles, until they show it
    free; cleared is what they show free of the ``unknown``. ``window`` is what ``cells_under`` returns,
    ``marks`` (rows * columns + 1,) room to work in.
    """
    low, high, under = window
    shape = known.shape
    flat, marks = marks, marks[: shape[0] * shape[1]].reshape(shape)
    marks[low[0] : high[0], low[1] : high[1]] = 0
    for i in range(states.shape[0]):
        row_states, row_under = states[i], under[i]
        for j in range(states.shape[1]):
            flat[np.uint64(row_under[j])] |= row_states[j]  # unseen is 0
    top, bottom, left, right = int(high[0]), int(low[0]), int(high[1]), int(low[1])
    first = np.uint64(low[1])
    for row in range(low[0], high[0]):
        marked, is_known, is_unknown = marks[row], known[row], unknown[row]
        was_seen, was_cleared = seen[row], cleared[row]
        for i in range(high[1] - low[1]):
            column = first + np.uint64(i)
            mark = marked[column]
            if mark == 0:
                continue
            occupied = (mark & SEEN_OCCUPIED) != 0 and not is_known[column]
            free = (mark & SEEN_FREE) != 0
            now_seen = occupied or (was_seen[column] and not free)
            now_cleared = (was_cleared[column] or free) and is_unknown[column]
            if now_seen != was_seen[column] or now_cleared != was_cleared[column]:
                was_seen[column], was_cleared[column] = now_seen, now_cleared
                top, bottom = min(top, row), max(bottom, row + 1)
                left, right = min(left, low[1] + i), max(right, low[1] + i + 1)
    return top, bottom, left, right


@njit(cache=True)
def stands_under(states, under, prior, seen, cleared, stands):
    """Fills ``stands`` (n, n): whether something is in each of a local map's cells.

    It is seen there, or stands on the map under it, or lies off the map.
    """
    prior, seen, cleared = prior.reshape(-1), seen.reshape(-1), cleared.reshape(-1)
    off = prior.size
    for i in range(under.shape[0]):
        row_states, row_under, row_stands = states[i], under[i], stands[i]
        for j in range(under.shape[1]):
            at = np.uint64(row_under[j])
            row_stands[j] = row_states[j] == SEEN_OCCUPIED or at == off
            if not row_stands[j]:
                row_stands[j] = (prior[at] and not cleared[at]) or seen[at]
