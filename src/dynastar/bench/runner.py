"""Runs the missions of a suite, in as many processes as asked for, and counts what came of them."""

import os
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from dynastar.bench.missions import Mission, Options, Suite, row_of
from dynastar.bench.rows import collect, drop_rows, take_up
from dynastar.bench.selection import ABSENT, choose_missions
from dynastar.bench.statistics import succeeded, totals
from dynastar.bench.suites import SUITES, load_suite
from dynastar.bench.versions import code_version, controller_version
from dynastar.errors import InputError


class Job(NamedTuple):
    """A mission to run once by a controller: the suite by name, or itself where it has none.

    ``source`` identifies what the mission is read from, where its number does not.
    """

    suite: str | Suite
    mission: Mission
    repeat: int
    controller: str
    source: str = ""

    @property
    def key(self) -> tuple[str, int, int, str, str]:
        """Values that identify the job."""
        name = self.suite if isinstance(self.suite, str) else ""
        return (name, self.mission.number, self.repeat, self.controller, self.source)


def jobs_of(name: str, suite: Suite, options: Options) -> tuple[list[Job], Counter[str]]:
    """The jobs of a suite, in the missions' order, and how many missions were left out, by reason.

    Raises InputError where there is no mission to run.
    """
    chosen, skipped = choose_missions(suite, options)
    if not chosen:
        raise InputError(_no_mission(name, options, skipped))
    known = name if name in SUITES else suite
    source_of = getattr(suite, "source_of", lambda _: "")
    jobs = [
        Job(known, mission, repeat, options.controller, source_of(mission))
        for mission in chosen
        for repeat in range(options.repeat)
    ]
    return jobs, skipped


def _no_mission(name: str, options: Options, skipped: Counter[str]) -> str:
    """Why a suite has no mission to run, and what would be right."""
    reasons = [reason for reason in skipped if reason != ABSENT]
    if reasons:
        return f"the suite {name} leaves out every mission that is asked for: {'; '.join(reasons)}"
    if options.select is not None:
        return (
            f"--select {options.select:.80} names no mission of the suite {name}; name some it has"
        )
    data = options.data or os.environ.get("DYNASTAR_DATA") or "its data"
    return f"the suite {name}: {data} holds no mission; expected one or more"


def run_suite(
    name: str, suite: Suite, options: Options, progress: bool = False, keep: Path | None = None
) -> dict[str, Any]:
    """Runs a suite and returns its totals and ``rows``, one a mission, in the missions' order.

    A mission that raises is a row with the outcome "error" and the reason; it stops nothing. Finished
    rows are kept in ``keep``, and a run that was cut off goes on from there. It is not removed.
    """
    began = time.perf_counter()
    jobs, skipped = jobs_of(name, suite, options)
    rows, times = run_jobs(name, jobs, options, progress, keep)
    seconds = {"wall_s": time.perf_counter() - began, "cpu_s": sum(times)}
    return result_of(name, suite, options, rows, skipped, seconds)


def run_jobs(
    name: str, jobs: Sequence[Job], options: Options, progress: bool, keep: Path | None
) -> tuple[list[dict[str, Any]], list[float]]:
    """The row of each job and the seconds of CPU time it took, in the jobs' order."""
    data = options.data or os.environ.get("DYNASTAR_DATA")
    settings = {
        "run": name,
        **{key: getattr(options, key) for key in ("seed", "preset", "ideal", "attention", "legs")},
        "settings": options.settings,
        "data": os.path.abspath(data) if data else "",
        "version": code_version() + controller_version(options.controller),
    }
    work = partial(_timed, options)
    with tempfile.TemporaryDirectory() as folder:
        file = keep or Path(folder) / "rows.jsonl"
        take_up(file, settings)
        drop_rows(file, settings, jobs, _is_damaged)
        if options.observe is not None:  # a failure is observed only as it is driven
            observed = [job for job in jobs if job.controller == options.controller]
            drop_rows(file, settings, observed, lambda row: not succeeded(row))
        rows = collect(name, work, jobs, file, settings, options.workers, progress)
    times = [row.pop("cpu_s") for row in rows]
    return rows, times


def _is_damaged(row: Mapping[str, Any]) -> bool:
    """Whether a kept row lacks what every row has."""
    return not (isinstance(row.get("outcome"), str) and isinstance(row.get("cpu_s"), int | float))


def result_of(
    name: str,
    suite: Suite,
    options: Options,
    rows: Sequence[dict[str, Any]],
    skipped: Counter[str],
    seconds: Mapping[str, float],
) -> dict[str, Any]:
    """Result of a suite for JSON; ``seconds`` are ``wall_s`` of this run and ``cpu_s`` of all missions."""
    published = getattr(suite, "PUBLISHED", ())
    presets = {row["preset"] for row in rows if row["outcome"] != "error"}
    return {
        "suite": name,
        "preset": options.preset or ", ".join(sorted(presets)) or "default",
        **{key: getattr(options, key) for key in ("seed", "ideal", "controller", "legs")},
        "attention": options.attention or getattr(suite, "ATTENTION", "none"),
        "settings": dict(options.settings),
        **{key: round(value, 1) for key, value in seconds.items()},
        "published": [dict(zip(("label", "figure", "source"), p, strict=True)) for p in published],
        "comparable": getattr(suite, "COMPARABLE", ""),
        "skip_reasons": dict(skipped.most_common()),
        **totals(rows, skipped.total()),
    }


def _timed(options: Options, job: Job) -> dict[str, Any]:
    began = _cpu_time()
    row = run_job(options, job)
    return row | {"cpu_s": _cpu_time() - began}


def _cpu_time() -> float:
    """Seconds of CPU time of this process and of its children that have ended."""
    return sum(os.times()[:4])


def run_job(options: Options, job: Job) -> dict[str, Any]:
    """The row of a job with its number, repeat, seed and preset.

    Only missions of the controller that the options name are observed.
    """
    suite = load_suite(job.suite) if isinstance(job.suite, str) else job.suite
    observe = options.observe if job.controller == options.controller else None
    if observe is not None:
        observe = partial(observe, job.key[0])
    options = options._replace(controller=job.controller, observe=observe)
    row = row_of(lambda: suite.run_mission(job.mission, options, job.repeat))
    again = {"number": job.mission.number, "repeat": job.repeat, "seed": options.seed + job.repeat}
    return {**again, "preset": options.preset or "default", **row}
