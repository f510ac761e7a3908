"""Peak memory beyond the input, bytes a cell: ``python benchmarks/memory.py [N]`` (Linux).

Each line is a process of its own that is warm before it is handed an N x N map (default 4096), prepares
it and searches from corner to corner; the peak is the kernel's (VmHWM, reset beforehand).
"""

import multiprocessing
import sys
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
    found = SearchGrid(occupied).search(start, goal, algorithm)
    seconds = time.perf_counter() - began
    peak = (status("VmHWM") - before) / n**2
    return f"{name:12}{algorithm:10}{peak:10.1f}{seconds:8.2f} s{found.expanded:12}"


def main() -> None:
    """Prints a line for each map and algorithm."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 4096
    print(f"{'map':12}{'algorithm':10}{'bytes/cell':>10}{'time':>10}{'expanded':>12}")
    for name in MAPS:
        for algorithm in ("astar", "auto", "improved"):
            context = multiprocessing.get_context("spawn")
            with context.Pool(1) as pool:
                print(pool.apply(child, ((name, algorithm, n),)), flush=True)


if __name__ == "__main__":
    main()
