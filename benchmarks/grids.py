"""Grid search beside the planners that a user could pick instead: ``python benchmarks/grids.py --help``.

Every contender gets the same maps and queries, in turns, warm, one thread, and the best of its times
counts. nano_astar, pathfinding and networkx (on a graph with the same edges, made beforehand) solve the
same task (octile, no corner cutting), so their lengths have to be ours; the last two are Python and only
asked on maps of up to 256 cells a side, for beyond they take too long. pyastar2d charges 1 for a diagonal
step and cuts corners, tcod and scikit-image cut corners: theirs are other tasks, and the table says so.
Peers that are not installed are left out; the last column says over how many maps a row's means are.
"""

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from maps import Case, Mask, cases

from dynastar.planning import SearchGrid

ROUNDS, REPEATS = 2, 4  # in a row, so that everybody finds the caches warm
SMALL = 256  # cells a side, the largest map for peers in Python
Query = tuple[tuple[int, int], tuple[int, int]]


def ours(case: Case) -> dict[str, Callable[[Query], float | None]]:
    """dynastar's kernels on one prepared grid, and everything from the raw array."""
    grid = SearchGrid(case.occupied)

    def by(algorithm: str) -> Callable[[Query], float | None]:
        def run(query: Query) -> float | None:
            grid.forget()  # every search finds its way from nothing
            found = grid.search(*query, algorithm)
            assert found.expanded > 0
            return found.cost

        return run

    return {
        "astar": by("astar"),
        "jump": by("jump"),
        "auto": by("auto"),
        "one shot": lambda query: SearchGrid(case.occupied).search(*query, "auto").cost,
    }


def peers(case: Case) -> dict[str, Callable[[Query], float | None]]:
    """The peers that are installed; each returns the length if its task is the same, else None."""
    found: dict[str, Callable[[Query], float | None]] = {}
    try:
        import nano_astar

        bytes_ = case.occupied.astype(np.uint8)
        found["nano_astar"] = lambda query: nano_astar.astar(bytes_, *query)[1]
    except ImportError:
        pass
    try:
        import pyastar2d

        weights = np.where(case.occupied, np.inf, 1.0).astype(np.float32)

        def two_d(query: Query) -> None:
            assert pyastar2d.astar_path(weights, *query, allow_diagonal=True) is not None

        found["pyastar2d (other task)"] = two_d
    except ImportError:
        pass
    try:
        import tcod.path

        free = (~case.occupied).astype(np.int8)

        def roguelike(query: Query) -> None:
            graph = tcod.path.SimpleGraph(cost=free, cardinal=985, diagonal=1393)
            finder = tcod.path.Pathfinder(graph)
            finder.add_root(query[0])
            assert len(finder.path_to(query[1]))

        found["tcod (other task)"] = roguelike
    except ImportError:
        pass
    try:
        from skimage.graph import route_through_array

        costs = np.where(case.occupied, -1.0, 1.0)

        def image(query: Query) -> None:
            path, _ = route_through_array(costs, *query, fully_connected=True, geometric=True)
            assert path

        found["scikit-image (other task)"] = image
    except ImportError:
        pass
    return found


def in_python(case: Case) -> dict[str, Callable[[Query], float]]:
    """The peers in Python, on small maps."""
    found: dict[str, Callable[[Query], float]] = {}
    if max(case.occupied.shape) > SMALL:
        return found
    try:
        from pathfinding.core.diagonal_movement import DiagonalMovement
        from pathfinding.core.grid import Grid
        from pathfinding.finder.a_star import AStarFinder

        grid = Grid(matrix=(~case.occupied).astype(int).tolist())
        finder = AStarFinder(diagonal_movement=DiagonalMovement.only_when_no_obstacle)

        def objects(query: Query) -> float:
            start, goal = (grid.node(column, row) for row, column in query)
            path, _ = finder.find_path(start, goal, grid)  # what was left of the last is cleaned up
            assert path[-1] is goal
            return float(goal.g)

        found["pathfinding"] = objects
    except ImportError:
        pass
    try:
        import networkx

        graph = networkx.Graph()
        graph.add_weighted_edges_from(edges(~case.occupied))

        def octile(a: tuple[int, int], b: tuple[int, int]) -> float:
            rows, columns = abs(a[0] - b[0]), abs(a[1] - b[1])
            return rows + columns - (2.0 - math.sqrt(2.0)) * min(rows, columns)

        found["networkx"] = lambda query: networkx.astar_path_length(graph, *query, octile)
    except ImportError:
        pass
    return found


