"""Replanning at the cost of the change: ``python benchmarks/replanning.py``.

Maps of 2048 x 2048 cells, and on each 40 x 40 cells that block the way 100 cells from the robot (5 m at
5 cm): the prepared grid is updated and searched, or a new one prepared and searched. Both ways are as
long as each other. Where it does not jump, ``auto`` goes by what its last search from the goal knows.
nano_astar, where it is installed, searches the changed map as a whole; it has nothing to update or prepare.
"""

import math
import time

import numpy as np
import numpy.typing as npt
from maps import maze, office, queries, random_cells, rooms

from dynastar.errors import NoPath
from dynastar.planning import SearchGrid

try:
    import nano_astar
except ImportError:
    nano_astar = None

N, SIDE, AWAY, REPEATS = 2048, 40, 100, 5


def of_peer(
    occupied: npt.NDArray[np.bool_], start: tuple[int, int], goal: tuple[int, int], cost: float
) -> float:
    """Seconds of nano_astar's search, the best of some; its path is asserted to be as long."""
    cells, least = occupied.astype(np.uint8), math.inf
    for _ in range(REPEATS):
        began = time.perf_counter()
        found = nano_astar.astar(cells, start, goal)[1]
        least = min(least, time.perf_counter() - began)
        assert abs(found - cost) < 1e-3
    return least


def main() -> None:
    """Prints a line for each map and algorithm."""
    maps = {
        "random 20%": random_cells(N, 0.2, 0),
        "rooms 65": rooms(N, 65, 0),
        "maze 8": maze(N, 8, 0),
        "office": office(N, 0),
    }
    print(
        f"{'map':12}{'algorithm':10}{'update':>9}{'search':>9}{'prepare':>9}{'search':>9}{'ratio':>8}"
        f"{'nano_astar':>12}{'ratio':>8}   ms"
    )
    for name, occupied in maps.items():
        start, goal = queries(occupied, 1, 0)[0]
        for algorithm in ("auto", "astar", "improved"):
            before = SearchGrid(occupied)
            way = before.search(start, goal, algorithm).cells
            row, column = (int(i) - SIDE // 2 for i in way[min(AWAY, len(way) // 2)])
            row, column = max(0, min(row, N - SIDE)), max(0, min(column, N - SIDE))
            changed = occupied.copy()
            changed[row : row + SIDE, column : column + SIDE] = True
            patch, old = changed[row : row + SIDE, column : column + SIDE], occupied
            least = dict.fromkeys(("update", "search", "prepare", "again"), math.inf)
            try:
                for _ in range(REPEATS):
                    before.update(row, column, old[row : row + SIDE, column : column + SIDE])
                    before.search(start, goal, algorithm)
                    times = [time.perf_counter()]
                    before.update(row, column, patch)
                    times.append(time.perf_counter())
                    updated = before.search(start, goal, algorithm)
                    times.append(time.perf_counter())
                    anew = SearchGrid(changed)
                    times.append(time.perf_counter())
                    fresh = anew.search(start, goal, algorithm)
                    times.append(time.perf_counter())
                    assert abs(updated.cost - fresh.cost) < 1e-6
                    for key, seconds in zip(least, np.diff(times), strict=True):
                        least[key] = min(least[key], float(seconds))
            except NoPath:
                print(f"{name:12}{algorithm:10} no way is left")
                continue
            update, search, prepare, again = (1e3 * least[key] for key in least)
            beside = ""  # Eq. 2's paths are not the shortest, as nano_astar's are
            if nano_astar is not None and algorithm != "improved":
                peer = 1e3 * of_peer(changed, start, goal, fresh.cost)
                beside = f"{peer:12.2f}{(update + search) / peer:8.3f}"
            print(
                f"{name:12}{algorithm:10}{update:9.2f}{search:9.2f}{prepare:9.2f}{again:9.2f}"
                f"{(update + search) / (prepare + again):8.2f}{beside}"
            )


if __name__ == "__main__":
    main()
