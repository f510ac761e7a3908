"""The free neighbours of each cell of a grid, and the steps from it that a search has to try.

The grid is padded by one blocked cell all round and flattened; a node is an index into it. A cell's
byte ``near`` has bit d set where its neighbour in direction d is free. 0 means that the cell itself
is blocked. A free cell without a free neighbour has the bit of a diagonal, which is not a legal
step: a diagonal step needs both cells beside it free (no corner is cut).
"""

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit

Bytes = npt.NDArray[np.uint8]
Padded = tuple[Bytes, int]  # ``near`` of all nodes, and the number of nodes in a row

# Directions 0 to 7 go round; the odd ones are diagonal.
ROW_STEP = np.array([1, 1, 0, -1, -1, -1, 0, 1])
COLUMN_STEP = np.array([0, 1, 1, 1, 0, -1, -1, -1])
NO_DIRECTION = 8  # how a start was reached


def legal_steps(near: int) -> int:
    """Bits of the directions that can be taken from a cell."""
    steps = 0
    for d in range(8):
        beside = near >> (d + 1) % 8 & near >> (d - 1) % 8 & 1
        if near >> d & 1 and (d % 2 == 0 or beside):
            steps |= 1 << d
    return steps


def canonical_steps(reached: int, near: int) -> int:
    """Bits of the legal steps that a shortest way may take from a cell reached in a direction.

    Of several ways of the same length only the one that goes diagonally first is followed. So a
    diagonal step is followed by the same or by either of its straight directions; a straight step
    by the same, or by a turn round a corner that it has just passed (the jump points of Harabor and
    Grastien, without corner cutting).
    """
    if reached == NO_DIRECTION:
        kept = 0xFF
    elif reached % 2:
        kept = 1 << reached | 1 << (reached + 1) % 8 | 1 << (reached - 1) % 8
    else:
        kept = 1 << reached
        for side in (1, -1):
            behind, beside = (reached + 3 * side) % 8, (reached + 2 * side) % 8
            if near >> beside & 1 and not near >> behind & 1:
                kept |= 1 << beside | 1 << (reached + side) % 8
    return legal_steps(near) & kept


LEGAL = np.array([legal_steps(near) for near in range(256)], np.uint8)
CANONICAL = np.array([canonical_steps(d, near) for d in range(9) for near in range(256)], np.uint8)


def corner_turns(near: int) -> int:
    """Number of forced diagonal neighbours, summed over the four straight arrival directions.

    Forced neighbours are those of jump-point search (see ``canonical_steps``).
    """
    turns = 0
    for d in (0, 2, 4, 6):
        if near >> (d + 4) % 8 & 1:
            turned = canonical_steps(d, near) & ~(1 << d) & 0b10101010
            turns += turned.bit_count()
    return turns


TURNS = np.array([corner_turns(near) for near in range(256)], np.uint8)


def components(free: npt.NDArray[np.bool_]) -> npt.NDArray[np.int32]:
    """Label each cell [rows, columns] with the number of its connected component; 0 if blocked.

    Legal steps connect two cells exactly if they are 4-connected, for a diagonal step needs both
    cells beside it free.
    """
    labels: npt.NDArray[np.int32]
    _, labels = cv2.connectedComponents(free.view(np.uint8), connectivity=4)
    return labels


@njit(cache=True)
def find_near(blocked: Bytes, near: Bytes) -> None:
    """Fill ``near`` [rows, columns]; ``blocked`` (0 or 1) has one more row or column all round."""
    rows, columns = near.shape
    for y in range(rows):
        above, here, below = blocked[y], blocked[y + 1], blocked[y + 2]
        for x in range(columns):
            # fmt: off
            taken = np.uint8(
                below[x + 1] | below[x + 2] << 1 | here[x + 2] << 2 | above[x + 2] << 3
                | above[x + 1] << 4 | above[x] << 5 | here[x] << 6 | below[x] << 7
            )
            # fmt: on
            free = np.uint8(255 - taken)
            near[y, x] = (free | (free == 0) << 1) * (1 - here[x + 1])


@njit(cache=True)
def count_turns(near: Bytes, stride: int) -> tuple[int, int]:
    """Number of free nodes among every ``stride``-th one, and the sum of their ``TURNS``."""
    free = total = 0
    for node in range(0, near.size, stride):
        free += near[node] != 0
        total += TURNS[near[node]]
    return free, total
