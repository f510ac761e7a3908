"""Jump-point search: A* that jumps along straight lines to where a shortest way may turn.

[Harabor and Grastien, 2011 and 2014], without corner cutting and without tables to prepare: the
blocked cells of every row and of every column are kept as bits, so that a jump looks at 64 cells at
a time. A line's bits are those of its neighbours behind a corner, seen in the direction of travel.
"""

from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, leading_zeros, njit, trailing_zeros
from dynastar.planning.bucket_kernel import ALL, ONE
from dynastar.planning.heap_kernel import F_SHIFT, SERIAL_BITS, pop, push
from dynastar.planning.labels import (
    DIAGONAL,
    DIRECTION_SHIFT,
    G_SHIFT,
    STAMP_BITS,
    STAMP_SHIFT,
    STRAIGHT,
    Heap,
    Labels,
    octile,
    with_room,
)  # fmt: skip
from dynastar.planning.neighbours import (
    CANONICAL,
    COLUMN_STEP,
    LEGAL,
    NO_DIRECTION,
    ROW_STEP,
    Bytes,
    Padded,
)

Words = npt.NDArray[np.uint64]
Lines = tuple[Words, Words]  # the bits of all rows, and those of all columns

TOP = np.uint64(63)


def pack(
    near: Bytes, lines: Words, top: int, left: int, bottom: int, right: int, upright: bool = False
) -> None:
    """Set the bits of ``lines`` [y, words] in a window where cells of ``near`` [y, x] are blocked.

    If ``upright``, the lines are columns, and ``near`` is [x, y]. Beyond the last column everything
    is blocked. The window ends before ``bottom``, ``right``.
    """
    first, last = left >> 6, ((right - 1) >> 6) + 1
    if upright:
        part = cv2.transpose(
            near[64 * first : 64 * last, top:bottom]
        )  # NumPy's copy takes ten times
    else:
        part = near[top:bottom, 64 * first : 64 * last]
    blocked = np.ones((bottom - top, 64 * (last - first)), np.bool_)
    np.equal(part, 0, out=blocked[:, : part.shape[1]])
    bits = np.packbits(blocked, axis=1, bitorder="little")
    lines[top:bottom, first:last] = bits.view("<u8")


@njit(cache=True, inline="always")
def jump_up(lines: Words, line: int, at: int, goal: int) -> int:
    """Where a jump from ``at`` towards larger numbers stops on a line, or -1 at a wall.

    The jump stops at ``goal`` (-1: not on this line), and where a cell beside the line is free after a
    blocked one.
    """
    i = at >> 6
    beside, other, here = lines[line - 1, i], lines[line + 1, i], lines[line, i]
    carry = other_carry = np.uint64(0)
    if i > 0:
        carry, other_carry = lines[line - 1, i - 1] >> TOP, lines[line + 1, i - 1] >> TOP
    ahead = (ALL << np.uint64(at & 63)) << ONE
    while True:
        corners = ((beside << ONE | carry) & ~beside) | ((other << ONE | other_carry) & ~other)
        stops = (corners | here) & ahead
        if stops != 0:
            bit = trailing_zeros(stops)
            found = (i << 6) + bit
            wall = (here >> np.uint64(bit)) & ONE
            if at < goal <= found and (goal < found or not wall):
                return goal
            return -1 if wall else found
        carry, other_carry, ahead = beside >> TOP, other >> TOP, ALL
        i += 1
        beside, other, here = lines[line - 1, i], lines[line + 1, i], lines[line, i]


@njit(cache=True, inline="always")
def jump_down(lines: Words, line: int, at: int, goal: int) -> int:
    """``jump_up`` towards smaller numbers."""
    i = at >> 6
    last = lines.shape[1] - 1
    beside, other, here = lines[line - 1, i], lines[line + 1, i], lines[line, i]
    carry = other_carry = np.uint64(0)
    if i < last:
        carry, other_carry = lines[line - 1, i + 1] << TOP, lines[line + 1, i + 1] << TOP
    ahead = (ONE << np.uint64(at & 63)) - ONE
    while True:
        corners = ((beside >> ONE | carry) & ~beside) | ((other >> ONE | other_carry) & ~other)
        stops = (corners | here) & ahead
        if stops != 0:
            bit = 63 - leading_zeros(stops)
            found = (i << 6) + bit
            wall = (here >> np.uint64(bit)) & ONE
            if found <= goal < at and (goal > found or not wall):
                return goal
            return -1 if wall else found
        carry, other_carry, ahead = beside << TOP, other << TOP, ALL
        i -= 1
        beside, other, here = lines[line - 1, i], lines[line + 1, i], lines[line, i]


