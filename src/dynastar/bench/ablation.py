"""The ablation: worlds driven with one thing left out or read differently at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench.arms import ARMS, BASE, NOT_EXACT, run_mission
from dynastar.bench.missions import Mission, Options
from dynastar.bench.pairs import beside, correct, interval_in_words, p_in_words, totals
from dynastar.bench.rows import collect
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import load_suite
from dynastar.bench.tables import Cell, Table
from dynastar.bench.versions import code_version
from dynastar.simulation import Scenario

WORLDS = 100  # of each suite, unless another number is asked for
SUITES = ("paper", "people")

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
    run_of = {"table": "ablation", "seed": seed, "version": code_version()}
    run_of |= {"settings": settings} if settings else {}
    work = partial(_row, seed=seed, settings=settings)
    return collect("ablation", work, jobs, folder / "ablation.jsonl", run_of, workers, progress)


def summary(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, Any]]]:
    """By suite and arm, what became of its missions, and how it compares with its base.

    The keys are those of ``pairs.totals`` and, where there are rows of the base, of
    ``pairs.beside``; ``p_holm`` is corrected over all arms of a suite.
    """
    found: dict[str, dict[str, dict[int, Row]]] = {}
    for row in rows:
        found.setdefault(row["suite"], {}).setdefault(row["arm"], {})[row["number"]] = row
    return {suite: _summed(arms) for suite, arms in found.items()}


def _summed(driven: Mapping[str, Mapping[int, Row]]) -> dict[str, dict[str, Any]]:
    compared = {
        name: beside(driven[name], driven.get(arm.base, {}))
        for name, arm in ARMS.items()
        if name in driven
    }
    correct([found for name, found in compared.items() if name != BASE])
    return {name: totals(driven[name]) | found for name, found in compared.items()}


def by_effect(found: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """The arms, the default first, then by how many arrive (fewest first), and by time."""
    others = [arm for arm in found if arm != BASE]
    others.sort(key=lambda arm: (found[arm]["arrived"], -(found[arm]["time_ratio"] or np.inf)))
    return [BASE, *others] if BASE in found else others


def tables(rows: Sequence[Row]) -> list[Table]:
    """A table for each suite, one line for each arm, by its effect."""
    return [_table(suite, found) for suite, found in summary(rows).items()]


def _table(suite: str, found: Mapping[str, Mapping[str, Any]]) -> Table:
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
            ("late, blocked", "d"),
            ("lost", "d"),
            ("gained", "d"),
            ("p", ""),
            ("common", "d"),
            ("length ratio", ".3f"),
            ("95 %", ""),
            ("time ratio", ".3f"),
            ("95 %", ""),
        ),
        [_line(arm, found[arm]) for arm in by_effect(found)],
        "By effect: the arm that arrives in the fewest worlds first, of equal ones the slowest. Each arm "
        f"is compared with the {BASE} in the same worlds, those of Eq. 2 with *{NOT_EXACT}*: worlds in "
        "which only the base (lost) and only the arm (gained) arrived without contact; p is McNemar's "
        "exact test of these, corrected by Holm over all arms of the table; *inert* arms end every world "
        "as their base does, in the same time and length. The interval of arrivals is Wilson's; ratios "
        "are to the base's, means over the worlds in which both arrived (common), with bootstrap "
        "intervals.",
    )


def _line(arm: str, of: Mapping[str, Any]) -> tuple[Cell, ...]:
    end = of["timeouts"] + of["blocked"] + of["errors"]
    alone = (
        arm,
        of["arrived"],
        interval_in_words(of["arrived_interval"], 100.0, ".0f"),
        of["contacts_moving"],
        of["contacts_resting"],
        end,
    )
    if arm == BASE:
        return (*alone, *[None] * 8)
    ratios = (
        (of[f"{what}_ratio"], interval_in_words(of[f"{what}_ratio_interval"], 1.0, ".2f"))
        for what in ("length", "time")
    )
    p = "inert" if of["inert"] else p_in_words(of["p_holm"])
    return (*alone, of["lost"], of["gained"], p, of["common"], *chain.from_iterable(ratios))


def _row(job: tuple[str, int, str], seed: int, settings: Mapping[str, Any] | None) -> Row:
    name, number, arm = job
    suite: Any = load_suite(name)
    made: Scenario = suite.scenario(Mission(number), Options(seed=seed), 0)
    made = replace(made, seed=made.seed + seed)
    return {"suite": name, "number": number, "arm": arm, **run_mission(made, ARMS[arm], settings)}
