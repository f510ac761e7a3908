"""Shortest ways to a fixed goal, while cells close and the robot moves."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.planning import bucket_kernel, labels, tree_kernel
from dynastar.planning.neighbours import Bytes, Padded

Cells = npt.NDArray[np.int32]


class _Tree(NamedTuple):
    """A search from the goal: its stamp, its end nodes and the number of expanded nodes."""

    stamp: int
    goal: int
    start: int
    expanded: int


class _Way(NamedTuple):
    """A way: its last node before the tree (-1: none), where it joins the tree, the tree's stamp."""

    last: int
    meeting: int
    stamp: int


class GoalTree:
    """The last search from a goal, and which of its ways are still valid.

    ``near`` [rows, columns] is that of a padded grid, which may change; nodes are indices into it.
    """

    def __init__(self, near: Bytes) -> None:
        self.near = near
        self.labels = np.zeros(near.size, np.int64)
        self.again = np.zeros(0, np.int64)  # made when it is first needed
        self.stamp = 0
        self._tree: _Tree | None = None
        self._way = _Way(-1, 0, 0)
        self._keys = np.empty(1024, np.int64)
        self._nodes = np.empty(1024, np.int32)

    def forget(self) -> None:
        """Make the next search start from nothing."""
        self._tree = None

    def changed(self, window: tree_kernel.Window, opened: bool) -> None:
        """Update the tree after ``near`` changed in a window; ``opened``: cells became free there."""
        if opened:
            self._tree = None  # there may be shorter ways
        if self._tree is not None:
            known = self.labels, self._tree.stamp
            self._nodes = tree_kernel.prune(self._grid, known, window, self._nodes)

    def search(self, start: int, goal: int) -> tuple[bool, int]:
        """Whether there is a way between two nodes, and how many nodes were expanded."""
        if self.stamp == labels.MAX_STAMP:
            self.labels[:] = self.again[:] = self.stamp = 0
            self._tree = None
        self.stamp += 1
        tree = self._tree
        if tree is None or tree.goal != goal:
            written = self.labels, self.stamp
            found, expanded, self._keys = bucket_kernel.shortest(
                self._grid, written, goal, start, True, self._keys
            )
            self._tree = _Tree(self.stamp, goal, start, expanded) if found else None
            self._way = _Way(-1, start, self.stamp)
            return found, expanded
        if tree_kernel.is_valid(self.labels[start], tree.stamp):
            self._way = _Way(-1, start, tree.stamp)
            return True, 0
        if not self.again.size:
            self.again = np.zeros(self.near.size, np.int64)
        known, written = (self.labels, tree.stamp), (self.again, self.stamp)
        last, meeting, expanded, (self._keys, self._nodes) = tree_kernel.search_again(
            self._grid, known, tree.start, goal, written, start, (self._keys, self._nodes)
        )
        self._way = _Way(last, meeting, tree.stamp)
        if last < 0 or 2 * expanded > tree.expanded:  # too little of it is left
            self._tree = None
        return last >= 0, expanded

    def trace(self) -> tuple[Cells, float]:
        """The way (n, 2) that the last search found, in unpadded (row, column), and its length."""
        last, meeting, stamp = self._way
        width = self.near.shape[1]
        back, cost = labels.trace((self.labels, stamp), width, meeting)
        if last < 0:
            return back[::-1], cost
        cells, first_cost = labels.trace((self.again, self.stamp), width, last)
        step = math.dist(cells[-1], back[-1])
        return np.vstack([cells, back[::-1]]), first_cost + step + cost

    @property
    def searched(self) -> labels.Labels:
        """What the last search wrote."""
        return self.labels if self._way.stamp == self.stamp else self.again, self.stamp

    @property
    def _grid(self) -> Padded:
        return self.near.reshape(-1), self.near.shape[1]
