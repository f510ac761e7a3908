"""Peak memory beyond the input, bytes a cell: ``python benchmarks/memory.py --help`` (Linux).

Each line is a process of its own that is warm before it is handed an N x N map (default 4096), prepares
it and searches between two cells far apart; the peak is the kernel's (VmHWM, reset beforehand). At 16384
a process takes up to 5 GB, most of it for choosing the cells. nano_astar, which searches an array of
bytes and prepares nothing, is left out where it is not installed; it does not say what it expands.
"""

import argparse
import multiprocessing
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from maps import maze, office, queries, random_cells, rooms

from dynastar.planning import SearchGrid

Cell = tuple[int, int]

PEER = "nano_astar"
MAPS = {
    "random 20%": lambda n: random_cells(n, 0.2, 0),
    "rooms 65": lambda n: rooms(n, 65, 0),
    "office": lambda n: office(n, 0),
    "maze 8": lambda n: maze(n, 8, 0),
}


def status(field: str) -> int:
    """A line of /proc/self/status in bytes."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(field + ":"):
            return 1024 * int(line.split()[1])
    raise KeyError(field)


def search(
    occupied: np.ndarray, start: Cell, goal: Cell, algorithm: str
) -> tuple[float, float, str]:
    """Seconds to prepare a map and to search it once, and the cells expanded, in words."""
    began = time.perf_counter()
    if algorithm == PEER:
        import nano_astar

        assert len(nano_astar.astar(occupied.view(np.uint8), start, goal)[0])
        return 0.0, time.perf_counter() - began, ""
    grid = SearchGrid(occupied)
    prepared = time.perf_counter()
    found = grid.search(start, goal, algorithm)
    return prepared - began, time.perf_counter() - prepared, str(found.expanded)


def child(task: tuple[str, str, int]) -> str:
    """Measures one map with one algorithm."""
    name, algorithm, n = task
    search(np.zeros((64, 64), bool), (0, 0), (63, 63), algorithm)
    occupied = MAPS[name](n)
    ((start, goal),) = queries(occupied, 1, 0)
    Path("/proc/self/clear_refs").write_text("5")
    before = status("VmRSS")
    prepare, seconds, expanded = search(occupied, start, goal, algorithm)
    peak = status("VmHWM") - before
    return (
        f"{name:12}{algorithm:11}{peak / n**2:10.1f}{peak / 2**20:8.0f} MB{prepare:9.2f} s"
        f"{seconds:8.2f} s{expanded:>12}"
    )


def main() -> None:
    """Prints a line for each map and algorithm."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("n", type=int, nargs="?", default=4096, help="cells a side")
    parser.add_argument("--maps", nargs="+", choices=MAPS, default=list(MAPS))
    there = [PEER] if find_spec(PEER) else []
    parser.add_argument("--algorithms", nargs="+", default=["astar", "auto", "improved", *there])
    chosen = parser.parse_args()
    print(
        f"{'map':12}{'algorithm':11}{'bytes/cell':>10}{'peak':>11}{'prepare':>11}{'search':>10}"
        f"{'expanded':>12}"
    )
    for name in chosen.maps:
        for algorithm in chosen.algorithms:
            context = multiprocessing.get_context("spawn")
            with context.Pool(1) as pool:
                print(pool.apply(child, ((name, algorithm, chosen.n),)), flush=True)


if __name__ == "__main__":
    main()
