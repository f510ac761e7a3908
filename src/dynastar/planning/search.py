"""A prepared grid and the searches on it."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import choose
from dynastar.errors import GoalOccupied, MapError, NoPath, OutOfMap, StartOccupied
from dynastar.planning import search_kernel as kernel
from dynastar.planning.heuristic import PLANNERS, HeuristicConfig, kernel_terms

Cells = npt.NDArray[np.int32]
Cell = tuple[int, int]


class SearchResult(NamedTuple):
    """A way: ``cells`` (n, 2) of (row, column), its ``cost`` in cells, what was expanded for it.

    ``explored`` (m, 2) are the expanded cells, row by row, or None if nobody asked.
    """

    cells: Cells
    cost: float
    expanded: int
    explored: Cells | None


class SearchGrid:
    """A grid prepared once and searched many times; nothing is cleared between searches.

    ``occupied`` is [rows, columns], true where nothing can be. A diagonal step needs both cells
    beside it free. Raises MapError for an array that is not two-dimensional, empty or too large.
    """

    def __init__(self, occupied: npt.ArrayLike) -> None:
        mask = np.asarray(occupied, dtype=bool)
        if mask.ndim != 2 or 0 in mask.shape:
            raise MapError(f"a search grid has shape {mask.shape}: expected (rows, columns) > 0")
        self.rows, self.columns = mask.shape
        self._width = self.columns + 2
        if (self.rows + 2) * self._width > kernel.MAX_NODES:
            raise MapError(
                f"a search grid has {self.rows} x {self.columns} cells: "
                f"at most {kernel.MAX_NODES} can be searched"
            )
        self._blocked = np.pad(mask, 1, constant_values=True).view(np.uint8)
        self._moves = np.zeros_like(self._blocked)
        kernel.find_moves(self._blocked, self._moves, 1, 1, self.rows + 1, self.columns + 1)
        self._sums: npt.NDArray[np.int32] | None = None
        self._state = np.zeros(self._blocked.size, np.int64)
        self._stamp = 0
        self._heap = np.empty(1024, np.int64)
        self._nodes = np.empty(1024, np.int32)

    @property
    def occupied(self) -> npt.NDArray[np.bool_]:
        """The mask that is searched, [rows, columns], read-only."""
        mask = self._blocked[1:-1, 1:-1].view(np.bool_)
        mask.flags.writeable = False
        return mask

    @property
    def sums(self) -> npt.NDArray[np.int32]:
        """Summed-area table [rows + 1, columns + 1]: occupied in the first i rows, j columns."""
        if self._sums is None:
            sums = np.zeros((self.rows + 1, self.columns + 1), np.int32)
            np.cumsum(self._blocked[1:-1, 1:-1], axis=0, dtype=np.int32, out=sums[1:, 1:])
            np.cumsum(sums[1:, 1:], axis=1, out=sums[1:, 1:])
            self._sums = sums
        return self._sums

    def update(self, row0: int, col0: int, patch: npt.ArrayLike) -> None:
        """Replaces the window that starts at (row0, col0) by ``patch``, true where occupied.

        Raises OutOfMap if the window does not lie in the map.
        """
        mask = np.asarray(patch, dtype=bool)
        check_window(row0, col0, mask.shape, (self.rows, self.columns))
        rows, columns = mask.shape
        self._blocked[row0 + 1 : row0 + 1 + rows, col0 + 1 : col0 + 1 + columns] = mask
        bottom, right = (
            min(row0 + rows + 2, self.rows + 1),
            min(col0 + columns + 2, self._width - 1),
        )
        kernel.find_moves(self._blocked, self._moves, max(row0, 1), max(col0, 1), bottom, right)
        self._sums = None

    def search(
        self,
        start_rc: Cell,
        goal_rc: Cell,
        algorithm: str = "astar",
        heuristic: HeuristicConfig | None = None,
        explored: bool = False,
    ) -> SearchResult:
        """The way from cell to cell by ``algorithm``, a name in ``PLANNERS`` (Eqs. 2-3).

        dijkstra and astar find the shortest way of the 8-connected grid, within 3e-7 of its length.
        Raises OutOfMap, StartOccupied, GoalOccupied or NoPath; ConfigError for an unknown name.
        """
        config = choose(algorithm, PLANNERS, "planner")(heuristic or HeuristicConfig())
        start, goal = self._inside(start_rc, "start"), self._inside(goal_rc, "goal")
        if self._blocked[start[0] + 1, start[1] + 1]:
            raise StartOccupied(f"the start, cell {start}, is occupied: expected a free cell")
        if self._blocked[goal[0] + 1, goal[1] + 1]:
            raise GoalOccupied(f"the goal, cell {goal}, is occupied: expected a free cell")
        found, expanded = self._run(start, goal, config)
        if not found:
            raise NoPath(
                f"no way leads from cell {start} to cell {goal}: "
                f"the {expanded} cells that can be reached from the start do not hold the goal"
            )
        cells = kernel.trace(self._state, self._width, self._node(goal))
        return SearchResult(
            cells, way_length(cells), expanded, self.expanded_cells() if explored else None
        )

    def flood(self, start_rc: Cell) -> npt.NDArray[np.float64]:
        """Lengths in cells, [rows, columns], of the shortest ways from a cell; inf if none."""
        start = self._inside(start_rc, "start")
        self._run(start, None, PLANNERS["dijkstra"](HeuristicConfig()))
        lengths = (self._state >> kernel.G_SHIFT) / kernel.STRAIGHT
        lengths[~_closed(self._state, self._stamp)] = np.inf
        return lengths.reshape(self._blocked.shape)[1:-1, 1:-1]

    def reached(self, cell: Cell) -> bool:
        """Whether the last search or flood expanded a cell."""
        node = self._node(self._inside(cell, "cell"))
        return bool(_closed(self._state[node : node + 1], self._stamp)[0])

    def way_to(self, cell: Cell) -> Cells:
        """The way (n, 2) to a cell that the last search or flood expanded; NoPath for any other."""
        if not self.reached(cell):
            raise NoPath(f"cell {cell} was not reached by the last search: expected one that was")
        return kernel.trace(self._state, self._width, self._node(cell))

    def expanded_cells(self) -> Cells:
        """The cells (m, 2) that the last search expanded, row by row."""
        nodes = np.flatnonzero(_closed(self._state, self._stamp))
        return np.column_stack(np.divmod(nodes, self._width)).astype(np.int32) - np.int32(1)

    def _run(self, start: Cell, goal: Cell | None, config: HeuristicConfig) -> tuple[bool, int]:
        if self._stamp == kernel.MAX_STAMP:
            self._state[:] = 0
            self._stamp = 0
        self._stamp += 1
        sums = self.sums if config.exponential else _NO_SUMS
        terms = kernel_terms(config, start, goal or start, int(sums[-1, -1]))
        found, expanded, self._heap, self._nodes = kernel.search(
            self._moves.reshape(-1), sums, self._width, self._state, self._stamp,
            self._node(start), -1 if goal is None else self._node(goal), terms,
            self._heap, self._nodes,
        )  # fmt: skip
        return found, expanded

    def _node(self, cell: Cell) -> int:
        return (cell[0] + 1) * self._width + cell[1] + 1

    def _inside(self, cell: Cell, name: str) -> Cell:
        row, column = int(cell[0]), int(cell[1])
        if not (0 <= row < self.rows and 0 <= column < self.columns):
            raise OutOfMap(
                f"the {name}, cell ({row}, {column}), is off the map: "
                f"expected rows 0 to {self.rows - 1}, columns 0 to {self.columns - 1}"
            )
        return row, column


def check_window(row0: int, col0: int, window: tuple[int, ...], whole: tuple[int, int]) -> None:
    """MapError or OutOfMap unless a window of that shape, put at (row0, col0), lies in the map."""
    if len(window) != 2:
        raise MapError(f"a patch has shape {window}: expected (rows, columns)")
    if row0 < 0 or col0 < 0 or row0 + window[0] > whole[0] or col0 + window[1] > whole[1]:
        raise OutOfMap(
            f"a window of {window[0]} x {window[1]} cells at ({row0}, {col0}) leaves the map "
            f"of {whole[0]} x {whole[1]}"
        )


def _closed(state: npt.NDArray[np.int64], stamp: int) -> npt.NDArray[np.bool_]:
    return (state & (kernel.STAMP_BITS | 1)) == (stamp << kernel.STAMP_SHIFT | 1)


_NO_SUMS = np.zeros((1, 1), np.int32)


def way_length(cells: npt.ArrayLike) -> float:
    """Length in cells of a way (n, 2), counted from its straight and its diagonal steps."""
    steps = np.abs(np.diff(np.asarray(cells), axis=0)).sum(axis=1)
    diagonal = int((steps == 2).sum())
    return len(steps) - diagonal + diagonal * 2.0**0.5
