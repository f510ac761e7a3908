"""The ablation: worlds driven with one thing left out or read differently at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench.arms import ARMS
from dynastar.bench.missions import Mission, Options, row_of
from dynastar.bench.rows import collect
from dynastar.bench.selection import choose_missions
from dynastar.bench.settings import merged
from dynastar.bench.statistics import bootstrap, wilson
from dynastar.bench.suites import load_suite
from dynastar.bench.tables import Cell, Table
from dynastar.bench.versions import version
from dynastar.metrics import measure
from dynastar.simulation import Scenario
from dynastar.simulation import run as drive

BASE = "default"  # the arm that the others are compared with
SUITES = ("paper", "people")
OF_ARMS = ("ablation", "arms", "follower", "paper", "own_maps", "controllers/printed",
           "controllers/base", "controllers/costmap", "controllers/route")  # fmt: skip
SOURCES = (*OF_ARMS, "driven", "suites/people", "suites/people_crowd", "suites/people_routes",
           "suites/people_scripts", "suites/people_sites", "suites/people_witness",
           "suites/people_witness_kernels", "suites/people_witness_search")  # fmt: skip

Row = dict[str, Any]


def run(
    missions: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    settings: Mapping[str, Any] | None = None,
) -> list[Row]:
    """A row for every arm in each of the first worlds of both suites that their rules keep.

    ``settings`` of the navigator are over those of the preset, but below those of an arm. The rows
    come world by world, are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    options = Options(missions=missions, seed=seed)
    jobs = [
        (name, mission.number, arm)
        for name in SUITES
        for mission in choose_missions(load_suite(name), options)[0]
        for arm in ARMS
    ]
    run_of = {"table": "ablation", "seed": seed, "version": version(*SOURCES)}
    run_of |= {"settings": settings} if settings else {}
    work = partial(_row, seed=seed, settings=settings)
    return collect("ablation", work, jobs, folder / "ablation.jsonl", run_of, workers, progress)


def run_mission(scenario: Scenario, arm: str, settings: Mapping[str, Any] | None = None) -> Row:
    """Drives a world the way of an arm and returns its metrics; "error" if that raises."""
    preset, of_arm, controller = ARMS[arm]
    navigator = merged(merged(scenario.navigator, settings or {}), of_arm)
    driven = replace(scenario, preset=preset, navigator=navigator)
    return row_of(lambda: measure(drive(driven, navigator=controller))._asdict())


def summary(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, Any]]]:
    """By suite and arm, what became of its missions, and how it compares with the default.

    ``arrived_interval`` and ``touched_interval`` are Wilson's, of the share of the missions.
    ``common`` counts the worlds that both the arm and the default arrived in; over these alone
    ``length_ratio`` and ``time_ratio`` are the means of the arm's over the default's, world by world,
    with the bootstrap's interval. None where there is nothing to average.
    """
    found: dict[str, dict[str, dict[int, Row]]] = {}
    for row in rows:
        found.setdefault(row["suite"], {}).setdefault(row["arm"], {})[row["number"]] = row
    return {
        suite: {arm: _summed(arms[arm], arms.get(BASE, {})) for arm in ARMS if arm in arms}
        for suite, arms in found.items()
    }


def _summed(driven: dict[int, Row], base: dict[int, Row]) -> dict[str, Any]:
    arrived = {number: row for number, row in driven.items() if row["outcome"] == "arrived"}
    common = [n for n in arrived if n in base and base[n]["outcome"] == "arrived"]
    moving, resting = (
        sum(bool(row.get(f"contacts_{kind}")) for row in driven.values())
        for kind in ("moving", "resting")
    )

    def mean(what: str) -> float | None:
        return float(np.mean([row[what] for row in arrived.values()])) if arrived else None

    ratios = {
        what: [arrived[n][what] / base[n][what] for n in common] for what in ("length", "time")
    }
    ends = {"timeouts": "timeout", "blocked": "blocked", "errors": "error"}
    return {
        "missions": len(driven),
        "arrived": len(arrived),
        "arrived_interval": wilson(len(arrived), len(driven)),
        "contacts_moving": moving,
        "contacts_resting": resting,
        "touched_interval": wilson(moving + resting, len(driven)),
        **{
            name: sum(row["outcome"] == outcome for row in driven.values())
            for name, outcome in ends.items()
        },
        "mean_length": mean("length"),
        "mean_time": mean("time"),
        "common": len(common),
        **{f"{what}_ratio": float(np.mean(of)) if of else None for what, of in ratios.items()},
        **{f"{what}_ratio_interval": bootstrap(of) for what, of in ratios.items()},
    }


def by_effect(found: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """The arms, the default first, then by how many arrive (fewest first), and by time."""
    others = [arm for arm in found if arm != BASE]
    others.sort(key=lambda arm: (found[arm]["arrived"], -(found[arm]["time_ratio"] or np.inf)))
    return [BASE, *others] if BASE in found else others


def tables(rows: Sequence[Row]) -> list[Table]:
    """A table for each suite, one line for each arm, by its effect."""
    return [_table(suite, found) for suite, found in summary(rows).items()]


def _table(suite: str, found: Mapping[str, Mapping[str, Any]]) -> Table:
    lines: list[tuple[Cell, ...]] = []
    for arm in by_effect(found):
        of = found[arm]
        lines.append(
            (
                arm,
                of["arrived"],
                _between(of["arrived_interval"], 100.0, ".0f"),
                of["contacts_moving"],
                of["contacts_resting"],
                _between(of["touched_interval"], 100.0, ".0f"),
                of["timeouts"] + of["blocked"] + of["errors"],
                of["common"],
                of["length_ratio"],
                _between(of["length_ratio_interval"], 1.0, ".2f"),
                of["time_ratio"],
                _between(of["time_ratio_interval"], 1.0, ".2f"),
            )
        )
    worlds = max(of["missions"] for of in found.values())
    return Table(
        f"ablation-{suite}",
        f"Ablation, {worlds} worlds of the suite {suite}",
        (
            ("", ""),
            ("arrived", "d"),
            ("95 %, %", ""),
            ("hit moving", "d"),
            ("at rest", "d"),
            ("95 %, %", ""),
            ("late, blocked", "d"),
            ("common", "d"),
            ("length ratio", ".3f"),
            ("95 %", ""),
            ("time ratio", ".3f"),
            ("95 %", ""),
        ),
        lines,
        "By effect: the arm that arrives in the fewest worlds first, of equal ones the slowest. The "
        "intervals of arrivals and contacts are Wilson's; ratios are to the default's in the same "
        "world, means over the worlds in which both arrived (common), with bootstrap intervals.",
    )


def _between(interval: tuple[float, float] | None, times: float, format_: str) -> str | None:
    if interval is None:
        return None
    low, high = (format(times * end, format_) for end in interval)
    return f"{low} to {high}"


def _row(job: tuple[str, int, str], seed: int, settings: Mapping[str, Any] | None) -> Row:
    name, number, arm = job
    suite: Any = load_suite(name)
    made: Scenario = suite.scenario(Mission(number), Options(seed=seed), 0)
    made = replace(made, seed=made.seed + seed)
    return {"suite": name, "number": number, "arm": arm, **run_mission(made, arm, settings)}
