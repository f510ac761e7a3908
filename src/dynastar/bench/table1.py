"""Table I: traditional against improved A*, expanded cells, path length and time, over many maps."""

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench.families import KINDS, Map, draw
from dynastar.bench.optimum import shortest_over_centres, shortest_over_corners
from dynastar.bench.own_maps import own_forty
from dynastar.bench.rows import collect
from dynastar.bench.tables import spread_of
from dynastar.bench.versions import code_version
from dynastar.planning import HeuristicConfig, SearchGrid, SearchResult, smooth, straighten

SIZE, LARGE = 40, 512  # cells a side
FEWER = 10  # times fewer maps of the large size
ROUNDS, ENOUGH = 5, 0.02  # each arm's best time of so many, in turns, and of more up to so many s
PLAIN = HeuristicConfig(weight=1.0)

# The searches of Table I, all on the improved one's kernel.
SEARCHES = {
    "traditional": ("weighted", PLAIN._replace(estimate="euclidean")),
    "traditional, octile": ("weighted", PLAIN),
    "weighted, w = 2": ("weighted", HeuristicConfig(weight=2.0)),
    "improved": ("improved", HeuristicConfig()),
}

Row = dict[str, Any]


def _over(arm: str, other: str, what: str) -> Callable[[Row], float]:
    return lambda row: float(row[arm][what]) / float(row[other][what])


def _total_time(smoothed: str) -> Callable[[Row], float]:
    """Search and smoothing over the traditional search."""
    return lambda row: float(
        (row["improved"]["seconds"] + row[smoothed]["seconds"]) / row["traditional"]["seconds"]
    )


# What a map's row says, as ratios; "length" is of the path smoothed at any angle.
RATIOS: dict[str, Callable[[Row], float]] = {
    "expanded_ratio": _over("improved", "traditional", "expanded"),
    "expanded_ratio_octile": _over("improved", "traditional, octile", "expanded"),
    "expanded_ratio_weighted": _over("weighted, w = 2", "traditional", "expanded"),
    "search_time_ratio": _over("improved", "traditional", "seconds"),
    "search_time_ratio_weighted": _over("weighted, w = 2", "traditional", "seconds"),
    "total_time_ratio": _total_time("improved, fast"),
    "total_time_ratio_any_angle": _total_time("improved, any angle"),
    "grid_length_ratio": _over("improved", "traditional", "length"),
    "length_ratio": _over("improved, any angle", "traditional", "length"),
    "length_ratio_fast": _over("improved, fast", "traditional", "length"),
    "length_ratio_fast_weighted": _over("weighted, smoothed", "traditional", "length"),
    "length_ratio_same_smoothing": _over("improved, fast", "traditional, smoothed", "length"),
    "any_angle_ratio": _over("improved, any angle", "optimum", "length"),
    "fast_ratio": _over("improved, fast", "optimum", "length"),
    "fast_ratio_any_point": _over("improved, fast", "optimum, any point", "length"),
}


def run(
    maps: int, seed: int, folder: Path, workers: int = 1, size: int = SIZE, progress: bool = False
) -> list[Row]:
    """The rows of so many maps or up to three more, as many of each kind.

    They are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    each = -(-maps // len(KINDS))
    jobs = [(kind, number) for kind in KINDS for number in numbers(kind, each, seed, size)]
    name = "table1" if size == SIZE else f"table1-{size}"
    settings = {"table": 1, "seed": seed, "size": size, "version": code_version()}
    work = partial(_row, seed=seed, size=size)
    return collect(name, work, jobs, folder / f"{name}.jsonl", settings, workers, progress)


def own_row() -> Row:
    """The row of the project's own map."""
    return measure(own_forty())


def summary(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, float]]]:
    """For ``all`` and for each kind of map, each ratio's median, mean, 95th percentile and worst.

    Ratios of what was not worked out are left out.
    """
    found = {}
    for kind in ("all", *KINDS):
        chosen = [row for row in rows if kind in (row["kind"], "all")]
        if chosen:
            found[kind] = {name: spread_of(values) for name, values in ratios(chosen).items()}
    return found


def ratios(rows: Sequence[Row]) -> dict[str, list[float]]:
    """Each ratio's value on every map."""
    found = {}
    for name, ratio in RATIOS.items():
        try:
            found[name] = [ratio(row) for row in rows]
        except KeyError:  # left out
            continue
    return found


def measure(drawn: Map, slow: bool = True) -> Row:
    """One map's row: by arm the cells expanded, the length in cells, and the seconds it took.

    The smoothed arms' seconds are those of the smoothing alone; any angle begins from the fast one,
    whose time is in its own. ``optimum`` is the shortest path over all straight lines between cells'
    centres that stay free, and there is that over any points whatever. What looks at pairs of cells,
    any angle and the optima, is left out if not ``slow``: their time grows with the map's square.
    """
    grid = SearchGrid(drawn.occupied)
    row: Row = {"kind": drawn.kind, "number": drawn.number}
    found: dict[str, SearchResult] = {}
    searches: dict[str, Callable[[], SearchResult]] = {
        name: partial(searched, grid, drawn, algorithm, terms)
        for name, (algorithm, terms) in SEARCHES.items()
    }
    for name, (result, seconds) in timed(searches).items():
        found[name] = result
        row[name] = {"expanded": result.expanded, "length": result.cost, "seconds": seconds}
    ways = {name: result.cells.astype(np.float64) + 0.5 for name, result in found.items()}
    fast = partial(smooth, drawn.occupied, radius=0.0)
    smoothings: dict[str, Callable[[], Any]] = {
        "traditional, smoothed": partial(fast, ways["traditional"]),
        "weighted, smoothed": partial(fast, ways["weighted, w = 2"]),
        "improved, fast": partial(fast, ways["improved"]),
    }
    smoothed = timed(smoothings)
    if slow:
        way = ways["improved"]
        smoothed |= timed(
            {"improved, any angle": lambda: straighten(drawn.occupied, way, 0.0, fast(way))}
        )
    for name, (line, seconds) in smoothed.items():
        row[name] = {"length": _length(line), "seconds": seconds}
    if slow:
        row["optimum"] = {"length": _length(shortest_over_centres(drawn.occupied, way))}
        row["optimum, any point"] = {"length": _length(shortest_over_corners(drawn.occupied, way))}
    return row


def searched(grid: SearchGrid, drawn: Map, algorithm: str, terms: HeuristicConfig) -> SearchResult:
    """A search on a map that is new to it: what only e^(P/Q) needs is counted anew."""
    grid.recount()
    return grid.search(drawn.start, drawn.goal, algorithm, terms)


def timed(arms: Mapping[str, Callable[[], Any]]) -> dict[str, tuple[Any, float]]:
    """Each arm's result and its best time (s) of some rounds, in which the arms take turns."""
    best: dict[str, tuple[Any, float]] = {}
    spent, rounds = 0.0, 0
    while rounds < ROUNDS or spent < ENOUGH:
        for name, run in arms.items():
            began = time.perf_counter()
            result = run()
            seconds = time.perf_counter() - began
            best[name] = result, min(seconds, best.get(name, (None, np.inf))[1])
            spent += seconds
        rounds += 1
    return best


def _length(line: Any) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def numbers(kind: str, some: int, seed: int, size: int) -> list[int]:
    """The first maps of a kind that have a way."""
    return list(islice((n for n in count() if draw(kind, n, seed, size) is not None), some))


def _row(job: tuple[str, int], seed: int, size: int) -> Row:
    drawn = draw(*job, seed, size)
    assert drawn is not None
    return measure(drawn, slow=size == SIZE)
