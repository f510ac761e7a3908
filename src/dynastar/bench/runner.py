"""The frame that all suites share: which missions, run by how many processes, counted how.

A suite is a module with four names, see ``Suite``. Missions carry the suite's own numbers, rising;
``--select`` is a slice over those numbers, ``--missions`` counts the missions run after leaving
out, and every number that was passed on the way and not run is in ``skipped``.
"""

import multiprocessing
import os
import signal
import statistics
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, Protocol, cast

from tqdm import tqdm

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
    "faults": "dynastar.bench.suites.faults",
}


class Mission(NamedTuple):
    """One mission of a suite: its ``number`` there, and whatever the suite needs to fly it."""

    number: int
    spec: Any = None


class Options(NamedTuple):
    """What the command line asks of a suite; all of it reaches the worker processes."""

    data: Path | None = None
    missions: int | None = None
    repeat: int = 1
    select: str | None = None
    seed: int = 0
    preset: str = "default"
    workers: int = 1
    ideal: bool = False
    controller: str = "navigator"
    settings: Mapping[str, Any] = {}
    save_failures: Path | None = None


class Suite(Protocol):
    """What a module has to have to be a suite."""

    @property
    def DEFAULT_MISSIONS(self) -> int | None:  # noqa: N802 - a constant of the module
        """How many missions to run unless told otherwise; None for all there are."""

    def missions(self, options: Options) -> Iterable[Mission]:
        """All missions, numbers rising, perhaps without end; cheap to make and to pickle."""

    def leave_out(self, mission: Mission, options: Options) -> str:
        """Why this mission is left out by the suite's rule, or "" to run it."""

    def fly(self, mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
        """Runs a mission and returns its row: ``outcome``, ``length`` and whatever else there is.

        Read for the totals: ``outcome`` ("arrived", "timeout", ...), ``length`` (m), ``time`` (s),
        ``contacts_moving`` and ``contacts_resting`` (0 or 1), ``reason``. Called in a worker
        process; ``repeat`` counts from 0, and so ``options.seed + repeat`` is its seed.
        """


class Slice(NamedTuple):
    """The numbers start, start + step, ... below ``stop`` (None: without end)."""

    start: int
    stop: int | None
    step: int

    def until(self, number: int) -> range:
        """Those of the numbers that are below ``number``."""
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
    """The suite of that name; ConfigError, with the nearest name, if there is none."""
    return cast(Suite, import_module(choose(name, SUITES, "suite")))


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


def run_suite(name: str, suite: Suite, options: Options, progress: bool = False) -> dict[str, Any]:
    """Runs a suite and returns its totals and ``rows``, one a mission, in the missions' order.

    A mission that raises is a row with the outcome "error" and the reason; it stops nothing.
    """
    chosen, skipped = choose_missions(suite, options)
    jobs = [(mission, repeat) for mission in chosen for repeat in range(options.repeat)]
    fly = partial(_fly, name if name in SUITES else suite, options)
    workers = min(options.workers, max(len(jobs), 1))
    with tqdm(total=len(jobs), desc=name, unit="mission", disable=not progress) as bar:
        rows: list[dict[str, Any]] = []
        for row in map(fly, jobs) if workers == 1 else spread(fly, jobs, workers):
            rows.append(row)
            bar.set_postfix(arrived=sum(row["outcome"] == "arrived" for row in rows), refresh=False)
            bar.update()
    return {"suite": name, "preset": options.preset, "seed": options.seed, **totals(rows, skipped)}


def totals(rows: list[dict[str, Any]], skipped: int) -> dict[str, Any]:
    """What a suite's rows add up to; the means are over the missions that arrived, else None."""
    arrived = [row for row in rows if row["outcome"] == "arrived"]

    def mean(key: str) -> float | None:
        values = [row[key] for row in arrived if row.get(key) is not None]
        return statistics.fmean(values) if values else None

    return {
        "missions": len(rows),
        "skipped": skipped,
        "arrived": len(arrived),
        "contacts_moving": sum(bool(row.get("contacts_moving")) for row in rows),
        "contacts_resting": sum(bool(row.get("contacts_resting")) for row in rows),
        "timeouts": sum(row["outcome"] == "timeout" for row in rows),
        "mean_length": mean("length"),
        "mean_time": mean("time"),
        "rows": rows,
    }


def _fly(suite: str | Suite, options: Options, job: tuple[Mission, int]) -> dict[str, Any]:
    mission, repeat = job
    flown_by = load_suite(suite) if isinstance(suite, str) else suite
    row = row_of(lambda: flown_by.fly(mission, options, repeat))
    again = {"number": mission.number, "repeat": repeat, "seed": options.seed + repeat}
    return {**again, "preset": options.preset, **row}


def row_of(fly: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """The row that a mission comes to; one that raises has the outcome "error" and the reason."""
    try:
        return fly()
    except Exception as error:  # a failure is a row, whatever it is: none may go uncounted
        return {"outcome": "error", "reason": f"{type(error).__name__}: {error}"}


def spread(
    work: Callable[[Any], dict[str, Any]], jobs: Sequence[Any], workers: int
) -> Iterator[dict[str, Any]]:
    """The rows that ``work`` makes of the jobs, in their order, by so many processes."""
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, context, initializer=_settle)
    try:
        yield from pool.map(work, jobs, chunksize=max(1, min(16, len(jobs) // (8 * workers))))
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _settle() -> None:
    """A worker leaves Ctrl-C to its parent and the other cores to the others, and ends with its parent."""
    import cv2

    threading.Thread(target=_end_with_parent, daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
    sys.stdout = sys.stderr


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()  # a parent that is killed cannot end its workers
        os._exit(1)
