"""All suites at once, by several controllers: one pool of processes, one JSON, one picture."""

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Options
from dynastar.bench.runner import Job, jobs_of, result_of, run_jobs
from dynastar.bench.statistics import bootstrap
from dynastar.bench.suites import SUITES, load_suite
from dynastar.errors import ConfigError, InputError
from dynastar.viewer.intervals import Estimate, Measure, draw_intervals

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COMPETITORS = ("pure_pursuit", "kompass_dwa", "orca", "printed")  # that drive beside the navigator
QUICK_COMPETITORS = COMPETITORS[:3]  # printed takes longer than all others together
QUICK_EVERY = 6  # of the quick missions, competitors drive one in so many

Result = Mapping[str, Any]
Planned = dict[
    tuple[str, str], tuple[list[Job], Counter[str]]
]  # by controller and suite: jobs, left out


def run_all(
    options: Options,
    progress: bool = False,
    keep: Path | None = None,
    others: Sequence[str] = (),
    every: int = 1,
) -> dict[str, Any]:
    """Runs every suite whose data and extras are here; ``left_out`` says why another was not.

    The controllers ``others`` drive in the same missions, or in one of ``every`` of them, in each suite
    that drives. Finished rows are kept in ``keep``, and a run that was cut off goes on from there. Raises
    InputError if no suite can be run.
    """
    began = time.perf_counter()
    planned, left_out = _planned(options, others, every)
    jobs = _in_turn([jobs for jobs, _ in planned.values()])
    rows, times = run_jobs("all", jobs, options, progress, keep)
    driven: dict[tuple[str, str], list[tuple[dict[str, Any], float]]] = {key: [] for key in planned}
    for job, row, cpu in zip(jobs, rows, times, strict=True):
        driven[job.controller, job.key[0]].append((row, cpu))
    found: dict[str, dict[str, Any]] = {}
    for (controller, name), (_, skipped) in planned.items():
        of = [row for row, _ in driven[controller, name]]
        seconds = {"cpu_s": sum(cpu for _, cpu in driven[controller, name])}
        if controller != options.controller and all(row["outcome"] == "error" for row in of):
            left_out[f"{controller} in {name}"] = of[0]["reason"] if of else "no mission"
            continue
        asked = options._replace(controller=controller)
        result = result_of(name, load_suite(name), asked, of, skipped, seconds)
        found.setdefault(controller, {})[name] = result
    return {
        "quick": options.quick,
        "seed": options.seed,
        "controller": options.controller,
        "wall_s": round(time.perf_counter() - began, 1),
        "left_out": left_out,
        "suites": found.pop(options.controller),
        "others": found,
    }


def _planned(options: Options, others: Sequence[str], every: int) -> tuple[Planned, dict[str, str]]:
    """The jobs of all suites by all controllers, and why suites and controllers were left out."""
    planned: Planned = {}
    left_out: dict[str, str] = {}
    for name in SUITES:
        try:
            planned[options.controller, name] = jobs_of(name, load_suite(name), options)
        except InputError as error:
            left_out[name] = str(error)
    if not planned:
        raise InputError(f"no suite can be run: {'; '.join(left_out.values())}")
    driving = [name for _, name in planned if hasattr(load_suite(name), "scenario")]
    for controller in others:
        try:
            controller_named(controller)
        except ConfigError as error:
            left_out[controller] = str(error)
            continue
        asked = options._replace(controller=controller)
        for name in driving:
            jobs, skipped = jobs_of(name, load_suite(name), asked)
            planned[controller, name] = _every(jobs, every), skipped
    return planned, left_out


def _every(jobs: list[Job], every: int) -> list[Job]:
    """One job in so many, drawn, so that kinds of missions which take turns are not left out."""
    drawn = Random(0).sample(range(len(jobs)), -(-len(jobs) // every))
    return [jobs[index] for index in sorted(drawn)]


def _in_turn(lists: Sequence[Sequence[Job]]) -> list[Job]:
    """A job of each suite in turn, so that what takes long is not left for the end."""
    return [job for turn in zip_longest(*lists) for job in turn if job is not None]


def picture(result: Result) -> "Figure":
    """Successes, contacts and time ratios of the suites, with 95 % intervals.

    Successes and time ratios are by controller.
    """
    suites = result["suites"]
    drivers = {result["controller"]: suites, **result["others"]}
    successes = {name: _fractions(of, "succeeded") for name, of in drivers.items()}
    return draw_intervals(
        [
            Measure("succeeded, %", successes, (0.0, 100.0)),
            Measure(
                f"contacts of {result['controller']}, %",
                {
                    "moving": _fractions(suites, "contacts_moving"),
                    "at rest": _fractions(suites, "contacts_resting"),
                },
            ),
            Measure("time / time bound", {name: _ratios(of) for name, of in drivers.items()}),
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
