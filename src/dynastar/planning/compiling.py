"""Compiling or loading the kernels that a navigator plans with."""

import functools

import numpy as np

from dynastar.grid import OccupancyGrid
from dynastar.planning.parts import find_parts
from dynastar.planning.planner import plan
from dynastar.planning.search import SearchGrid


@functools.cache
def warm_up_planning() -> None:
    """Compile or load the kernels of paths, of a way out and of replanning."""
    rng = np.random.default_rng(0)
    blocked = rng.random((30, 30)) < 0.3
    blocked[[0, -1]] = blocked[:, [0, -1]] = False  # so many corners, and yet a way round
    search = SearchGrid(blocked)
    row, column = map(int, search.search((0, 0), (29, 29), "jump").cells[3])
    find_parts(search.near)
    grid = OccupancyGrid(100 * blocked.astype(np.int8), 1.0)
    for planner in "improved", "auto":
        plan(grid, (0.5, 0.5), (29.5, 29.5), planner, explored=True)
    for _ in range(2):
        search.search((0, 0), (29, 29), "auto")
        search.update(row, column, [[True]])
