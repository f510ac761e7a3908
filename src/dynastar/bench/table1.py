"""Table I: traditional against improved A*, expanded cells, path length and time, over many maps."""

import hashlib
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import dynastar
from dynastar.bench.families import KINDS, Map, draw
from dynastar.bench.rows import collect
from dynastar.bench.tables import spread_of
from dynastar.planning import HeuristicConfig, SearchGrid, SearchResult, smooth, straighten

ROUNDS = 5  # each arm's best time of so many, in turns
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


def _total_time(row: Row) -> float:
    both = row["improved"]["seconds"] + row["improved, fast"]["seconds"]
    return float(both / row["traditional"]["seconds"])


# What a map's row says, as ratios; "length" is of the path smoothed at any angle.
RATIOS: dict[str, Callable[[Row], float]] = {
    "expanded_ratio": _over("improved", "traditional", "expanded"),
    "expanded_ratio_octile": _over("improved", "traditional, octile", "expanded"),
    "expanded_ratio_weighted": _over("weighted, w = 2", "traditional", "expanded"),
    "search_time_ratio": _over("improved", "traditional", "seconds"),
    "total_time_ratio": _total_time,
    "grid_length_ratio": _over("improved", "traditional", "length"),
    "length_ratio": _over("improved, any angle", "traditional", "length"),
    "length_ratio_fast": _over("improved, fast", "traditional", "length"),
    "length_ratio_same_smoothing": _over("improved, fast", "traditional, smoothed", "length"),
    "any_angle_ratio": _over("improved, any angle", "optimum", "length"),
    "fast_ratio": _over("improved, fast", "optimum", "length"),
}


def run(
    maps: int, seed: int, folder: Path, workers: int = 1, size: int = 40, progress: bool = False
) -> list[Row]:
    """The rows of so many maps or up to three more, as many of each kind.

    They are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [job for kind in KINDS for job in _numbers(kind, -(-maps // len(KINDS)), seed, size)]
    settings = {"table": 1, "seed": seed, "size": size, "version": _version()}
    work = partial(_row, seed=seed, size=size)
    return collect("table1", work, jobs, folder / "table1.jsonl", settings, workers, progress)


def summary(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, float]]]:
    """For ``all`` and for each kind of map, each ratio's median, mean, 95th percentile and worst."""
    found = {}
    for kind in ("all", *KINDS):
        chosen = [row for row in rows if kind in (row["kind"], "all")]
        if chosen:
            found[kind] = {
                name: spread_of([ratio(row) for row in chosen]) for name, ratio in RATIOS.items()
            }
    return found


def _numbers(kind: str, count: int, seed: int, size: int) -> list[tuple[str, int]]:
    """The first maps of a kind that have a way."""
    found: list[tuple[str, int]] = []
    number = 0
    while len(found) < count:
        if draw(kind, number, seed, size) is not None:
            found.append((kind, number))
        number += 1
    return found


def _version() -> str:
    """A digest of all sources, for any of them may change what comes out."""
    digest = hashlib.sha256()
    for source in sorted(Path(dynastar.__file__).parent.rglob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _row(job: tuple[str, int], seed: int, size: int) -> Row:
    drawn = draw(*job, seed, size)
    assert drawn is not None
    return measure(drawn)


def measure(drawn: Map) -> dict[str, Any]:
    """One map's row: by arm the cells expanded, the length in cells, and the seconds it took.

    The smoothed arms' seconds are those of the smoothing alone; any angle begins from the fast one,
    whose time is in its own. ``optimum`` is the shortest path over all straight lines between cells'
    centres that stay free; a smoothed one, which may leave the centres, can be shorter.
    """
    grid = SearchGrid(drawn.occupied)
    row: dict[str, Any] = {"kind": drawn.kind, "number": drawn.number}
    found: dict[str, SearchResult] = {}
    searches: dict[str, Callable[[], SearchResult]] = {
        name: partial(grid.search, drawn.start, drawn.goal, algorithm, terms)
        for name, (algorithm, terms) in SEARCHES.items()
    }
    for name, (result, seconds) in _timed(searches).items():
        found[name] = result
        row[name] = {"expanded": result.expanded, "length": result.cost, "seconds": seconds}
    ways = {name: result.cells + 0.5 for name, result in found.items()}
    fast = partial(smooth, drawn.occupied, radius=0.0)
    smoothings: dict[str, Callable[[], Any]] = {
        "traditional, smoothed": partial(fast, ways["traditional"]),
        "improved, fast": partial(fast, ways["improved"]),
        "improved, any angle": lambda: straighten(
            drawn.occupied, ways["improved"], 0.0, fast(ways["improved"])
        ),
    }
    lines = _timed(smoothings)
    for name, (line, seconds) in lines.items():
        row[name] = {"length": _length(line), "seconds": seconds}
    near = straighten(drawn.occupied, ways["improved"], 0.0)  # over centres alone
    everywhere = straighten(drawn.occupied, ways["improved"], 0.0, near, reach=grid.rows)
    row["optimum"] = {"length": _length(everywhere)}
    return row


def _timed(arms: dict[str, Callable[[], Any]]) -> dict[str, tuple[Any, float]]:
    best: dict[str, tuple[Any, float]] = {}
    for _ in range(ROUNDS):
        for name, run in arms.items():
            began = time.perf_counter()
            result = run()
            seconds = time.perf_counter() - began
            best[name] = result, min(seconds, best.get(name, (None, np.inf))[1])
    return best


def _length(line: Any) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())
