"""The shortest way of a grid: A* with the octile estimate, or Dijkstra, on bucket queues.

The estimate is consistent, so f never falls, and no step raises it by more than two diagonals: the
open list is a ring of buckets, one for each f that can be open. A bucket is a chain through
``pool`` of entries ``next entry << 32 | node``, the newest first. A bit for each bucket tells whether
it holds any, and a bit for each word of those whether it has one set, so the next bucket is found
in a few steps. Of the steps only the canonical ones are tried, so most nodes enter once.
"""

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit, trailing_zeros
from dynastar.planning.labels import (
    DIAGONAL,
    DIRECTION_SHIFT,
    G_SHIFT,
    STAMP_BITS,
    STAMP_SHIFT,
    STRAIGHT,
    Ints,
    octile,
    with_room,
)  # fmt: skip
from dynastar.planning.neighbours import CANONICAL, COLUMN_STEP, NO_DIRECTION, ROW_STEP, Bytes

BUCKETS = 4096  # 64 words of 64 bits; more than two diagonals
LAST = BUCKETS - 1
ALL, ONE = np.uint64(0xFFFFFFFFFFFFFFFF), np.uint64(1)
LOW_HALF = 0xFFFFFFFF


@njit(cache=True)
def shortest(
    near: Bytes, width: int, labels: Ints, stamp: int, start: int, goal: int,
    informed: bool, heads: npt.NDArray[np.int32], pool: Ints,
) -> tuple[bool, int, Ints]:  # fmt: skip
    """Expands from ``start`` until ``goal`` (-1: everything) is closed; the ways stay in ``labels``.

    Without being ``informed`` it searches all round (Dijkstra). ``heads``
    and ``pool`` are room to work in. Returns whether the goal was found, how many nodes were
    expanded, and ``pool``, which may have grown.
    """
    steps = ROW_STEP * width + COLUMN_STEP
    tag = stamp << STAMP_SHIFT
    goal_y, goal_x = goal // width, goal % width
    words = np.zeros(64, np.uint64)
    filled = np.uint64(0)  # a bit for each word
    heads[:] = -1
    labels[start] = tag | NO_DIRECTION << DIRECTION_SHIFT
    f = octile(start // width - goal_y, start % width - goal_x) if informed else 0
    at = f & LAST
    pool[0] = -1 << 32 | start
    heads[at] = 0
    words[at >> 6] |= ONE << np.uint64(at & 63)
    filled |= ONE << np.uint64(at >> 6)
    unused, used, left, expanded = np.int64(-1), np.int64(1), 1, 0
    per_width = 1.0 / width
    while left > 0:
        entry = np.int64(heads[at])
        if entry < 0:
            i = at >> 6
            word = words[i] & (ALL << np.uint64(at & 63))
            if word == 0:
                later = filled & ((ALL << np.uint64(i)) << ONE)
                i = trailing_zeros(later if later != 0 else filled)
                word = words[i]
            at = (i << 6) + trailing_zeros(word)
            entry = np.int64(heads[at])
        node, following = pool[entry] & LOW_HALF, pool[entry] >> 32
        heads[at] = following
        if following < 0:
            words[at >> 6] ^= ONE << np.uint64(at & 63)
            if words[at >> 6] == 0:
                filled ^= ONE << np.uint64(at >> 6)
        pool[entry], unused = unused, entry
        left -= 1
        label = labels[node]
        if label & 1:
            continue
        labels[node] = label | 1
        expanded += 1
        if node == goal:
            return True, expanded, pool
        if used + 8 > pool.size:
            pool = with_room(pool, used + 8)
        g = label >> G_SHIFT
        y = np.int64((node + 0.5) * per_width)
        x = node - y * width
        untried = np.uint64(CANONICAL[((label >> DIRECTION_SHIFT) & 15) << 8 | near[node]])
        while untried != 0:
            d = trailing_zeros(untried)
            untried &= untried - ONE
            neighbour = node + steps[d]
            g_new = g + (DIAGONAL if d & 1 else STRAIGHT)
            there = labels[neighbour]
            if (there & STAMP_BITS) == tag and ((there & 1) or (there >> G_SHIFT) <= g_new):
                continue
            labels[neighbour] = g_new << G_SHIFT | tag | d << DIRECTION_SHIFT
            f = g_new
            if informed:
                f += octile(y + ROW_STEP[d] - goal_y, x + COLUMN_STEP[d] - goal_x)
            bucket = f & LAST
            if unused >= 0:
                entry, unused = unused, pool[unused]
            else:
                entry, used = used, used + 1
            pool[entry] = np.int64(heads[bucket]) << 32 | neighbour
            heads[bucket] = entry
            words[bucket >> 6] |= ONE << np.uint64(bucket & 63)
            filled |= ONE << np.uint64(bucket >> 6)
            left += 1
    return False, expanded, pool
