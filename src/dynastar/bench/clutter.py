"""The controller ``printed`` over clutter: arrivals and contacts by how much of the map is occupied."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import count, islice
from pathlib import Path
from typing import Any

from dynastar.bench import paper
from dynastar.bench.arms import SOURCES, Arm, run_mission
from dynastar.bench.controllers.printed import Printed, PrintedReplanning
from dynastar.bench.pairs import interval_in_words, totals
from dynastar.bench.rows import collect
from dynastar.bench.tables import Cell, Table
from dynastar.bench.versions import version
from dynastar.simulation import Scenario

WORLDS = 50  # for each line of the table, unless another number is asked for
OCCUPIED = (0.0, 0.05, 0.1, paper.OCCUPIED)
READINGS = {
    "as printed": Arm(controller=Printed),
    "replanning, target at 1 m": Arm(controller=PrintedReplanning),
}

Row = dict[str, Any]


def run(
    worlds: int, seed: int, folder: Path, workers: int = 1, progress: bool = False
) -> list[Row]:
    """A row for both readings in each of the first worlds of every density that have a way.

    They are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [
        (occupied, number, reading)
        for occupied in OCCUPIED
        for number in _numbers(occupied, worlds, seed)
        for reading in READINGS
    ]
    run_of = {"table": "clutter", "seed": seed, "version": version("clutter", *SOURCES)}
    work = partial(_row, seed=seed)
    return collect("clutter", work, jobs, folder / "clutter.jsonl", run_of, workers, progress)


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """For each density and reading, the totals of its missions (``pairs.totals``)."""
    found: dict[tuple[float, str], dict[int, Row]] = {}
    for row in rows:
        found.setdefault((row["occupied"], row["reading"]), {})[row["number"]] = row
    return [
        {"occupied": occupied, "reading": reading, **totals(of)}
        for (occupied, reading), of in found.items()
    ]


def table(rows: Sequence[Row]) -> Table:
    """A line for each density and reading."""
    lines: list[tuple[Cell, ...]] = []
    for of in summary(rows):
        counts = (
            (of[what], interval_in_words(of[f"{what}_interval"], 100.0, ".0f"))
            for what in ("arrived", "contacts_moving", "contacts_resting")
        )
        lines.append(
            (
                f"{100.0 * of['occupied']:.0f} % occupied",
                of["reading"],
                of["missions"],
                *(cell for pair in counts for cell in pair),
                of["timeouts"] + of["blocked"] + of["errors"],
            )
        )
    return Table(
        "clutter",
        "The controller printed over clutter",
        (
            ("", ""),
            ("reading", "<"),
            ("worlds", "d"),
            ("arrived", "d"),
            ("95 %, %", ""),
            ("hit moving", "d"),
            ("95 %, %", ""),
            ("at rest", "d"),
            ("95 %, %", ""),
            ("late, blocked", "d"),
        ),
        lines,
        "Worlds of the suite paper with so many of the map's cells occupied, the suite's own at "
        f"{100.0 * paper.OCCUPIED:.0f} %. Without occupied cells all of them are one world. Intervals "
        "are Wilson's.",
    )


def _numbers(occupied: float, worlds: int, seed: int) -> list[int]:
    """The first worlds that the suite's rule does not leave out; one where all are the same."""
    kept = (n for n in count() if isinstance(paper.world(seed, n, occupied), Scenario))
    return list(islice(kept, worlds if occupied else 1))


def _row(job: tuple[float, int, str], seed: int) -> Row:
    occupied, number, reading = job
    made = paper.world(seed, number, occupied)
    assert isinstance(made, Scenario)
    driven = run_mission(replace(made, seed=seed), READINGS[reading])
    return {"occupied": occupied, "number": number, "reading": reading, **driven}
