"""What a search knows about a node, in one int64, and how a way is read from it.

    g (38 bits) | stamp of the search (20) | direction it was reached in (4) | closed (1)

A label with another stamp is ignored, so no search has to clear the labels of the last. Lengths
are whole numbers with 1393 / 985 for sqrt(2), 2.6e-7 off, so that equal ways tie exactly. A cost
that is returned is computed again from the steps.
"""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import allocating, njit
from dynastar.planning.neighbours import COLUMN_STEP, NO_DIRECTION, ROW_STEP

Ints = npt.NDArray[np.int64]
# Plain tuples: from Python, numba takes a microsecond less for one than for a NamedTuple.
Labels = tuple[Ints, int]  # what is known about all nodes, and the stamp of the search
Heap = tuple[Ints, npt.NDArray[np.int32]]  # its keys, and the node of each serial number

STRAIGHT, DIAGONAL = 985, 1393
MAX_NODES = 1 << 29

G_SHIFT, STAMP_SHIFT, DIRECTION_SHIFT = 25, 5, 1
MAX_STAMP = (1 << (G_SHIFT - STAMP_SHIFT)) - 1
STAMP_BITS = MAX_STAMP << STAMP_SHIFT


@njit(cache=True, inline="always")
def octile(rows: int, columns: int) -> int:
    """Length of the way over a free 8-connected grid, ``rows`` and ``columns`` away."""
    rows, columns = abs(rows), abs(columns)
    return STRAIGHT * max(rows, columns) + (DIAGONAL - STRAIGHT) * min(rows, columns)


@allocating
def with_room(array: Ints, needed: int) -> Ints:
    """Return ``array``, grown by 50 % (or to ``needed``) if its size is less than ``needed``."""
    if needed <= array.size:
        return array
    larger = np.empty(max(needed, array.size + array.size // 2), array.dtype)
    for i in range(array.size):  # compiles in a fraction of the time that a slice takes
        larger[i] = array[i]
    return larger


@njit(cache=True, inline="always")
def is_closed(label: int, stamp: int) -> bool:
    """Whether a label says that the search of that stamp closed its node."""
    return (int(label) & (STAMP_BITS | 1)) == stamp << STAMP_SHIFT | 1


@njit(cache=True)
def closed_nodes(searched: Labels) -> npt.NDArray[np.int32]:
    """The nodes (m,) that a search closed, in order."""
    labels, stamp = searched
    count = 0
    for node in range(labels.size):
        count += is_closed(labels[node], stamp)
    found, count = np.empty(count, np.int32), 0
    for node in range(labels.size):
        if is_closed(labels[node], stamp):
            found[count] = node
            count += 1
    return found


@njit(cache=True)
def trace(searched: Labels, width: int, goal: int) -> tuple[npt.NDArray[np.int32], float]:
    """The way (n, 2) that a search found to ``goal``, in unpadded (row, column), and its length.

    A node may have been reached by a jump over several others. The way runs back from it to the
    first labelled node whose length from the start is shorter by exactly the distance between them.
    """
    labels, stamp = searched
    steps = ROW_STEP * width + COLUMN_STEP
    tag = stamp << STAMP_SHIFT
    way = np.empty(256, np.int32)
    count, diagonals, node = 0, 0, goal
    while True:
        d = (labels[node] >> DIRECTION_SHIFT) & 15
        if d == NO_DIRECTION:
            break
        g, cost = labels[node] >> G_SHIFT, DIAGONAL if d & 1 else STRAIGHT
        while True:
            if count + 2 > way.size:
                way = with_room(way, count + 2)
            way[count] = node
            count, diagonals = count + 1, diagonals + (d & 1)
            node -= steps[d]
            g -= cost
            if (labels[node] & STAMP_BITS) == tag and (labels[node] >> G_SHIFT) == g:
                break
    way[count] = node
    cells = np.empty((count + 1, 2), np.int32)
    for i in range(count + 1):
        node = way[count - i]
        y = node // width
        cells[i, 0], cells[i, 1] = y - 1, node - y * width - 1
    return cells, count - diagonals + diagonals * math.sqrt(2.0)
