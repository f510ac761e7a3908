"""The ablation: the suite's worlds driven with one thing left out or read differently at a time."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench import paper
from dynastar.bench.arms import ARMS
from dynastar.bench.follower import Follower
from dynastar.bench.rows import collect, version
from dynastar.bench.runner import Options, choose_missions, row_of
from dynastar.bench.settings import merged
from dynastar.bench.tables import Cell, Table
from dynastar.metrics import measure
from dynastar.simulation import Scenario
from dynastar.simulation import run as drive

BASE = "default"  # the arm that the others are compared with

Row = dict[str, Any]


def run(
    missions: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    settings: Mapping[str, Any] | None = None,
) -> list[Row]:
    """A row for every arm on each of the suite's first worlds that its rule does not leave out.

    ``settings`` of the navigator are over those of the preset, but below those of an arm. The rows
    come world by world, are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    chosen, _ = choose_missions(paper, Options(missions=missions, seed=seed))
    jobs = [(mission.number, arm) for mission in chosen for arm in ARMS]
    modules = ("ablation", "arms", "follower", "paper")
    run_of = {"table": "ablation", "seed": seed, "version": version(*modules)}
    run_of |= {"settings": settings} if settings else {}
    work = partial(_row, seed=seed, settings=settings)
    return collect("ablation", work, jobs, folder / "ablation.jsonl", run_of, workers, progress)


def fly(
    scenario: Scenario, arm: str, seed: int = 0, settings: Mapping[str, Any] | None = None
) -> Row:
    """Drives a world the way of an arm and returns its metrics; "error" if that raises."""
    preset, of_arm, follows = ARMS[arm]
    navigator = merged(settings or {}, of_arm)
    flown = Scenario(**{**vars(scenario), "preset": preset, "navigator": navigator, "seed": seed})
    return row_of(lambda: measure(drive(flown, navigator=Follower if follows else None))._asdict())


def summary(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """By arm, what became of its missions, and means over those that arrived.

    ``common`` counts the worlds that both the arm and the default arrived in; over these alone
    ``length_ratio`` and ``time_ratio`` are the arm's mean over the default's, which is what can be
    compared. None where nothing arrived.
    """
    arms: dict[str, dict[int, Row]] = {arm: {} for arm in ARMS}
    for row in rows:
        arms[row["arm"]][row["number"]] = row
    return {arm: _summed(flown, arms[BASE]) for arm, flown in arms.items() if flown}


def _summed(flown: dict[int, Row], base: dict[int, Row]) -> dict[str, Any]:
    arrived = {number: row for number, row in flown.items() if row["outcome"] == "arrived"}
    common = [n for n in arrived if n in base and base[n]["outcome"] == "arrived"]

    def mean(of: dict[int, Row], numbers: Sequence[int], what: str) -> float | None:
        return float(np.mean([of[n][what] for n in numbers])) if numbers else None

    def ratio(what: str) -> float | None:
        mine, other = mean(arrived, common, what), mean(base, common, what)
        return mine / other if mine is not None and other else None

    ends = {"timeouts": "timeout", "blocked": "blocked", "errors": "error"}
    return {
        "missions": len(flown),
        "arrived": len(arrived),
        **{
            contacts: sum(bool(row.get(contacts)) for row in flown.values())
            for contacts in ("contacts_moving", "contacts_resting")
        },
        **{
            name: sum(row["outcome"] == outcome for row in flown.values())
            for name, outcome in ends.items()
        },
        "mean_length": mean(arrived, list(arrived), "length"),
        "mean_time": mean(arrived, list(arrived), "time"),
        "common": len(common),
        "length_ratio": ratio("length"),
        "time_ratio": ratio("time"),
    }


def tables(rows: Sequence[Row]) -> list[Table]:
    """One line for each arm."""
    found = summary(rows)
    counts = ("arrived", "contacts_moving", "contacts_resting", "timeouts", "blocked", "errors")
    means = ("mean_length", "mean_time", "length_ratio", "time_ratio")
    lines: list[tuple[Cell, ...]] = [
        (arm, *(of[name] for name in (*counts, *means))) for arm, of in found.items()
    ]
    worlds = len({row["number"] for row in rows})
    return [
        Table(
            "ablation",
            f"Ablation, {worlds} worlds of the suite paper",
            (
                ("", ""),
                *((name, "d") for name in ("arrived", "hit moving", "at rest", "late", "blocked")),
                ("errors", "d"),
                *((name, ".1f") for name in ("mean m", "mean s")),
                *((name, ".3f") for name in ("m / default's", "s / default's")),
            ),
            lines,
            "Means are over the missions that arrived; the last two columns are over the worlds in "
            "which both the arm and the default arrived. The default has of Eq. 2 the octile h(n), "
            "P / Q around n and k cos(beta); the arms named after Eq. 2 have all terms but as named.",
        )
    ]


def _row(job: tuple[int, str], seed: int, settings: Mapping[str, Any] | None) -> Row:
    number, arm = job
    made = paper.world(seed, number)
    assert isinstance(made, Scenario)
    return {"number": number, "arm": arm, **fly(made, arm, seed, settings)}
