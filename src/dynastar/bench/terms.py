"""The terms of Eq. 2 on maps: how many cells each arm expands, for how long a way, in what time."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from dynastar.bench.arms import PLAIN, TERMS
from dynastar.bench.families import KINDS, Map, draw
from dynastar.bench.pairs import median_in_words
from dynastar.bench.rows import collect
from dynastar.bench.table1 import numbers, searched, timed
from dynastar.bench.tables import Cell, Table, spread_of
from dynastar.bench.versions import code_version
from dynastar.planning import HeuristicConfig, SearchGrid

BASE = "Euclidean A*"  # the traditional one, which the others are compared with

ARMS: dict[str, tuple[str, HeuristicConfig]] = {
    BASE: ("weighted", PLAIN._replace(estimate="euclidean")),
    "octile A*": ("weighted", PLAIN),
    "weighted A*, w = 2": ("weighted", PLAIN._replace(weight=2.0)),
    **{name: terms for name, terms in TERMS.items() if terms[1] != PLAIN},
}
MEASURED = ("expanded", "length", "seconds")

Row = dict[str, Any]


def run(
    maps: int, seed: int, folder: Path, workers: int = 1, size: int = 40, progress: bool = False
) -> list[Row]:
    """The rows of so many maps or up to three more, as many of each kind.

    They are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    each = -(-maps // len(KINDS))
    jobs = [(kind, number) for kind in KINDS for number in numbers(kind, each, seed, size)]
    settings = {"table": "terms", "seed": seed, "size": size, "version": code_version()}
    work = partial(_row, seed=seed, size=size)
    return collect("terms", work, jobs, folder / "terms.jsonl", settings, workers, progress)


def measure(drawn: Map) -> Row:
    """One map's row: by arm the cells expanded, the length in cells, and the seconds it took."""
    grid = SearchGrid(drawn.occupied)
    row: Row = {"kind": drawn.kind, "number": drawn.number}
    searches = {
        arm: partial(searched, grid, drawn, algorithm, terms)
        for arm, (algorithm, terms) in ARMS.items()
    }
    for arm, (found, seconds) in timed(searches).items():
        row[arm] = dict(zip(MEASURED, (found.expanded, found.cost, seconds), strict=True))
    return row


def summary(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, float]]]:
    """By arm, the ratios to the traditional A*: median, mean, 95th percentile and worst of each."""
    return {
        arm: {
            f"{what}_ratio": spread_of([row[arm][what] / row[BASE][what] for row in rows])
            for what in MEASURED
        }
        for arm in ARMS
    }


def tables(rows: Sequence[Row]) -> list[Table]:
    """Cells and time by kind of map, then all maps together; a line for each arm."""
    cells = _by_kind(rows, "expanded", "terms-cells", "Cells expanded")
    seconds = _by_kind(rows, "seconds", "terms-time", "Time of the search")
    return [cells, seconds, _pool(rows)]


def _by_kind(rows: Sequence[Row], what: str, name: str, title: str) -> Table:
    lines: list[tuple[Cell, ...]] = []
    for arm in ARMS:
        of = {kind: [row for row in rows if row["kind"] == kind] for kind in KINDS}
        ratios = [[row[arm][what] / row[BASE][what] for row in of[kind]] for kind in KINDS]
        lines.append((arm, *map(median_in_words, ratios)))
    return Table(
        name,
        f"{title} by kind of map, over the traditional A*: median and bootstrap interval",
        (("", ""), *((kind, ">") for kind in KINDS)),
        lines,
        f"{len(rows) // len(KINDS)} maps of each kind.",
    )


def _pool(rows: Sequence[Row]) -> Table:
    shown = ("median", "mean", "worst")
    lines: list[tuple[Cell, ...]] = [
        (arm, *(ratios[f"{what}_ratio"][name] for what in MEASURED for name in shown))
        for arm, ratios in summary(rows).items()
    ]
    headings = [f"{what}, {name}" for what in ("cells", "length", "time") for name in shown]
    return Table(
        "terms",
        f"The terms of Eq. 2 on {len(rows)} maps, over the traditional A*",
        (("", ""), *((heading, ".3f") for heading in headings)),
        lines,
        "Cells expanded, length of the grid path and time of the search, on one kernel.",
    )


def _row(job: tuple[str, int], seed: int, size: int) -> Row:
    drawn = draw(*job, seed, size)
    assert drawn is not None
    return measure(drawn)
