"""The frame that all suites share: which missions, run by how many processes, counted how.

A suite is a module with four names, see ``Suite``. Missions carry the suite's own numbers, rising;
``--select`` is a slice over those numbers, ``--missions`` counts the missions run after leaving
out, and every number that was passed on the way and not run is in ``skipped``.
"""

import hashlib
import importlib.util
import os
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple, Protocol, cast

from dynastar.bench.rows import code_version, collect
from dynastar.bench.statistics import totals
from dynastar.bench.workers import Workers
from dynastar.config import choose
from dynastar.errors import DataError, InputError

SUITES = {
    "movingai": "dynastar.bench.movingai",
    "paper": "dynastar.bench.paper",
    "barn": "dynastar.bench.suites.barn",
    "dynabarn": "dynastar.bench.suites.dynabarn",
    "mrpb": "dynastar.bench.suites.mrpb",
    "crowd": "dynastar.bench.suites.crowd",
    "maps": "dynastar.bench.suites.maps",
    "office": "dynastar.bench.suites.office",
    "random": "dynastar.bench.suites.random_worlds",
    "people": "dynastar.bench.suites.people",
    "faults": "dynastar.bench.suites.faults",
    "scenarios": "dynastar.bench.suites.scenarios",
}


class Mission(NamedTuple):
    """One mission of a suite: its ``number`` there, and whatever the suite needs to run it."""

    number: int
    spec: Any = None


class Options(NamedTuple):
    """Options of a suite from the command line; all of them reach the worker processes.

    ``settings`` are the navigator's, as nested tables, over the preset's. ``observe`` is called with
    the suite's name and each mission that is driven, its repeat, its episode and its row.
    """

    data: Path | None = None
    missions: int | None = None
    repeat: int = 1
    select: str | None = None
    seed: int = 0
    preset: str = "default"
    workers: Workers = 1
    ideal: bool = False
    controller: str = "navigator"
    settings: Mapping[str, Any] = {}
    quick: bool = False
    observe: Callable[..., None] | None = None


