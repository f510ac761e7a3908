"""Arrivals and contacts by how much of the map is occupied, and by how fast the walker is."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import count, islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench import paper, table3
from dynastar.bench.arms import Arm, run_mission
from dynastar.bench.controllers.printed import Printed, PrintedReplanning
from dynastar.bench.pairs import interval_in_words, totals
from dynastar.bench.rows import collect
from dynastar.bench.tables import Cell, Table
from dynastar.bench.versions import code_version
from dynastar.simulation import Mover, Scenario

WORLDS = 50  # for each line of the tables, unless another number is asked for
OCCUPIED = (0.0, 0.05, 0.1, paper.OCCUPIED, 0.3)
SPEEDS = (0.25, paper.MOVER_SPEED, 1.0, 1.5)  # m/s
DRIVERS = {
    "printed": Arm(controller=Printed),
    "printed, replanning, target at 1 m": Arm(controller=PrintedReplanning),
    "default": Arm(),
}

Row = dict[str, Any]


class Kind(NamedTuple):
    """What is driven in a kind of world: the fraction of occupied cells, the walker's speed (m/s)."""

    occupied: float
    speed: float
    driver: str


BY_DENSITY = [Kind(occupied, paper.MOVER_SPEED, name) for occupied in OCCUPIED for name in DRIVERS]
BY_SPEED = [Kind(paper.OCCUPIED, speed, "default") for speed in SPEEDS]


def run(
    worlds: int, seed: int, folder: Path, workers: int = 1, progress: bool = False
) -> list[Row]:
    """A row for each kind in each of the first worlds of its density that have a way.

    They are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    kinds = list(dict.fromkeys([*BY_DENSITY, *BY_SPEED]))
    numbers = {occupied: _numbers(occupied, worlds, seed) for occupied in OCCUPIED}
    jobs = [(*kind, number) for kind in kinds for number in numbers[kind.occupied]]
    run_of = {"table": "clutter", "seed": seed, "version": code_version()}
    work = partial(_row, seed=seed)
    return collect("clutter", work, jobs, folder / "clutter.jsonl", run_of, workers, progress)


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """For each kind, the totals of its missions (``pairs.totals``)."""
    found: dict[Kind, dict[int, Row]] = {}
    for row in rows:
        kind = Kind(*(row[what] for what in Kind._fields))
        found.setdefault(kind, {})[row["number"]] = row
    return [
        {
            **kind._asdict(),
            "grid_turning_points": float(
                np.median([row["grid_turning_points"] for row in of.values()])
            ),
            **totals(of),
        }
        for kind, of in found.items()
    ]


def tables(rows: Sequence[Row]) -> list[Table]:
    """A line for each density and what drives there; one for each speed of the walker."""
    here = f"The suite's own are {100.0 * paper.OCCUPIED:.0f} % and {paper.MOVER_SPEED:g} m/s."
    means = (
        "Turns are those of the improved A*'s grid path on the map, the median; the paper's figure has 7. "
        "Mean times are over the worlds in which it arrived."
    )
    notes = f"Worlds of the suite paper. {here} {means} Intervals are Wilson's."
    return [
        _table(
            "clutter",
            "Over clutter",
            [of for of in summary(rows) if of["speed"] == paper.MOVER_SPEED],
            lambda of: f"{100.0 * of['occupied']:.0f} % occupied",
            f"{notes} Without occupied cells all worlds are one. The worlds are the first that are "
            f"possible; left out before the last of them were {_worlds_left_out(rows)}.",
        ),
        _table(
            "walker",
            "Over the walker's speed",
            [
                of
                for of in summary(rows)
                if of["occupied"] == paper.OCCUPIED and of["driver"] == "default"
            ],
            lambda of: f"{of['speed']:g} m/s",
            notes,
        ),
    ]


def _worlds_left_out(rows: Sequence[Row]) -> str:
    """A note on the worlds without a way for the robot: "3 of 53 with 10 % occupied, ..."."""
    numbers: dict[float, set[int]] = {}
    for row in rows:
        numbers.setdefault(row["occupied"], set()).add(row["number"])
    return ", ".join(
        f"{max(of) + 1 - len(of)} of {max(of) + 1} with {100.0 * occupied:.0f} % occupied"
        for occupied, of in sorted(numbers.items())
    )


def _table(
    name: str,
    title: str,
    found: Sequence[dict[str, Any]],
    label: Callable[[dict[str, Any]], str],
    notes: str,
) -> Table:
    lines: list[tuple[Cell, ...]] = []
    for of in sorted(found, key=lambda of: (of["occupied"], of["speed"])):
        counts = (
            (of[what], interval_in_words(of[f"{what}_interval"], 100.0, ".0f"))
            for what in ("arrived", "contacts_moving", "contacts_resting")
        )
        late = of["timeouts"] + of["blocked"] + of["errors"]
        pairs = (cell for pair in counts for cell in pair)
        turns = of["grid_turning_points"]
        lines.append(
            (label(of), of["driver"], of["missions"], turns, *pairs, late, of["mean_time"])
        )
    return Table(
        name,
        title,
        (
            ("", ""),
            ("drives", "<"),
            ("worlds", "d"),
            ("turns", ".0f"),
            ("arrived", "d"),
            ("95 %, %", ""),
            ("hit moving", "d"),
            ("95 %, %", ""),
            ("at rest", "d"),
            ("95 %, %", ""),
            ("late, blocked", "d"),
            ("mean s", ".1f"),
        ),
        lines,
        notes,
    )


def with_speed(scenario: Scenario, speed: float) -> Scenario:
    """The scenario with walkers who walk their ways at ``speed`` (m/s)."""
    slower = paper.MOVER_SPEED / speed
    movers = (Mover(m.radius, slower * m.times, m.points, m.after) for m in scenario.movers)
    return replace(scenario, movers=tuple(movers))


def _numbers(occupied: float, worlds: int, seed: int) -> list[int]:
    """The first worlds that the suite's rule does not leave out; one where all are the same."""
    kept = (n for n in count() if isinstance(paper.world(seed, n, occupied), Scenario))
    return list(islice(kept, worlds if occupied else 1))


def _row(job: tuple[float, float, str, int], seed: int) -> Row:
    occupied, speed, driver, number = job
    of = Kind(occupied, speed, driver)
    made = paper.world(seed, number, of.occupied)
    assert isinstance(made, Scenario)
    driven = run_mission(replace(with_speed(made, of.speed), seed=seed), DRIVERS[of.driver])
    way = table3.grid_way(made)["grid_turning_points"]
    return {**of._asdict(), "number": number, "grid_turning_points": way, **driven}
