"""A prepared grid and the searches on it."""

from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.config import choose
from dynastar.errors import GoalOccupied, MapError, NoPath, OutOfMap, StartOccupied
from dynastar.planning import bucket_kernel, heap_kernel, jump_kernel, labels
from dynastar.planning.bounds import check_window
from dynastar.planning.goal_tree import GoalTree
from dynastar.planning.heuristic import PLANNERS, HeuristicConfig, kernel_terms, terms_of
from dynastar.planning.neighbours import count_turns, find_near

Cells = npt.NDArray[np.int32]
Cell = tuple[int, int]

ALGORITHMS = {name: name for name in (*PLANNERS, "jump", "auto")}
SAMPLED = 1 << 12  # cells sampled to choose between jump and astar
JUMP_BELOW = 0.3  # turns round corners per free cell, up to which jumping is faster


class SearchResult(NamedTuple):
    """A way: ``cells`` (n, 2) of (row, column) and its length ``cost`` in cells.

    ``expanded`` counts the expanded cells; ``explored`` (m, 2) lists them row by row, or is None.
    """

    cells: Cells
    cost: float
    expanded: int
    explored: Cells | None

    def __repr__(self) -> str:
        return f"<SearchResult: {self.cost:.1f} cells long, {self.expanded} cells expanded>"


