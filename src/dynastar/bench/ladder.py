"""From print to robot: the controller ``printed`` made the default navigator, a change at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial, reduce
from pathlib import Path
from typing import Any

from dynastar.bench import paper
from dynastar.bench.arms import Arm, run_mission
from dynastar.bench.controllers.printed import Printed, PrintedReplanning
from dynastar.bench.controllers.printed_cost_to_go import PrintedCostToGo
from dynastar.bench.missions import Options
from dynastar.bench.pairs import beside, correct, interval_in_words, p_in_words, totals
from dynastar.bench.rows import collect
from dynastar.bench.selection import choose_missions
from dynastar.bench.settings import merged
from dynastar.bench.tables import Cell, Table
from dynastar.bench.versions import code_version
from dynastar.navigator import PRESETS
from dynastar.simulation import Scenario

WORLDS = 200  # unless another number is asked for

Row = dict[str, Any]
Found = dict[str, dict[str, Any]]

# What is added to the navigator, in this order, with the settings of the default that leave it out.
ADDED: dict[str, dict[str, Any]] = {
    "+ margins for declared errors": {"range_error": 0.0, "pose_error": 0.0, "drive_error": 0.0},
    "+ tracking, risk and nearness": {
        "tracker": {"widest": 0.1},  # m: the walker is wider, and so is seen as standing
        "dwa": {"weights": {"risk": 0.0, "nearness": 0.0}},
    },
    "+ window of 1 s": {"dwa": {"reach": 0.0}},
    "+ people out of unseen space: preset paper": {"hidden_speed": 0.0},
    "+ reverse": {"reverse": False},
    "+ weights of the default": {
        "dwa": {
            "weights": {
                name: getattr(PRESETS["paper"].dwa.weights, name)
                for name in ("heading", "dist", "vel", "simi")
            }
        }
    },
    "+ exact search: default": {"planner": {"exact": False}},
}


def _steps() -> dict[str, Arm]:
    """The steps: of the navigator's, each leaves out what only the later ones add."""
    left_out = list(ADDED.values())
    names = ("navigator, the least of it", *ADDED)
    return {
        "printed": Arm(controller=Printed),
        "printed, replanning, target at 1 m": Arm(controller=PrintedReplanning),
        "the same, cost-to-go for heading": Arm(controller=PrintedCostToGo),
        **{
            name: Arm(navigator=reduce(merged, left_out[number:], {}))
            for number, name in enumerate(names)
        },
    }


STEPS = _steps()


def run(
    worlds: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    settings: Mapping[str, Any] | None = None,
) -> list[Row]:
    """A row for every step in each of the first worlds of the suite ``paper``.

    ``settings`` of the navigator are over those of the preset, but below those of a step. The rows
    come world by world, are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    chosen, _ = choose_missions(paper, Options(missions=worlds, seed=seed))
    jobs = [(mission.number, step) for mission in chosen for step in STEPS]
    run_of = {"table": "ladder", "seed": seed, "version": code_version()}
    run_of |= {"settings": settings} if settings else {}
    work = partial(_row, seed=seed, settings=settings)
    return collect("ladder", work, jobs, folder / "ladder.jsonl", run_of, workers, progress)


def summary(rows: Sequence[Row]) -> Found:
    """By step, the totals of its missions, and how it compares with the step before.

    The keys are those of ``pairs.totals`` and ``pairs.beside``; the first step is compared with none.
    """
    driven: dict[str, dict[int, Row]] = {step: {} for step in STEPS}
    for row in rows:
        driven[row["step"]][row["number"]] = row
    before = [{}, *driven.values()]
    compared = [beside(of, base) for of, base in zip(driven.values(), before, strict=False)]
    correct(compared[1:])
    return {
        step: totals(of) | found for (step, of), found in zip(driven.items(), compared, strict=True)
    }


def outcomes(found: Found) -> dict[str, dict[str, float]]:
    """By how a mission ended and by step, the percentage of the worlds."""
    ends = {
        "arrived": ("arrived",),
        "hit moving": ("contacts_moving",),
        "hit at rest": ("contacts_resting",),
        "late, blocked": ("timeouts", "blocked", "errors"),
    }
    return {
        end: {
            step: 100.0 * sum(of[c] for c in counts) / of["missions"] for step, of in found.items()
        }
        for end, counts in ends.items()
    }


def table(found: Found) -> Table:
    """A line for each step."""
    worlds = max(of["missions"] for of in found.values())
    return Table(
        "ladder",
        f"From print to robot, {worlds} worlds of the suite paper",
        (
            ("", ""),
            ("arrived", "d"),
            ("95 %, %", ""),
            ("hit moving", "d"),
            ("at rest", "d"),
            ("late, blocked", "d"),
            ("mean s", ".1f"),
            ("mean m", ".1f"),
            ("lost", "d"),
            ("gained", "d"),
            ("p", ""),
        ),
        [_line(step, of) for step, of in found.items()],
        "Each line adds what it names to the line above. Time and length are means over the worlds in "
        "which that step arrived. Lost and gained: worlds in which only the line above, and only this "
        "one, arrived without contact; p is McNemar's exact test of these, corrected by Holm over all "
        "lines. The interval is Wilson's.",
    )


def _line(step: str, of: Mapping[str, Any]) -> tuple[Cell, ...]:
    return (
        step,
        of["arrived"],
        interval_in_words(of["arrived_interval"], 100.0, ".0f"),
        of["contacts_moving"],
        of["contacts_resting"],
        of["timeouts"] + of["blocked"] + of["errors"],
        of["mean_time"],
        of["mean_length"],
        *((of["lost"], of["gained"], p_in_words(of["p_holm"])) if "p_holm" in of else [None] * 3),
    )


def _row(job: tuple[int, str], seed: int, settings: Mapping[str, Any] | None) -> Row:
    number, step = job
    made = paper.world(seed, number)
    assert isinstance(made, Scenario)
    return {
        "number": number,
        "step": step,
        **run_mission(replace(made, seed=seed), STEPS[step], settings),
    }
