"""What a suite is made of: missions, the options they are run with, and where its data lie."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from dynastar.bench.workers import Workers
from dynastar.errors import DataError
from dynastar.paths import local_path
from dynastar.simulation.scenario import Attention


class Mission(NamedTuple):
    """One mission of a suite: its ``number`` there, and whatever the suite needs to run it."""

    number: int
    spec: Any = None


class Options(NamedTuple):
    """Options of a suite from the command line; all of them reach the worker processes.

    ``preset`` is "" for that of each mission's scenario. ``settings`` are the navigator's, as nested
    tables, over the preset's. ``observe`` is called with
    the suite's name and each mission that is driven, its repeat, its episode and its row.
    ``attention`` is that of scripted walkers, None for the suite's own; ``legs`` shows their legs alone.
    """

    data: Path | None = None
    missions: int | None = None
    repeat: int = 1
    select: str | None = None
    seed: int = 0
    preset: str = ""
    workers: Workers = 1
    ideal: bool = False
    controller: str = "navigator"
    settings: Mapping[str, Any] = {}
    quick: bool = False
    attention: Attention | None = None
    legs: bool = False
    observe: Callable[..., None] | None = None


class Suite(Protocol):
    """Interface of a module that is a suite.

    A suite that drives also has ``scenario(mission, options, repeat)``, the Scenario of a mission. It
    may have ``QUICK_MISSIONS``, how many missions ``--quick`` runs, ``PUBLISHED``, tuples of a label, a
    figure in words and the key of its source, ``COMPARABLE``, what is comparable in a sentence,
    ``ATTENTION``, that of its scripted walkers where it is not "none", and ``source_of(mission)``, a
    string that changes with the file that a mission is read from.
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
        process; ``repeat`` counts from 0. The noise of a mission has the seed of its scenario (its number,
        as a rule) plus ``options.seed + repeat``.
        """


def endless(options: Options) -> Iterator[Mission]:
    """Missions without end, numbered from 0; a mission is its number and the suite's seed."""
    del options
    return map(Mission, count())


def data_folder(options: Options, suite: str, holds: str, folder: str = "") -> Path:
    """The folder with a suite's data: one that has a file of the glob ``holds``.

    ``--data`` is that folder or the one above it, or else $DYNASTAR_DATA is; else DataError. The one
    below is called ``folder``, or as the suite.
    """
    named = options.data or os.environ.get("DYNASTAR_DATA")
    if not named:
        raise DataError(f"the suite {suite} reads data: give --data DIR or set DYNASTAR_DATA")
    below = folder or suite
    given = local_path(named, DataError)
    for place in (given / below, given):
        if any(place.glob(holds)):
            return place
    raise DataError(
        f"{named} has no {holds}, and no {below}/{holds}: expected the folder of the suite {suite} "
        "or the one above it"
    )


def row_of(run_mission: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """The row that a mission comes to; one that raises has the outcome "error" and the reason."""
    try:
        return run_mission()
    except Exception as error:  # a failure is a row, whatever it is: none may go uncounted
        return {"outcome": "error", "reason": f"{type(error).__name__}: {error}"}
