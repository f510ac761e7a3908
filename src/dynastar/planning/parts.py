"""The connected parts of a grid, by runs of free cells along its rows.

A large map has few runs for its cells: which ways an obstacle cut off is found several times faster
than by labelling each cell.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.planning.labels import with_room
from dynastar.planning.neighbours import Bytes

Nodes = npt.NDArray[np.int32]

NONE = np.uint64(0)
LOW_BITS, HIGH_BITS = np.uint64(0x0101010101010101), np.uint64(0x8080808080808080)  # of eight bytes


class Parts(NamedTuple):
    """Runs of free nodes, in order: run i has those from ``begin[i]`` to ``end[i] - 1``.

    ``number[i]`` is that of its connected part, from 1 on. Legal steps connect two cells exactly if
    they are 4-connected, for a diagonal step needs both cells beside it free. A row of the grid is
    ``width`` nodes long, with a blocked one at either end.
    """

    begin: Nodes
    end: Nodes
    number: Nodes
    width: int

    def at(self, rows: npt.NDArray[np.integer], columns: npt.NDArray[np.integer]) -> Nodes:
        """Numbers of the parts that cells are in, 0 where one is blocked; the arrays are broadcast."""
        nodes = (rows + 1) * self.width + columns + 1
        after = np.searchsorted(self.begin, nodes, "right")  # of the run that a free node is in
        end, number = np.append(np.int32(0), self.end), np.append(np.int32(0), self.number)
        return np.where(nodes < end[after], number[after], np.int32(0))


@njit(cache=True)
def find_turns(near: Bytes) -> Nodes:
    """The nodes at which free nodes begin and end, by turns; ``near`` (n,) is not 0 where one is free.

    Eight nodes that are alike are passed at once. The first and the last node are blocked.
    """
    turns, count, inside = np.empty(1024, np.int32), 0, False
    words = near[: near.size // 8 * 8].view(np.uint64)
    for i in range(words.size + 1):
        if i < words.size:
            word = words[i]
            if (word - LOW_BITS & ~word & HIGH_BITS if inside else word) == NONE:
                continue
        turns = with_room(turns, count + 8)
        for node in range(8 * i, min(8 * i + 8, near.size)):
            if (near[node] != 0) != inside:
                turns[count] = node
                count, inside = count + 1, not inside
    return turns[:count]


@njit(cache=True, inline="always")
def first_of(above: Nodes, i: int) -> int:
    """The first run that is known to be in the same part as run ``i``."""
    while above[i] != i:
        above[i] = above[above[i]]
        i = above[i]
    return i


@njit(cache=True)
def number_parts(begin: Nodes, end: Nodes, width: int) -> Nodes:
    """The number of the part that each run is in; rows are ``width`` nodes long."""
    above = np.empty(begin.size, np.int32)
    other = 0
    for i in range(begin.size):
        above[i] = i
        while end[other] + width <= begin[i]:
            other += 1
        at = other
        while begin[at] + width < end[i]:
            a, b = first_of(above, at), first_of(above, i)
            above[max(a, b)] = min(a, b)
            at += 1
    count = 0
    for i in range(begin.size):
        if above[i] == i:
            count += 1
            above[i] = -count
        else:
            above[i] = above[above[i]]
    return -above


def find_parts(near: Bytes) -> Parts:
    """The connected parts of a grid; ``near`` [rows + 2, columns + 2] is not 0 where a node is free."""
    turns, width = find_turns(near.reshape(-1)), near.shape[1]
    begin, end = turns[::2].copy(), turns[1::2].copy()
    return Parts(begin, end, number_parts(begin, end, width), width)
