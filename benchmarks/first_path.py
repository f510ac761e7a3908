"""What the first path by Eq. 2 takes and what the exact search adds: ``python benchmarks/first_path.py``.

A navigator drives along the path of the improved A*, and in the next tick along the exact one where that
is clearly shorter (``replanning.CLEARLY_SHORTER``). Maps of 40 x 40 cells, a quarter of each kind, corner
to corner, against the optimum over any points; with ``--data DIR`` real maps, too, between random places
for a disc of 0.25 m, against the exact path (where the optimum would take hours).
"""

import argparse
from itertools import count, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dynastar.bench.families import KINDS, draw
from dynastar.bench.optimum import shortest_over_corners
from dynastar.errors import PlanningError
from dynastar.grid import OccupancyGrid
from dynastar.io import load_map
from dynastar.navigator.replanning import CLEARLY_SHORTER
from dynastar.path import Path as Line
from dynastar.planning import GridPlanner

RADIUS, QUERIES, ROUNDS = 0.25, 20, 3
REAL = ("ros_maps/*.yaml", "mrpb/map10cm/*/*.yaml")


class Asked(NamedTuple):
    """Times (ms) of both searches with smoothing, and lengths over the optimum's."""

    first_ms: float
    exact_ms: float
    first: float
    exact: float
    final: float


def ask(planner: GridPlanner, start, goal, optimum: float) -> Asked:
    """One query; each search at its best of some rounds."""
    rounds = [
        (planner.plan(start, goal), planner.plan(start, goal, planner="auto"))
        for _ in range(ROUNDS)
    ]
    first, exact = rounds[0][0].path.length, rounds[0][1].path.length
    final = exact if exact < CLEARLY_SHORTER * first else first
    return Asked(
        min(by_eq_2.time_ms for by_eq_2, _ in rounds),
        min(exactly.time_ms for _, exactly in rounds),
        *(length / optimum for length in (first, exact, final)),
    )


def drawn_maps(kind: str, maps: int) -> list[Asked]:
    """The first maps of a kind that have a way."""
    found = []
    for made in islice(filter(None, (draw(kind, n, 0, 40) for n in count())), maps):
        grid = OccupancyGrid.from_occupied(made.occupied, 1.0)
        start, goal = (tuple(x + 0.5 for x in cell[::-1]) for cell in (made.start, made.goal))
        planner = GridPlanner(grid, 0.0)
        way = planner.plan(start, goal, planner="auto").cells + 0.5
        optimum = Line(shortest_over_corners(made.occupied, way)).length
        found.append(ask(planner, start, goal, optimum))
    return found


def real_map(file: Path) -> list[Asked]:
    """Random places of a map with a way between them, at least 5 m apart."""
    grid = load_map(file)
    planner = GridPlanner(grid, RADIUS)
    free, random, found = np.argwhere(~planner.inflated), np.random.default_rng(0), []
    for _ in range(50 * QUERIES):
        cells = free[random.integers(0, len(free), 2)] + 0.5
        start, goal = map(tuple, grid.frame.points_to_world(cells))
        if len(found) < QUERIES and np.hypot(*np.subtract(start, goal)) >= 5.0:
            try:
                optimum = planner.plan(start, goal, planner="auto").path.length
                found.append(ask(planner, start, goal, optimum))
            except PlanningError:
                continue
    return found


def show(name: str, asked: list[Asked]) -> None:
    """A line: medians and 95th percentiles of the times, means and worst of the lengths."""
    columns = np.array(asked).T
    times = [f"{np.median(t):8.2f}{np.quantile(t, 0.95):8.2f}" for t in columns[:2]]
    ratios = [f"{r.mean():8.4f}{r.max():8.3f}" for r in columns[2:]]
    print(f"{name[:26]:26}{len(asked):6}{''.join(times)}{''.join(ratios)}", flush=True)


def main() -> None:
    """Prints a line for each kind of map, and for each real one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maps", type=int, default=1000, help="drawn maps (default 1000)")
    parser.add_argument("--data", type=Path, help="folder with the real maps")
    arguments = parser.parse_args()
    print(f"{'':26}{'':6}{'Eq. 2 ms':>16}{'exact ms':>16}{'Eq. 2':>16}{'exact':>16}{'final':>16}")
    print(f"{'maps':26}{'asked':>6}{'  median     p95' * 2}{'    mean   worst' * 3}")
    everything = []
    for kind in KINDS:
        asked = drawn_maps(kind, -(-arguments.maps // len(KINDS)))
        everything += asked
        show(kind, asked)
    show("all", everything)
    for pattern in REAL if arguments.data else ():
        for file in sorted(arguments.data.glob(pattern)):
            asked = real_map(file)
            if asked:
                show(f"{file.parent.name}/{file.stem}", asked)


if __name__ == "__main__":
    main()
