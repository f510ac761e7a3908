"""All suites at once: one pool of processes, one table, one JSON, one picture."""

import time
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar.bench.missions import Options
from dynastar.bench.runner import Job, jobs_of, result_of, run_jobs
from dynastar.bench.statistics import bootstrap
from dynastar.bench.suites import SUITES, load_suite
from dynastar.bench.tables import Cell, Table
from dynastar.errors import InputError
from dynastar.viewer.intervals import Estimate, Measure, draw_intervals

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_GROUPS = 12  # lines of a suite's groups in the table

Result = Mapping[str, Any]


def run_all(options: Options, progress: bool = False, keep: Path | None = None) -> dict[str, Any]:
    """Runs every suite whose data and extras are here; ``left_out`` says why another was not.

    Finished rows are kept in ``keep``, and a run that was cut off goes on from there. Raises InputError
    if no suite can be run.
    """
    began = time.perf_counter()
    planned: dict[str, tuple[list[Job], int]] = {}
    left_out: dict[str, str] = {}
    for name in SUITES:
        try:
            planned[name] = jobs_of(name, load_suite(name), options)
        except InputError as error:
            left_out[name] = str(error)
    if not planned:
        raise InputError(f"no suite can be run: {'; '.join(left_out.values())}")
    jobs = _in_turn([jobs for jobs, _ in planned.values()])
    rows, walls = run_jobs("all", jobs, options, progress, keep)
    of_suite: dict[str, list[tuple[dict[str, Any], float]]] = {name: [] for name in planned}
    for job, row, wall in zip(jobs, rows, walls, strict=True):
        of_suite[job.key[0]].append((row, wall))
    suites = {
        name: result_of(
            name,
            load_suite(name),
            options,
            [row for row, _ in of_suite[name]],
            skipped,
            sum(wall for _, wall in of_suite[name]),
        )
        for name, (_, skipped) in planned.items()
    }
    return {
        "quick": options.quick,
        "seed": options.seed,
        "wall_s": round(time.perf_counter() - began, 1),
        "left_out": left_out,
        "suites": suites,
    }


def _in_turn(lists: Sequence[Sequence[Job]]) -> list[Job]:
    """A job of each suite in turn, so that what takes long is not left for the end."""
    return [job for turn in zip_longest(*lists) for job in turn if job is not None]


def table(result: Result) -> Table:
    """A line for each suite, and for each of its groups."""
    lines: list[tuple[Cell, ...]] = []
    for name, suite in result["suites"].items():
        lines.append(_line(name, suite))
        groups = suite["groups"]
        if 1 < len(groups) <= MOST_GROUPS:
            lines += [_line(f"  {group}", of) for group, of in groups.items()]
    left = "".join(f"\n{name} was left out: {why}" for name, why in result["left_out"].items())
    return Table(
        "scoreboard",
        "All suites" + (", quick" if result["quick"] else ""),
        (
            ("", ""),
            ("missions", "d"),
            ("succeeded", "d"),
            ("95 %", ""),
            ("moving", "d"),
            ("resting", "d"),
            ("bumps", "d"),
            ("stops", "d"),
            ("timeouts", "d"),
            ("score", ".3f"),
            ("time ratio", ".2f"),
            ("tick ms", ".1f"),
            ("p99 ms", ".1f"),
            ("wall s", ".0f"),
        ),
        lines,
        "Succeeded: arrived, or rightly said that there is no way, without contact; with Wilson's interval "
        "in per cent. Moving, resting: contacts by the robot's motion. Bumps: touches by walkers while the "
        "robot did not move towards them; stops: walkers who stopped for it; both end no mission. Time "
        "ratio: mean over arrivals of the time over the time bound. Ticks: medians over the missions."
        + left,
    )


def _line(name: str, of: Result) -> tuple[Cell, ...]:
    low, high = of["succeeded_interval"] or (0.0, 1.0)
    return (
        name,
        of["missions"],
        of["succeeded"],
        f"{100 * low:.0f}-{100 * high:.0f}",
        of["contacts_moving"],
        of["contacts_resting"],
        of["bumps"] or None,
        of["stops"] or None,
        of["timeouts"],
        *(of[key] for key in ("score", "time_ratio", "tick_ms_median", "tick_ms_p99")),
        of.get("wall_s"),
    )


def picture(result: Result) -> "Figure":
    """Successes, contacts and time ratios of the suites, with 95 % intervals."""
    suites = result["suites"]
    return draw_intervals(
        [
            Measure("succeeded, %", {"": _fractions(suites, "succeeded")}, (0.0, 100.0)),
            Measure(
                "contacts, %",
                {
                    "moving": _fractions(suites, "contacts_moving"),
                    "at rest": _fractions(suites, "contacts_resting"),
                },
            ),
            Measure("time / time bound", {"": _ratios(suites)}),
        ],
        list(suites),
    )


def _fractions(suites: Mapping[str, Result], key: str) -> dict[str, Estimate]:
    found: dict[str, Estimate] = {}
    for name, suite in suites.items():
        if suite["missions"]:
            low, high = suite[f"{key}_interval"]
            found[name] = (100.0 * suite[key] / suite["missions"], 100.0 * low, 100.0 * high)
    return found


def _ratios(suites: Mapping[str, Result]) -> dict[str, Estimate]:
    found: dict[str, Estimate] = {}
    for name, suite in suites.items():
        if suite["time_ratio"] is not None:
            arrived = (row for row in suite["rows"] if row["outcome"] == "arrived")
            interval = bootstrap([row["time_ratio"] for row in arrived if row.get("time_ratio")])
            found[name] = (suite["time_ratio"], *(interval or (None, None)))
    return found