@njit(cache=True, inline="always")
def straight_jump(
    rows: Words, columns: Words, y: int, x: int, d: int, goal_y: int, goal_x: int
) -> int:
    """Number of cells of the jump from (y, x) in a straight direction, 0 if it ends at a wall."""
    if d == 2:
        end = jump_up(rows, y, x, goal_x if y == goal_y else -1)
        return end - x if end >= 0 else 0
    if d == 6:
        end = jump_down(rows, y, x, goal_x if y == goal_y else -1)
        return x - end if end >= 0 else 0
    if d == 0:
        end = jump_up(columns, x, y, goal_y if x == goal_x else -1)
        return end - y if end >= 0 else 0
    end = jump_down(columns, x, y, goal_y if x == goal_x else -1)
    return y - end if end >= 0 else 0


@njit(cache=True, inline="always")
def shorter(label: int, tag: int, g: int, d: int) -> int:
    """Label of a node also reached in direction ``d`` over a length ``g``: the shorter counts."""
    if (label & STAMP_BITS) != tag or (label >> G_SHIFT) > g:
        return g << G_SHIFT | tag | d << DIRECTION_SHIFT
    return label


class Used(NamedTuple):
    """How many keys the heap holds, and the next serial number."""

    size: int
    serial: int


@inner
def enter(written: Labels, work: Heap, used: Used, node: int, g: int, d: int, h: int) -> Used:
    """Label a node and put it into the open list, if the way is shorter than what is known."""
    (labels, stamp), (heap, nodes) = written, work
    there, tag = labels[node], stamp << STAMP_SHIFT
    if (there & STAMP_BITS) == tag and ((there & 1) or (there >> G_SHIFT) <= g):
        return used
    labels[node] = g << G_SHIFT | tag | d << DIRECTION_SHIFT
    nodes[used.serial] = node
    push(heap, used.size, (g + h) << F_SHIFT | (SERIAL_BITS - used.serial))
    return Used(used.size + 1, used.serial + 1)


@njit(cache=True)
def jump_search(
    grid: Padded, lines: Lines, written: Labels, start: int, goal: int, work: Heap
) -> tuple[bool, int, Heap]:
    """Expand jump points from ``start`` until ``goal`` is closed. Writes ``written``.

    No way turns round a corner on a diagonal: it is followed to its end, and the jumps to either
    side of it are entered. The cell where such a jump begins is labelled, but not entered. Returns
    what ``heap_kernel.search`` does.
    """
    (near, width), (rows, columns) = grid, lines
    (labels, stamp), (heap, nodes) = written, work
    steps = ROW_STEP * width + COLUMN_STEP
    tag = stamp << STAMP_SHIFT
    goal_y, goal_x = goal // width, goal % width
    most = 8 * max(len(rows), len(columns))  # that one node can enter
    labels[start] = tag | NO_DIRECTION << DIRECTION_SHIFT
    nodes[0] = start
    heap[0] = SERIAL_BITS
    used, expanded = Used(1, 1), 0
    while used.size > 0:
        node = np.int64(nodes[SERIAL_BITS - (pop(heap, used.size) & SERIAL_BITS)])
        used = Used(used.size - 1, used.serial)
        label = labels[node]
        if label & 1:
            continue
        labels[node] = label | 1
        expanded += 1
        if node == goal:
            return True, expanded, (heap, nodes)
        if used.size + most > heap.size or used.serial + most > nodes.size:
            heap = with_room(heap, used.size + most)
            nodes = with_room(nodes, used.serial + most)
        g = label >> G_SHIFT
        y, x = node // width, node % width
        untried = np.uint64(CANONICAL[((label >> DIRECTION_SHIFT) & 15) << 8 | near[node]])
        while untried != 0:
            d = trailing_zeros(untried)
            untried &= untried - ONE
            diagonal = d & 1
            at, at_y, at_x, at_g = node, y, x, g
            while not diagonal or (LEGAL[near[at]] >> d) & 1:
                if diagonal:
                    at, at_y, at_x = at + steps[d], at_y + ROW_STEP[d], at_x + COLUMN_STEP[d]
                    at_g += DIAGONAL
                    if at == goal:
                        used = enter(written, (heap, nodes), used, at, at_g, d, 0)
                        break
                for turn in range(diagonal + 1):  # the two sides of a diagonal, or straight on
                    side = (d + diagonal - 2 * turn) & 7
                    cells = straight_jump(rows, columns, at_y, at_x, side, goal_y, goal_x)
                    if cells > 0:
                        labels[at] = shorter(labels[at], tag, at_g, d)
                        end_y = at_y + cells * ROW_STEP[side]
                        end_x = at_x + cells * COLUMN_STEP[side]
                        end, end_g = at + cells * steps[side], at_g + cells * STRAIGHT
                        h = octile(end_y - goal_y, end_x - goal_x)
                        used = enter(written, (heap, nodes), used, end, end_g, side, h)
                if not diagonal:
                    break
    return False, expanded, (heap, nodes)
