"""The search of Eq. 3, with any of its terms, on a binary heap.

An entry of the heap is f (34 bits) | 2^29 - serial number (29): of equal f the newest comes first.
A node whose way got shorter is entered again; its older entries are skipped, as it is closed then.
"""

import math
from typing import NamedTuple

import numpy as np

from dynastar.compiled import njit, trailing_zeros
from dynastar.planning.labels import (
    DIAGONAL,
    DIRECTION_SHIFT,
    G_SHIFT,
    STAMP_BITS,
    STAMP_SHIFT,
    STRAIGHT,
    Heap,
    Ints,
    Labels,
    octile,
    with_room,
)  # fmt: skip
from dynastar.planning.neighbours import COLUMN_STEP, LEGAL, NO_DIRECTION, ROW_STEP, Padded

F_SHIFT = 29
SERIAL_BITS = (1 << F_SHIFT) - 1
MAX_F = (1 << 34) - 1

EXP_STEPS = 256
EXP = np.exp(np.arange(EXP_STEPS + 1) / EXP_STEPS)


class Terms(NamedTuple):
    """Terms of Eq. 3 in the kernel's units; not ``adaptive``: only h(n) and the weight count.

    ``around`` > 0 takes P from the square of that half width round n, else from the rectangle
    n - goal. ``k`` is negative if beta is the interior angle at n.
    """

    weight: float
    euclidean: bool
    adaptive: bool
    exponential: bool
    q: float
    around: int
    parent: bool
    k: float


@njit(cache=True, inline="always")
def estimate(rows: int, columns: int, euclidean: bool) -> int:
    """h: length of the way over a free 8-connected grid, or of the straight line."""
    if euclidean:
        return int(STRAIGHT * math.sqrt(rows * rows + columns * columns))
    return octile(rows, columns)


@njit(cache=True, inline="always")
def occupied_in(sums: Ints, y: int, x: int, other_y: int, other_x: int) -> int:
    """Occupied cells in the rectangle that two cells (padded coordinates) span."""
    top, bottom = min(y, other_y) - 1, max(y, other_y)
    left, right = min(x, other_x) - 1, max(x, other_x)
    return sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]


@njit(cache=True, inline="always")
def exponential(ratio: float) -> float:
    """e^ratio for a ratio from 0 to 1, by a table and four terms; the last digit may be off."""
    i = int(ratio * EXP_STEPS)
    rest = ratio - i / EXP_STEPS
    series = 1.0 + rest * (1.0 + rest * (0.5 + rest * (1.0 / 6.0 + rest * (1.0 / 24.0))))
    return EXP[i] * series


@njit(cache=True, inline="always")
def h_adaptive(
    terms: Terms, sums: Ints, n: tuple[int, int], h_parent: float,
    start: tuple[int, int], goal: tuple[int, int],
) -> float:  # fmt: skip
    """h_A(n) of Eq. 2, at least 0; cells are (y, x), padded, and ``h_parent`` is h(p)."""
    y, x = n
    to_goal_y, to_goal_x = goal[0] - y, goal[1] - x
    value = float(estimate(to_goal_y, to_goal_x, terms.euclidean)) + h_parent
    if terms.k != 0.0:
        from_start_y, from_start_x = y - start[0], x - start[1]
        norms = float(from_start_y * from_start_y + from_start_x * from_start_x) * float(
            to_goal_y * to_goal_y + to_goal_x * to_goal_x
        )
        if norms > 0.0:
            dot = from_start_y * to_goal_y + from_start_x * to_goal_x
            value -= terms.k * dot / math.sqrt(norms)
        else:
            value -= abs(terms.k)
    if terms.exponential:
        if terms.around > 0:
            a, rows, columns = terms.around, sums.shape[0] - 1, sums.shape[1] - 1
            p = occupied_in(
                sums, max(y - a, 1), max(x - a, 1), min(y + a, rows), min(x + a, columns)
            )
        else:
            p = occupied_in(sums, y, x, goal[0], goal[1])
        value *= exponential(min(p / terms.q, 1.0))
    return max(value, 0.0)


@njit(cache=True, inline="always")
def push(heap: Ints, size: int, key: int) -> None:
    """Add ``key`` to a binary heap of ``size`` keys."""
    i = size
    while i > 0:
        above = (i - 1) >> 1
        if heap[above] < key:
            break
        heap[i] = heap[above]
        i = above
    heap[i] = key


@njit(cache=True, inline="always")
def pop(heap: Ints, size: int) -> int:
    """Take the smallest key from a binary heap of ``size`` keys."""
    smallest, last = heap[0], heap[size - 1]
    hole, below = 0, 1
    while below < size - 1:
        below += heap[below + 1] < heap[below]
        heap[hole] = heap[below]
        hole, below = below, 2 * below + 1
    push(heap, hole, last)
    return smallest


@njit(cache=True)
def search(
    grid: Padded, sums: Ints, written: Labels, start: int, goal: int, terms: Terms, work: Heap
) -> tuple[bool, int, Heap]:
    """Expand from ``start`` until ``goal`` (-1: all nodes) is closed. Writes ``written``.

    Returns whether the goal was found, how many nodes were expanded, and the work arrays, which may
    have grown.
    """
    (near, width), (labels, stamp), (heap, nodes) = grid, written, work
    steps = ROW_STEP * width + COLUMN_STEP
    tag = stamp << STAMP_SHIFT
    start_cell = (start // width, start % width)
    goal_cell = (goal // width, goal % width)
    labels[start] = tag | NO_DIRECTION << DIRECTION_SHIFT
    nodes[0] = start
    heap[0] = SERIAL_BITS
    size, serial, expanded = 1, 1, 0
    while size > 0:
        node = np.int64(nodes[SERIAL_BITS - (pop(heap, size) & SERIAL_BITS)])
        size -= 1
        label = labels[node]
        if label & 1:
            continue
        labels[node] = label | 1
        expanded += 1
        if node == goal:
            return True, expanded, (heap, nodes)
        if size + 8 > heap.size or serial + 8 > nodes.size:
            heap, nodes = with_room(heap, size + 8), with_room(nodes, serial + 8)
        g = label >> G_SHIFT
        y = node // width
        x = node - y * width
        h_parent = 0.0
        if terms.parent:
            h_parent = float(estimate(goal_cell[0] - y, goal_cell[1] - x, terms.euclidean))
        untried = np.uint64(LEGAL[near[node]])
        while untried != 0:
            d = trailing_zeros(untried)
            untried &= untried - np.uint64(1)
            neighbour = node + steps[d]
            g_new = g + (DIAGONAL if d & 1 else STRAIGHT)
            there = labels[neighbour]
            if (there & STAMP_BITS) == tag and ((there & 1) or (there >> G_SHIFT) <= g_new):
                continue
            labels[neighbour] = g_new << G_SHIFT | tag | d << DIRECTION_SHIFT
            n = (y + ROW_STEP[d], x + COLUMN_STEP[d])
            if terms.adaptive:
                h = h_adaptive(terms, sums, n, h_parent, start_cell, goal_cell)
            else:
                h = float(estimate(goal_cell[0] - n[0], goal_cell[1] - n[1], terms.euclidean))
            f = min(g_new + np.int64(terms.weight * h), MAX_F)
            nodes[serial] = neighbour
            push(heap, size, f << F_SHIFT | (SERIAL_BITS - serial))
            size += 1
            serial += 1
    return False, expanded, (heap, nodes)
