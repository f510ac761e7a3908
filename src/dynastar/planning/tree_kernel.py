"""A shortest way found again after cells closed, from the last search from the goal.

A closed node of that search (the tree) whose way to the root is not cut has the exact length to the
goal. A closed node whose way was cut has a lower bound of it. From a node m that is not closed the
length is at least max(octile(m, goal), length - octile(m, tree_start)), where length is that of the
tree's way (triangle inequality). These bounds are consistent because cells only close, and so tight
that few nodes round the change are expanded.
"""

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit, trailing_zeros
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
    Padded,
)

Window = tuple[int, int, int, int]  # top, left, bottom, right; padded, without the last two

CUT = 15  # in place of the direction of a node whose way to the root was cut
FAR = 1 << 62


def is_valid(label: int, stamp: int) -> bool:
    """Whether a label is that of a closed node of a tree, whose way to the root was not cut."""
    closed = (int(label) & (STAMP_BITS | 1)) == stamp << STAMP_SHIFT | 1
    return closed and (int(label) >> DIRECTION_SHIFT) & 15 != CUT


@njit(cache=True)
def prune(
    grid: Padded, known: Labels, window: Window, stack: npt.NDArray[np.int32]
) -> npt.NDArray[np.int32]:
    """Mark the nodes of a tree whose way to the root contains a step that is no longer legal.

    ``near`` has changed in a window. Returns ``stack``, a work array, which may have grown.
    """
    (near, width), (tree, stamp) = grid, known
    top, left, bottom, right = window
    steps = ROW_STEP * width + COLUMN_STEP
    closed = stamp << STAMP_SHIFT | 1
    size = 0
    for y in range(top, bottom):
        for x in range(left, right):
            node = y * width + x
            d = (tree[node] >> DIRECTION_SHIFT) & 15
            if (tree[node] & (STAMP_BITS | 1)) != closed or d >= NO_DIRECTION:
                continue
            if near[node] == 0 or not (LEGAL[near[node - steps[d]]] >> d) & 1:
                tree[node] |= CUT << DIRECTION_SHIFT
                stack = with_room(stack, size + 1)
                stack[size] = node
                size += 1
    while size > 0:
        size -= 1
        parent = np.int64(stack[size])
        for d in range(8):
            child = parent + steps[d]
            label = tree[child]
            if (label & (STAMP_BITS | 1)) == closed and (label >> DIRECTION_SHIFT) & 15 == d:
                tree[child] |= CUT << DIRECTION_SHIFT
                stack = with_room(stack, size + 1)
                stack[size] = child
                size += 1
    return stack


@njit(cache=True)
def search_again(
    grid: Padded, known: Labels, tree_start: int, goal: int, written: Labels, start: int, work: Heap
) -> tuple[int, int, int, Heap]:
    """Expand from ``start`` until the way to ``goal`` is known. Writes ``written``.

    ``known`` is the tree: what the search from ``goal`` wrote that reached ``tree_start``. Returns the
    last node of the new way and the node of the tree that it steps to (-1 if there is no way), how
    many nodes were expanded, and the work arrays, which may have grown.
    """
    (near, width), (tree, tree_stamp) = grid, known
    (labels, stamp), (heap, nodes) = written, work
    steps = ROW_STEP * width + COLUMN_STEP
    tag, closed = stamp << STAMP_SHIFT, tree_stamp << STAMP_SHIFT | 1
    goal_y, goal_x = goal // width, goal % width
    from_y, from_x = tree_start // width, tree_start % width
    length = tree[tree_start] >> G_SHIFT
    best, last, meeting = FAR, -1, -1
    labels[start] = tag | NO_DIRECTION << DIRECTION_SHIFT
    nodes[0] = start
    heap[0] = SERIAL_BITS
    size, serial, expanded = 1, 1, 0
    while size > 0:
        key = pop(heap, size)
        size -= 1
        if key >> F_SHIFT >= best:
            break
        node = np.int64(nodes[SERIAL_BITS - (key & SERIAL_BITS)])
        label = labels[node]
        if label & 1:
            continue
        labels[node] = label | 1
        expanded += 1
        heap, nodes = with_room(heap, size + 8), with_room(nodes, serial + 8)
        g = label >> G_SHIFT
        y, x = node // width, node % width
        untried = np.uint64(CANONICAL[((label >> DIRECTION_SHIFT) & 15) << 8 | near[node]])
        while untried != 0:
            d = trailing_zeros(untried)
            untried &= untried - np.uint64(1)
            neighbour = node + steps[d]
            g_new = g + (DIAGONAL if d & 1 else STRAIGHT)
            there = labels[neighbour]
            if (there & STAMP_BITS) == tag and ((there & 1) or (there >> G_SHIFT) <= g_new):
                continue
            in_tree = (tree[neighbour] & (STAMP_BITS | 1)) == closed
            h = tree[neighbour] >> G_SHIFT
            if in_tree and (tree[neighbour] >> DIRECTION_SHIFT) & 15 != CUT:
                if g_new + h < best:
                    best, last, meeting = g_new + h, int(node), neighbour
                continue
            if not in_tree:
                ny, nx = y + ROW_STEP[d], x + COLUMN_STEP[d]
                h = max(octile(ny - goal_y, nx - goal_x), length - octile(ny - from_y, nx - from_x))
            labels[neighbour] = g_new << G_SHIFT | tag | d << DIRECTION_SHIFT
            nodes[serial] = neighbour
            push(heap, size, (g_new + h) << F_SHIFT | (SERIAL_BITS - serial))
            size += 1
            serial += 1
    return last, meeting, expanded, (heap, nodes)
