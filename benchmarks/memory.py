"""Peak memory beyond the input, bytes a cell: ``python benchmarks/memory.py --help`` (Linux).

Each line is a process of its own that is warm before it is handed an N x N map (default 4096), prepares
it and searches between two cells far apart; the peak is the kernel's (VmHWM, reset beforehand). At 16384
a process takes up to 5 GB, most of it for choosing the cells.
"""

import argparse
import multiprocessing
import time
from pathlib import Path

import numpy as np
from maps import maze, office, queries, random_cells, rooms

from dynastar.planning import SearchGrid

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


def child(task: tuple[str, str, int]) -> str:
    """Measures one map with one algorithm."""
    name, algorithm, n = task
    SearchGrid(np.zeros((64, 64), bool)).search((0, 0), (63, 63), algorithm)
    occupied = MAPS[name](n)
    ((start, goal),) = queries(occupied, 1, 0)
    Path("/proc/self/clear_refs").write_text("5")
    before = status("VmRSS")
    began = time.perf_counter()
    grid = SearchGrid(occupied)
    prepared = time.perf_counter()
    found = grid.search(start, goal, algorithm)
    prepare, search = prepared - began, time.perf_counter() - prepared
    peak = status("VmHWM") - before
    return (
        f"{name:12}{algorithm:10}{peak / n**2:10.1f}{peak / 2**20:8.0f} MB{prepare:9.2f} s"
        f"{search:8.2f} s{found.expanded:12}"
    )


def main() -> None:
    """Prints a line for each map and algorithm."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("n", type=int, nargs="?", default=4096, help="cells a side")
    parser.add_argument("--maps", nargs="+", choices=MAPS, default=list(MAPS))
    parser.add_argument("--algorithms", nargs="+", default=["astar", "auto", "improved"])
    chosen = parser.parse_args()
    print(
        f"{'map':12}{'algorithm':10}{'bytes/cell':>10}{'peak':>11}{'prepare':>11}{'search':>10}"
        f"{'expanded':>12}"
    )
    for name in chosen.maps:
        for algorithm in chosen.algorithms:
            context = multiprocessing.get_context("spawn")
            with context.Pool(1) as pool:
                print(pool.apply(child, ((name, algorithm, chosen.n),)), flush=True)


if __name__ == "__main__":
    main()
