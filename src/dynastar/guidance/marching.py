"""Fast marching [Sethian1996] over a grid of costs, with a queue of buckets [Yatziv2006].

A cell whose value falls once more is looked at again, so the result does not depend on the order in a
bucket: values are within ``CHANGE`` of the solution of the upwind scheme.
"""

import math
from typing import NamedTuple

import numpy as np

from dynastar.compiled import inner, njit

BUCKETS = 1024
WIDTH = 0.2  # of a cell's side, the range of values in a bucket
CHANGE = 1e-6  # m that a value has to fall by to count
AROUND = (0, 0), (0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)
WALL_COST = 40.0  # of a metre through what cannot be driven: values there only lead out of it


class Seed(NamedTuple):
    """Where the front begins: a point ``right`` and ``up`` (m) of the centre of a cell (row, column).

    ``value`` (m) is that of the point, ``per_metre`` by how much it grows in a metre.
    """

    row: int
    column: int
    value: float
    right: float = 0.0
    up: float = 0.0
    per_metre: float = 1.0


def queue_for(cells):
    """Room for the queue of ``march``: buckets, and entries with the index of the next one."""
    return np.empty(BUCKETS, np.int64), np.empty(4 * cells, np.int64), np.empty(4 * cells, np.int64)


@inner
def sow(costs, values, seed, place, resolution, queue):
    """Write the values of the seed's cell and those round it to ``values`` and ``queue``; returns how many.

    ``place`` is the index of the seed's cell, and by how much those of two rows differ.
    """
    (first, columns), (heads, cells, behind), used = place, queue, 0
    for i, j in AROUND:
        above, beside = first + i * columns, first + j
        at = above + j
        if used == 0 or max(costs[at], costs[above], costs[beside]) < np.inf:
            away = math.hypot(i * resolution - seed.up, j * resolution - seed.right)
            more = away * (seed.per_metre if used == 0 else costs[at])
            bucket = min(int(more / (WIDTH * resolution)), BUCKETS - 1)
            values[at] = seed.value + more
            cells[used], behind[used], heads[bucket] = at, heads[bucket], used
            used += 1
    return used


@njit(cache=True)
def march(cost, resolution, seed, stop, beyond, queue):
    """The solution of |grad value| = ``cost`` from a ``Seed``, inf where not reached.

    Ends ``beyond`` metres after the value at ``stop`` (row, column) is known. The outermost cells are
    closed: their ``cost`` is set to inf. ``queue`` is made by ``queue_for``.
    """
    rows, columns = cost.shape
    cost[0], cost[rows - 1] = np.inf, np.inf
    cost[:, 0], cost[:, columns - 1] = np.inf, np.inf
    value = np.full(cost.shape, np.inf)
    costs, values = cost.reshape(-1), value.reshape(-1)
    row, column = min(max(seed.row, 1), rows - 2), min(max(seed.column, 1), columns - 2)
    stop_row, stop_column = stop
    first, target, begin = row * columns + column, stop_row * columns + stop_column, seed.value
    heads, cells, behind = queue
    heads[:] = -1
    per_metre = 1.0 / (WIDTH * resolution)
    used = sow(costs, values, seed, (first, columns), resolution, queue)
    free_head = -1  # of the entries used so far, the first that is free again
    bucket, empty, limit = 0, 0, np.inf
    while empty < BUCKETS and begin + bucket / per_metre <= limit:
        entry = heads[bucket % BUCKETS]
        if entry < 0:
            bucket += 1
            empty += 1
            continue
        empty = 0
        heads[bucket % BUCKETS], behind[entry], free_head = behind[entry], free_head, entry
        cell = cells[entry]
        here = values[np.uint64(cell)]
        if int((here - begin) * per_metre) < bucket:
            continue  # it fell into an earlier bucket since
        if cell == target:
            limit = here + beyond
        for k in range(4):
            at = cell + (1 if k == 0 else -1 if k == 1 else columns if k == 2 else -columns)
            old, step = values[np.uint64(at)], costs[np.uint64(at)] * resolution
            if old <= here or step == np.inf:
                continue
            across = min(values[np.uint64(at - 1)], values[np.uint64(at + 1)])
            along = min(values[np.uint64(at - columns)], values[np.uint64(at + columns)])
            apart = across - along
            if abs(apart) < step:
                new = 0.5 * (across + along + math.sqrt(2.0 * step * step - apart * apart))
            else:
                new = min(across, along) + step
            if new >= old - CHANGE or (free_head < 0 and used == len(cells)):
                continue
            values[np.uint64(at)] = new
            if free_head >= 0:
                entry, free_head = free_head, behind[free_head]
            else:
                entry, used = used, used + 1
            last = bucket + BUCKETS - 1
            to = min(int((new - begin) * per_metre), last) % BUCKETS
            cells[entry], behind[entry], heads[to] = at, heads[to], entry
    for cell in range(values.size):
        if values[cell] > limit:
            values[cell] = np.inf
    return value


@njit(cache=True)
def extend(value, resolution):
    """A copy of ``value`` that, where it is not known, has values that lead to where it is."""
    rows, columns = value.shape
    filled, step = value.copy(), WALL_COST * resolution
    for r in range(rows):
        for c in range(columns):
            if value[r, c] == np.inf:
                if r > 0:
                    filled[r, c] = min(filled[r, c], filled[r - 1, c] + step)
                if c > 0:
                    filled[r, c] = min(filled[r, c], filled[r, c - 1] + step)
    for r in range(rows - 1, -1, -1):
        for c in range(columns - 1, -1, -1):
            if value[r, c] == np.inf:
                if r < rows - 1:
                    filled[r, c] = min(filled[r, c], filled[r + 1, c] + step)
                if c < columns - 1:
                    filled[r, c] = min(filled[r, c], filled[r, c + 1] + step)
    return filled