class Suite(Protocol):
    """Interface of a module that is a suite.

    A suite that drives also has ``scenario(mission, options, repeat)``, the Scenario of a mission. It
    may have ``QUICK_MISSIONS``, how many missions ``--quick`` runs, ``PUBLISHED``, tuples of a label, a
    figure in words and the key of its source, and ``COMPARABLE``, what is comparable in a sentence.
    """

    @property
    def DEFAULT_MISSIONS(self) -> int | None:  # noqa: N802 - a constant of the module
        """Default number of missions; None for all."""

    def missions(self, options: Options) -> Iterable[Mission]:
        """All missions, numbers rising, perhaps without end; cheap to make and to pickle."""

    def leave_out(self, mission: Mission, options: Options) -> str:
        """Why this mission is left out by the suite's rule, or "" to run it."""

    def run_mission(self, mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
        """Runs a mission and returns its row: ``outcome``, ``length`` and whatever else there is.

        Read for the totals: ``outcome`` ("arrived", "timeout", ...), ``length`` (m), ``time`` (s),
        ``contacts_moving`` and ``contacts_resting`` (0 or 1), ``reason``, ``group``, ``score``,
        ``time_ratio``, ``tick_ms_median``, ``tick_ms_p99``, ``limited``. Called in a worker
        process; ``repeat`` counts from 0, and so ``options.seed + repeat`` is its seed.
        """


class Slice(NamedTuple):
    """The numbers start, start + step, ... below ``stop`` (None: without end)."""

    start: int
    stop: int | None
    step: int

    def until(self, number: int) -> range:
        """Numbers of the slice below ``number``."""
        return range(self.start, number if self.stop is None else min(self.stop, number), self.step)


def parse_select(text: str) -> Slice:
    """The slice that "A:B:C", with any part left out, or a bare "N" stands for; else InputError."""
    parts = text.split(":")
    try:
        numbers = [int(part) if part.strip() else None for part in parts]
        if len(parts) == 1 and numbers[0] is not None and numbers[0] >= 0:
            return Slice(numbers[0], numbers[0] + 1, 1)
        start, stop, step = (*numbers, None, None)[:3]
        if 2 <= len(parts) <= 3 and (start or 0) >= 0 and (stop or 0) >= 0:
            chosen = Slice(start or 0, stop, 1 if step is None else step)
            if chosen.step >= 1:
                return chosen
    except ValueError:
        pass
    raise InputError(
        f"--select {text!r}: expected A:B:C (from A, below B, every C-th) or N, none negative"
    )


def load_suite(name: str) -> Suite:
    """The suite of that name; ConfigError, with the nearest name, if there is none.

    DataError if it needs a package that is not installed.
    """
    try:
        return cast(Suite, import_module(choose(name, SUITES, "suite")))
    except ModuleNotFoundError as error:
        raise DataError(
            f"the suite {name} needs the package {error.name}, which is not installed; the extras of "
            "dynastar are in its README"
        ) from None


def data_folder(options: Options, suite: str, holds: str) -> Path:
    """The folder with a suite's data: one that has the file ``holds``.

    ``--data`` is that folder or the one above it, or else $DYNASTAR_DATA is; else DataError.
    """
    named = options.data or os.environ.get("DYNASTAR_DATA")
    if not named:
        raise DataError(f"the suite {suite} reads data: give --data DIR or set DYNASTAR_DATA")
    for folder in (Path(named), Path(named) / suite):
        if (folder / holds).is_file():
            return folder
    raise DataError(
        f"{named} has no {holds}, and no {suite}/{holds}: expected the folder of the suite {suite} "
        "or the one above it"
    )


def choose_missions(suite: Suite, options: Options) -> tuple[list[Mission], int]:
    """The missions to run, in order, and how many numbers were passed over or left out."""
    if options.quick:
        return _quick_missions(suite, options)
    select = parse_select(options.select) if options.select is not None else None
    limit = options.missions
    if limit is None and (select is None or select.stop is None):
        limit = suite.DEFAULT_MISSIONS
    chosen: list[Mission] = []
    present = skipped = past = 0
    for mission in _selected(suite.missions(options), select):
        present, past = present + 1, mission.number + 1
        if suite.leave_out(mission, options):
            skipped += 1
            continue
        chosen.append(mission)
        if len(chosen) == limit:
            break
    else:
        past = max(past, select.stop or 0) if select is not None else past
    asked = len(select.until(past)) if select is not None else present
    return chosen, skipped + asked - present


def _selected(missions: Iterable[Mission], select: Slice | None) -> Iterator[Mission]:
    for mission in missions:
        if select is None:
            yield mission
        elif select.stop is not None and mission.number >= select.stop:
            return
        elif mission.number >= select.start and not (mission.number - select.start) % select.step:
            yield mission


def _quick_missions(suite: Suite, options: Options) -> tuple[list[Mission], int]:
    """``QUICK_MISSIONS`` missions, spread evenly; one that is left out gives way to the next.

    Of a suite that runs the first so many of endless missions, these are the first, too: their numbers
    say nothing about them. ``skipped`` counts only what the suite's rule leaves out.
    """
    if options.missions is not None or options.select is not None:
        raise InputError("--quick chooses the missions itself: leave out --missions and --select")
    few: int | None = getattr(suite, "QUICK_MISSIONS", None)
    if few is None or suite.DEFAULT_MISSIONS is not None:
        return choose_missions(suite, options._replace(quick=False, missions=few))
    everything = list(suite.missions(options))
    chosen: list[Mission] = []
    skipped = following = 0
    for turn in range(few):
        following = max(following, turn * len(everything) // few)
        while following < len(everything) and suite.leave_out(everything[following], options):
            skipped, following = skipped + 1, following + 1
        chosen += islice(everything, following, following + 1)
        following += 1
    return chosen, skipped


class Job(NamedTuple):
    """A mission to run once: the suite by name, or itself where it has none, and the repeat."""

    suite: str | Suite
    mission: Mission
    repeat: int

    @property
    def key(self) -> tuple[str, int, int]:
        """Digest that identifies the job."""
        name = self.suite if isinstance(self.suite, str) else ""
        return (name, self.mission.number, self.repeat)


def jobs_of(name: str, suite: Suite, options: Options) -> tuple[list[Job], int]:
    """The jobs of a suite, in the missions' order, and how many missions were left out."""
    chosen, skipped = choose_missions(suite, options)
    known = name if name in SUITES else suite
    return [Job(known, m, repeat) for m in chosen for repeat in range(options.repeat)], skipped


def run_suite(
    name: str, suite: Suite, options: Options, progress: bool = False, keep: Path | None = None
) -> dict[str, Any]:
    """Runs a suite and returns its totals and ``rows``, one a mission, in the missions' order.

    A mission that raises is a row with the outcome "error" and the reason; it stops nothing. Finished
    rows are kept in ``keep``, and a run that was cut off goes on from there. It is not removed.
    """
    jobs, skipped = jobs_of(name, suite, options)
    rows, walls = run_jobs(name, jobs, options, progress, keep)
    return result_of(name, suite, options, rows, skipped, sum(walls))


def run_jobs(
    name: str, jobs: Sequence[Job], options: Options, progress: bool, keep: Path | None
) -> tuple[list[dict[str, Any]], list[float]]:
    """The row of each job and the seconds of wall time it took, in the jobs' order."""
    settings = {
        "run": name,
        **{key: getattr(options, key) for key in ("seed", "preset", "ideal", "controller")},
        "settings": options.settings,
        "data": os.path.abspath(options.data or os.environ.get("DYNASTAR_DATA") or "."),
        "version": code_version() + _controller_version(options.controller),
    }
    work = partial(_timed, options)
    with tempfile.TemporaryDirectory() as folder:
        file = keep or Path(folder) / "rows.jsonl"
        rows = collect(name, work, jobs, file, settings, options.workers, progress)
    walls = [row.pop("wall_s") for row in rows]
    return rows, walls


def result_of(
    name: str,
    suite: Suite,
    options: Options,
    rows: Sequence[dict[str, Any]],
    skipped: int,
    wall: float,
) -> dict[str, Any]:
    """Result of a suite for JSON; ``wall_s`` is the missions' wall time together."""
    published = getattr(suite, "PUBLISHED", ())
    return {
        "suite": name,
        **{key: getattr(options, key) for key in ("preset", "seed", "ideal", "controller")},
        "settings": dict(options.settings),
        "wall_s": round(wall, 1),
        "published": [dict(zip(("label", "figure", "source"), p, strict=True)) for p in published],
        "comparable": getattr(suite, "COMPARABLE", ""),
        **totals(rows, skipped),
    }


def _controller_version(name: str) -> str:
    """A digest of the file of a controller of the user's own."""
    module, colon, _ = name.partition(":")
    found = importlib.util.find_spec(module) if colon else None
    if found is None or found.origin is None or not Path(found.origin).is_file():
        return ""
    return "-" + hashlib.sha256(Path(found.origin).read_bytes()).hexdigest()[:16]


def _timed(options: Options, job: Job) -> dict[str, Any]:
    began = time.perf_counter()
    row = run_job(options, job)
    return row | {"wall_s": time.perf_counter() - began}


def run_job(options: Options, job: Job) -> dict[str, Any]:
    """The row of a job with its number, repeat, seed and preset."""
    suite = load_suite(job.suite) if isinstance(job.suite, str) else job.suite
    if options.observe is not None:
        options = options._replace(observe=partial(options.observe, job.key[0]))
    row = row_of(lambda: suite.run_mission(job.mission, options, job.repeat))
    again = {"number": job.mission.number, "repeat": job.repeat, "seed": options.seed + job.repeat}
    return {**again, "preset": options.preset, **row}


def row_of(run_mission: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """The row that a mission comes to; one that raises has the outcome "error" and the reason."""
    try:
        return run_mission()
    except Exception as error:  # a failure is a row, whatever it is: none may go uncounted
        return {"outcome": "error", "reason": f"{type(error).__name__}: {error}"}