def edges(free: Mask) -> Iterator[tuple[tuple[int, int], tuple[int, int], float]]:
    """The steps of the grid: to the four neighbours, and diagonally past no corner."""
    rows, columns = free.shape
    for row, column in np.argwhere(free).tolist():
        right = column + 1 < columns and free[row, column + 1]
        if right:
            yield (row, column), (row, column + 1), 1.0
        if row + 1 == rows:
            continue
        if free[row + 1, column]:
            yield (row, column), (row + 1, column), 1.0
            if right and free[row + 1, column + 1]:
                yield (row, column), (row + 1, column + 1), math.sqrt(2.0)
            if column > 0 and free[row, column - 1] and free[row + 1, column - 1]:
                yield (row, column), (row + 1, column - 1), math.sqrt(2.0)


def measure(case: Case, quick: bool) -> dict[str, Any]:
    """Seconds by contender, summed over the case's queries, the best of some runs each."""
    contenders = ours(case) | peers(case)
    if quick:
        contenders = {k: v for k, v in contenders.items() if "other task" not in k}
    else:
        contenders |= in_python(case)
    took = dict.fromkeys(contenders, 0.0)
    for query in case.queries:
        best = dict.fromkeys(contenders, math.inf)
        lengths: dict[str, float | None] = {}
        for _ in range(ROUNDS):
            for name, run in contenders.items():
                for _ in range(REPEATS if best[name] < 0.2 else 1):
                    began = time.perf_counter()
                    lengths[name] = run(query)
                    best[name] = min(best[name], time.perf_counter() - began)
        same = [length for length in lengths.values() if length is not None]
        assert max(same) - min(same) < 1e-3, (case.name, query, lengths)
        for name, seconds in best.items():
            took[name] += seconds
    return {"kind": case.kind, "map": case.name, "size": max(case.occupied.shape), "seconds": took}


def mean(ratios: list[float]) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, ratios)) / len(ratios)) if ratios else math.nan


def main() -> None:
    """Measures and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, help="a folder with MovingAI maps")
    parser.add_argument("--largest", type=int, default=4096, help="leave out larger maps")
    parser.add_argument("--quick", action="store_true", help="nano_astar alone")
    parser.add_argument("--json-out", type=Path)
    chosen = parser.parse_args()
    rows = []
    for case in cases(chosen.data):
        if max(case.occupied.shape) <= chosen.largest:
            rows.append(measure(case, chosen.quick))
            seconds = rows[-1]["seconds"]
            base = seconds.get("nano_astar", math.nan)
            shown = "  ".join(f"{name} {s / base:.3f}" for name, s in seconds.items())
            print(f"{case.kind:9}{case.name:22}{1e3 * base / len(case.queries):9.2f} ms  {shown}")
    print()
    kinds = [*dict.fromkeys(row["kind"] for row in rows), "all"]
    columns = [*kinds, "worst", "maps"]
    print(f"{'/ nano_astar':28}" + "".join(f"{column:>10}" for column in columns))
    names = dict.fromkeys(name for row in rows for name in row["seconds"])
    for name in [n for n in names if n != "nano_astar"]:
        line, ratios = f"{name:28}", list[float]()
        for kind in kinds:
            ratios = [
                row["seconds"][name] / row["seconds"]["nano_astar"]
                for row in rows
                if kind in (row["kind"], "all")
                and {name, "nano_astar"} <= row["seconds"].keys()
                and (name != "one shot" or row["size"] >= 256)
            ]
            line += f"{mean(ratios):10.3f}"
        print(line + f"{max(ratios, default=math.nan):10.3f}{len(ratios):10}")
    fits = [r["seconds"]["auto"] / min(r["seconds"]["astar"], r["seconds"]["jump"]) for r in rows]
    print(f"auto / the better kernel: {mean(fits):.3f}, worst {max(fits):.3f}")
    if chosen.json_out:
        chosen.json_out.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
