"""The shortest way of a grid: A* with the octile estimate, or Dijkstra, on bucket queues.

The estimate is consistent, so f never falls, and no step raises it by more than two diagonals: the
open list is a ring of buckets, one for each f that can be open. A bucket is a chain through
``pool`` of entries ``next entry << 32 | node``, the newest first; ``heads`` has the first, or -1.
``words`` has a bit for each bucket, set if it holds an entry, and ``filled`` a bit for each word,
set if the word is not 0, so the next bucket is found in a few steps. Only canonical steps are
tried, so most nodes enter once.
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
    Labels,
    octile,
    with_room,
)  # fmt: skip
from dynastar.planning.neighbours import CANONICAL, COLUMN_STEP, NO_DIRECTION, ROW_STEP, Padded

Heads = npt.NDArray[np.int32]
Words = npt.NDArray[np.uint64]
Word = np.uint64

BUCKETS = 4096  # 64 words of 64 bits; more than two diagonals
LAST = BUCKETS - 1
ALL, ONE = np.uint64(0xFFFFFFFFFFFFFFFF), np.uint64(1)
LOW_HALF = 0xFFFFFFFF


@njit(cache=True, inline="always")
def vacant(pool: Ints, unused: int, used: int) -> tuple[int, int, int]:
    """An entry to write to, and ``unused`` and ``used`` without that entry.

    ``unused`` is the first of a chain of entries that were taken out, or -1. The entries of
    ``pool`` from ``used`` on have never been written to.
    """
    if unused >= 0:
        return unused, pool[unused], used
    return used, unused, used + 1


@njit(cache=True, inline="always")
def put(
    heads: Heads, words: Words, pool: Ints, filled: Word, entry: int, f: int, node: int
) -> Word:
    """Write a node to an entry and put it first in the bucket of ``f``. Returns ``filled``."""
    bucket = f & LAST
    pool[entry] = np.int64(heads[bucket]) << 32 | node
    heads[bucket] = entry
    words[bucket >> 6] |= ONE << np.uint64(bucket & 63)
    return filled | ONE << np.uint64(bucket >> 6)


@njit(cache=True, inline="always")
def take(
    heads: Heads, words: Words, pool: Ints, filled: Word, bucket: int
) -> tuple[np.int64, int, Word]:
    """Take the first entry out of a bucket. Returns the entry, its node and ``filled``."""
    entry = np.int64(heads[bucket])
    node, following = pool[entry] & LOW_HALF, pool[entry] >> 32
    heads[bucket] = following
    word = words[bucket >> 6] ^ np.uint64(following < 0) << np.uint64(bucket & 63)
    words[bucket >> 6] = word
    return entry, node, filled ^ np.uint64(word == 0) << np.uint64(bucket >> 6)


@njit(cache=True, inline="always")
def next_word(filled: Word, i: int) -> int:
    """Index of the first word after ``i`` that has a bit set, or of the first of all."""
    later = filled & ((ALL << np.uint64(i)) << ONE)
    return trailing_zeros(later if later != 0 else filled)


@njit(cache=True)
def shortest(
    grid: Padded, written: Labels, start: int, goal: int, informed: bool, pool: Ints
) -> tuple[bool, int, Ints]:
    """Expand from ``start`` until ``goal`` (-1: all nodes) is closed. Writes ``written``.

    If not ``informed`` it searches all round (Dijkstra). Returns whether the goal was found, how many
    nodes were expanded, and ``pool``, a work array, which may have grown.
    """
    (near, width), (labels, stamp) = grid, written
    steps = ROW_STEP * width + COLUMN_STEP
    tag = stamp << STAMP_SHIFT
    goal_y, goal_x = goal // width, goal % width
    heads = np.full(BUCKETS, -1, np.int32)
    words = np.zeros(64, np.uint64)
    labels[start] = tag | NO_DIRECTION << DIRECTION_SHIFT
    f = octile(start // width - goal_y, start % width - goal_x) if informed else 0
    filled = put(heads, words, pool, np.uint64(0), 0, f, start)
    at, unused, used, left, expanded = f & LAST, np.int64(-1), np.int64(1), 1, 0
    per_width = 1.0 / width
    while left > 0:
        if heads[at] < 0:
            i, word = at >> 6, words[at >> 6] & (ALL << np.uint64(at & 63))
            if word == 0:
                i = next_word(filled, i)
                word = words[i]
            at = (i << 6) + trailing_zeros(word)
        entry, node, filled = take(heads, words, pool, filled, at)
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
            entry, unused, used = vacant(pool, unused, used)
            filled = put(heads, words, pool, filled, entry, f, neighbour)
            left += 1
    return False, expanded, pool
