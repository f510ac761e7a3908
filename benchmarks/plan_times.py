"""The longest that a plan takes, for any radius: ``python benchmarks/plan_times.py [--plans 300]``.

Rooms with boxes of 0.2 to 1 m in them that cover a seventh, of 9 x 7 m in cells of 2 cm and of
100 x 100 m in cells of 5 cm. A disc of any radius up to 1.5 m is to go from any free cell to any other,
so that most starts lie in the inflation, and many plans end in a refusal. Each map is new: ``prepare``
inflates it, ``plan`` is the improved A* with the way out of the inflation, and ``exact`` the same by the
exact search. Where there is a path, ``replan`` marks a box of 1 m on its middle and plans again by the
improved A*. Warm, one thread, each plan once.
"""

import argparse
import time

import numpy as np
import numpy.typing as npt

from dynastar.errors import PlanningError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.path import Path
from dynastar.planning import GridPlanner
from dynastar.simulation.warming import warm_up

MAPS = {"9 x 7 m, 2 cm": (9.0, 7.0, 0.02), "100 x 100 m, 5 cm": (100.0, 100.0, 0.05)}
LARGEST_RADIUS, COVERED, BOX = 1.5, 1.0 / 7.0, 1.0  # m, part of the room, m


def room(random: np.random.Generator, width: float, height: float, cell: float) -> OccupancyGrid:
    """A room (m) with boxes in it, in cells of ``cell`` m."""
    occupied = np.zeros((round(height / cell), round(width / cell)), np.bool_)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    covered = 0.0
    while covered < COVERED * width * height:
        wide, high = random.uniform(0.2, 1.0, 2)
        x, y = random.uniform(0.0, width - wide), random.uniform(0.0, height - high)
        rows, columns = (
            slice(round(a / cell), round((a + b) / cell)) for a, b in ((y, high), (x, wide))
        )
        occupied[rows, columns] = True
        covered += wide * high
    return OccupancyGrid(occupied, GridFrame(cell))


def timed_plan(
    planner: GridPlanner, ends: npt.NDArray[np.float64], algorithm: str
) -> tuple[float, Path | None]:
    """Seconds of a plan or its refusal, and the path, if there is one."""
    began = time.perf_counter()
    try:
        path = planner.plan(tuple(ends[0]), tuple(ends[1]), planner=algorithm).path
    except PlanningError:
        path = None
    return time.perf_counter() - began, path


def timed_replan(planner: GridPlanner, ends: npt.NDArray[np.float64], path: Path) -> float:
    """Seconds to mark a box on the middle of a path and to plan again."""
    began = time.perf_counter()
    middle = path.part(0.0, 0.5 * path.length)[-1]
    row, column = map(int, planner.grid.frame.to_grid(*middle))
    half = round(0.5 * BOX / planner.grid.resolution)
    top, left = max(row - half, 0), max(column - half, 0)
    box = planner.blocked[top : row + half, left : column + half]
    planner.mark(top, left, np.ones_like(box))
    timed_plan(planner, ends, "improved")
    return time.perf_counter() - began


def main() -> None:
    """Prints a line for each map and part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plans", type=int, default=300, help="on each map (default 300)")
    plans = parser.parse_args().plans
    warm_up()
    print(f"{'map':20}{'':9}{'plans':>6}{'found':>7}{'median':>9}{'p99':>9}{'worst':>9}  ms")
    for name, size in MAPS.items():
        seconds: dict[str, list[float]] = {"prepare": [], "plan": [], "exact": [], "replan": []}
        found = 0
        for number in range(plans):
            random = np.random.default_rng([number, round(1e3 * size[2])])
            grid = room(random, *size)
            free = np.argwhere(grid.values == 0)
            ends = grid.frame.points_to_world(free[random.integers(0, len(free), 2)] + 0.5)
            began = time.perf_counter()
            planner = GridPlanner(grid, random.uniform(0.0, LARGEST_RADIUS))
            took = {"prepare": time.perf_counter() - began}
            took["plan"], path = timed_plan(planner, ends, "improved")
            took["exact"], _ = timed_plan(planner, ends, "auto")
            if path is not None:
                found += 1
                took["replan"] = timed_replan(planner, ends, path)
            for part, value in took.items():
                seconds[part].append(value)
        for part, values in seconds.items():
            ms = 1e3 * np.array(values)
            figures = "".join(f"{x:9.1f}" for x in (np.median(ms), np.quantile(ms, 0.99), ms.max()))
            print(f"{name:20}{part:9}{len(values):6}{found:7}{figures}", flush=True)


if __name__ == "__main__":
    main()