class SearchGrid:
    """A grid prepared once and searched many times; nothing is cleared between searches.

    ``occupied`` is [rows, columns], true where a cell is blocked. A diagonal step needs both cells
    beside it free. P of Eq. 2 counts the cells of ``counted`` (uint8, 1 where a cell is blocked, see
    ``recount``), else those of ``occupied``. k and "around n" are measured in cells of the map, each
    ``cell`` cells of the grid wide. Raises MapError for an array that is not two-dimensional, empty
    or too large.
    """

    def __init__(
        self,
        occupied: npt.ArrayLike,
        counted: npt.NDArray[np.uint8] | None = None,
        cell: int = 1,
    ) -> None:
        mask = np.asarray(occupied, dtype=bool)
        if mask.ndim != 2 or 0 in mask.shape:
            raise MapError(f"a search grid has shape {mask.shape}: expected (rows, columns) > 0")
        self.rows, self.columns = mask.shape
        self._width = self.columns + 2
        self._counted, self._cell = counted, cell
        if (self.rows + 2) * self._width > labels.MAX_NODES:
            raise MapError(
                f"a search grid has {self.rows} x {self.columns} cells: "
                f"at most {labels.MAX_NODES} can be searched"
            )
        self.near = np.zeros((self.rows + 2, self._width), np.uint8)
        ringed = np.ones(self.near.shape, np.uint8)
        ringed[1:-1, 1:-1] = mask
        find_near(ringed, self.near[1:-1, 1:-1])
        self._sums: npt.NDArray[np.int32] | None = None
        self._recounts = False
        self._lines: jump_kernel.Lines | None = None
        self._jumps: bool | None = None
        self._labels = np.zeros(0, np.int64)  # made by the first search
        self._stamp = 0
        self._pool = np.empty(1024, np.int64)  # or the heap's keys
        self._nodes = np.empty(1024, np.int32)
        self._tree: GoalTree | None = None
        self._last: labels.Labels = self._labels, 0  # what the last search wrote

    @property
    def occupied(self) -> npt.NDArray[np.bool_]:
        """The mask that is searched, [rows, columns]; a copy."""
        return self.free == 0

    @property
    def free(self) -> npt.NDArray[np.uint8]:
        """Not 0 where a cell is free, [rows, columns]; a view, not to be written to."""
        return self.near[1:-1, 1:-1]

    def is_free(self, cell: Cell) -> bool:
        """Whether a cell (row, column) lies on the grid and is free."""
        row, column = cell
        inside = 0 <= row < self.rows and 0 <= column < self.columns
        return inside and bool(self.near[row + 1, column + 1])

    @property
    def sums(self) -> npt.NDArray[np.int32]:
        """Summed-area table [rows + 1, columns + 1]: counted in the first i rows, j columns."""
        if self._sums is None or self._recounts:
            counted = self.occupied.view(np.uint8) if self._counted is None else self._counted
            # Into the same memory: fresh memory is slow.
            self._sums = cv2.integral(counted, self._sums, sdepth=cv2.CV_32S)
            self._recounts = False
        return self._sums

    def recount(self) -> None:
        """Tell that ``counted`` has changed: the sums for P of Eq. 2 are made again when needed."""
        self._recounts = True

    @property
    def lines(self) -> jump_kernel.Lines:
        """The blocked cells as bits, row by row and column by column, for jumping."""
        if self._lines is None:
            rows, columns = self.near.shape
            self._lines = (
                np.empty((rows, (columns + 63) // 64), np.uint64),
                np.empty((columns, (rows + 63) // 64), np.uint64),
            )
            self._pack(0, 0, rows, columns)
        return self._lines

    def update(self, row0: int, col0: int, patch: npt.ArrayLike) -> None:
        """Replace the window that starts at (row0, col0) by ``patch``, true where occupied.

        What was prepared is updated in and round the window. Raises OutOfMap if the window does
        not lie in the map.
        """
        mask = np.asarray(patch, dtype=bool)
        check_window(row0, col0, mask.shape, (self.rows, self.columns))
        if 0 in mask.shape:
            return
        bottom, right = row0 + mask.shape[0], col0 + mask.shape[1]
        # The window and one cell more all round changes; two cells more tell how.
        top, left = max(row0 - 1, 0), max(col0 - 1, 0)
        end, side = min(bottom + 1, self.rows), min(right + 1, self.columns)
        blocked = (self.near[top : end + 2, left : side + 2] == 0).view(np.uint8)
        within = np.s_[row0 - top + 1 : bottom - top + 1, col0 - left + 1 : right - left + 1]
        change = mask.astype(np.int32) - blocked[within]
        if not change.any():
            return
        blocked[within] = mask
        find_near(blocked, self.near[top + 1 : end + 1, left + 1 : side + 1])
        if self._counted is None and self._sums is not None:
            more = change.cumsum(axis=0).cumsum(axis=1)
            self._sums[row0 + 1 : bottom + 1, col0 + 1 : right + 1] += more
            self._sums[row0 + 1 : bottom + 1, right + 1 :] += more[:, -1:]
            self._sums[bottom + 1 :, col0 + 1 : right + 1] += more[-1]
            self._sums[bottom + 1 :, right + 1 :] += more[-1, -1]
        if self._lines is not None:
            self._pack(row0 + 1, col0 + 1, bottom + 1, right + 1)
        self._jumps = None
        if self._tree is not None:
            window = top + 1, left + 1, end + 1, side + 1
            self._tree.changed(window, opened=bool((change < 0).any()))

    def forget(self) -> None:
        """Drop what is known about ways to the last goal: the next search starts from nothing."""
        if self._tree is not None:
            self._tree.forget()

    def search(
        self,
        start_rc: Cell,
        goal_rc: Cell,
        algorithm: str = "astar",
        heuristic: HeuristicConfig | None = None,
        explored: bool = False,
    ) -> SearchResult:
        """The way from cell to cell by ``algorithm``, a name in ``ALGORITHMS``.

        dijkstra, astar, jump and auto find the shortest way of the 8-connected grid, within 3e-7 of
        its length: all round, towards the goal, by jump points, or as fits the map. Where auto does
        not jump, it searches from the goal; the next time to the same goal it searches only where
        cells that closed meanwhile have cut the ways (see ``forget``). weighted and improved are
        Eqs. 2-3 with the terms of ``heuristic``; weighted with a weight of 1 is the traditional A*
        on the kernel of the improved one, for ablations.

        Raises OutOfMap, StartOccupied, GoalOccupied or NoPath; ConfigError for an unknown name.
        """
        choose(algorithm, ALGORITHMS, "planner")
        start, goal = self._inside(start_rc, "start"), self._inside(goal_rc, "goal")
        if not self.is_free(start):
            raise StartOccupied(f"the start, cell {start}, is occupied: expected a free cell")
        if not self.is_free(goal):
            raise GoalOccupied(f"the goal, cell {goal}, is occupied: expected a free cell")
        terms = heuristic or _DEFAULTS
        from_goal = False
        if algorithm == "auto":
            algorithm = "jump" if self._prefers_jumps() else "astar"
            from_goal = algorithm == "astar" and terms.estimate == "octile"
        if from_goal:
            way, expanded = self._search_from_goal(start, goal)
        else:
            found, expanded = self._run(start, goal, algorithm, terms)
            way = self._trace(goal) if found else None
        if way is None:
            raise NoPath(
                f"no way leads from cell {start} to cell {goal}: {expanded} cells were expanded"
            )
        return SearchResult(*way, expanded, self.expanded_cells() if explored else None)

    def flood(self, start_rc: Cell) -> npt.NDArray[np.float64]:
        """Lengths in cells, [rows, columns], of the shortest ways from a cell; inf if none."""
        start = self._inside(start_rc, "start")
        self._run(start, None, "dijkstra", _DEFAULTS)
        nodes, lengths = self._closed(), np.full(self.near.size, np.inf)
        lengths[nodes] = (self._labels[nodes] >> labels.G_SHIFT) / labels.STRAIGHT
        return lengths.reshape(self.near.shape)[1:-1, 1:-1]

    def way_to(self, cell: Cell) -> Cells:
        """The way (n, 2) to a cell that the last flood expanded; NoPath for any other."""
        node = self._node(self._inside(cell, "cell"))
        flooded = self._stamp > 0 and self._last[0] is self._labels
        if not flooded or not labels.is_closed(self._labels[node], self._stamp):
            raise NoPath(f"cell {cell} was not reached by the last flood: expected one that was")
        return self._trace(cell)[0]

    def expanded_cells(self) -> Cells:
        """The cells (m, 2) that the last search expanded, row by row."""
        nodes = self._closed()
        return np.column_stack(np.divmod(nodes, self._width)).astype(np.int32) - np.int32(1)

    def _run(
        self, start: Cell, goal: Cell | None, algorithm: str, heuristic: HeuristicConfig
    ) -> tuple[bool, int]:
        """Whether the goal was found, and how many cells were expanded."""
        if self._stamp == labels.MAX_STAMP or not self._labels.size:
            self._labels = np.zeros(self.near.size, np.int64)
            self._stamp = 0
        self._stamp += 1
        self._last = self._labels, self._stamp
        ends = self._node(start), -1 if goal is None else self._node(goal)
        grid, heap = (self.near.reshape(-1), self._width), (self._pool, self._nodes)
        if algorithm == "jump":
            found, expanded, (self._pool, self._nodes) = jump_kernel.jump_search(
                grid, self.lines, self._last, *ends, heap
            )
            return found, expanded
        terms = terms_of(algorithm, heuristic)
        if algorithm in ("dijkstra", "astar") and terms.estimate == "octile":
            found, expanded, self._pool = bucket_kernel.shortest(
                grid, self._last, *ends, terms.weight > 0.0, self._pool
            )
            return found, expanded
        sums = self.sums if terms.exponential else _NO_SUMS
        wanted = kernel_terms(terms, start, goal or start, int(sums[-1, -1]), self._cell)
        found, expanded, (self._pool, self._nodes) = heap_kernel.search(
            grid, sums, self._last, *ends, wanted, heap
        )
        return found, expanded

    def _search_from_goal(self, start: Cell, goal: Cell) -> tuple[tuple[Cells, float] | None, int]:
        """The shortest way and its length, or None, and how many cells were expanded.

        Uses and keeps the ways to the goal that earlier searches found.
        """
        if self._tree is None:
            self._tree = GoalTree(self.near)
        found, expanded = self._tree.search(self._node(start), self._node(goal))
        self._last = self._tree.searched
        return self._tree.trace() if found else None, expanded

    def _prefers_jumps(self) -> bool:
        """Whether the map has so few corners that jumping from one to the next is worth it."""
        if self._jumps is None:
            stride = max(1, self.near.size // SAMPLED) | 1
            free, turns = count_turns(self.near.reshape(-1), stride)
            self._jumps = turns < JUMP_BELOW * free
        return self._jumps

    def _pack(self, top: int, left: int, bottom: int, right: int) -> None:
        rows, columns = self.lines
        jump_kernel.pack(self.near, rows, top, left, bottom, right)
        jump_kernel.pack(self.near, columns, left, top, right, bottom, upright=True)

    def _trace(self, goal: Cell) -> tuple[Cells, float]:
        return labels.trace(self._last, self._width, self._node(goal))

    def _closed(self) -> npt.NDArray[np.int32]:
        """The nodes that the last search closed, in order."""
        return labels.closed_nodes(self._last)

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


_DEFAULTS = HeuristicConfig()
_NO_SUMS = np.zeros((1, 1), np.int32)
