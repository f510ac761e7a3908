"""Which missions of a suite are run: a slice of their numbers, so many of them, or a quick few.

Missions carry the suite's own numbers, rising; ``--select`` is a slice over those numbers,
``--missions`` counts the missions run after leaving out, and every number that was passed on the way
and not run is counted as skipped, by the reason.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from itertools import islice
from typing import NamedTuple

from dynastar.bench.missions import Mission, Options, Suite
from dynastar.config import shown
from dynastar.errors import InputError

REPORT_SEEDS = 10_000  # the first seed that is for published tables only
MOST = 1_000_000  # above all numbers of missions that may be asked for
ABSENT = "the suite has no mission of this number"


class Slice(NamedTuple):
    """The numbers start, start + step, ... below ``stop`` (None: without end)."""

    start: int
    stop: int | None
    step: int

    def until(self, number: int) -> range:
        """Numbers of the slice below ``number``."""
        return range(self.start, number if self.stop is None else min(self.stop, number), self.step)


class Listed(NamedTuple):
    """Numbers that are named, in order."""

    numbers: tuple[int, ...]

    @property
    def stop(self) -> int:
        """The number after the last."""
        return self.numbers[-1] + 1

    def until(self, number: int) -> Collection[int]:
        """Numbers of the list below ``number``."""
        return [one for one in self.numbers if one < number]


class Several(NamedTuple):
    """The numbers of several slices and lists."""

    parts: tuple["Slice | Listed", ...]

    @property
    def stop(self) -> int | None:
        """The number after the last; None: without end."""
        stops = [part.stop for part in self.parts if part.stop is not None]
        return max(stops) if len(stops) == len(self.parts) else None

    def until(self, number: int) -> Collection[int]:
        """Numbers of all of them below ``number``."""
        return {one for part in self.parts for one in part.until(number)}


def parse_select(text: str) -> Slice | Listed | Several:
    """The numbers that slices "A:B:C" (any of the three may be left out) and numbers stand for.

    Several of them are separated by commas. Raises InputError for anything else.
    """
    if ":" in text and "," in text:
        return Several(tuple(_one_of(part) for part in text.split(",")))
    return _one_of(text)


def _one_of(text: str) -> Slice | Listed:
    parts = text.split(":")
    try:
        if len(parts) == 1:
            listed = Listed(tuple(sorted({int(part) for part in text.split(",")})))
            if listed.numbers[0] >= 0 and listed.numbers[-1] < MOST:
                return listed
        numbers = [int(part) if part.strip() else None for part in parts]
        start, stop, step = (*numbers, None, None)[:3]
        if 2 <= len(parts) <= 3 and 0 <= (start or 0) < MOST and 0 <= (stop or 0) <= MOST:
            chosen = Slice(start or 0, stop, 1 if step is None else step)
            if chosen.step >= 1:
                return chosen
    except ValueError:
        pass
    raise InputError(
        f"--select {shown(text)}: expected A:B:C (from A, below B, every C-th) or N, or several of them "
        f"separated by commas, none negative or {MOST} and more"
    )


def refuse_report_seed(seed: int) -> None:
    """Refuses ``--quick`` with a report seed; raises InputError."""
    if seed >= REPORT_SEEDS:
        raise InputError(
            f"--quick takes development seeds, below {REPORT_SEEDS}: --seed {seed} is a report seed, "
            "for published tables only"
        )


def choose_missions(suite: Suite, options: Options) -> tuple[list[Mission], Counter[str]]:
    """The missions to run, in order, and how many were passed over or left out, by reason."""
    if options.quick:
        return _quick_missions(suite, options)
    select = parse_select(options.select) if options.select is not None else None
    limit = options.missions
    if limit is None and (select is None or select.stop is None):
        limit = suite.DEFAULT_MISSIONS
    chosen: list[Mission] = []
    skipped: Counter[str] = Counter()
    present = past = 0
    for mission in _selected(suite.missions(options), select):
        present, past = present + 1, mission.number + 1
        if reason := suite.leave_out(mission, options):
            skipped[reason] += 1
            continue
        chosen.append(mission)
        if len(chosen) == limit:
            break
    else:
        past = max(past, select.stop or 0) if select is not None else past
    asked = len(select.until(past)) if select is not None else present
    return chosen, skipped + Counter({ABSENT: asked - present})


def _selected(
    missions: Iterable[Mission], select: Slice | Listed | Several | None
) -> Iterator[Mission]:
    for mission in missions:
        if select is None:
            yield mission
        elif select.stop is not None and mission.number >= select.stop:
            return
        elif mission.number in select.until(mission.number + 1):
            yield mission


def _quick_missions(suite: Suite, options: Options) -> tuple[list[Mission], Counter[str]]:
    """``QUICK_MISSIONS`` missions, spread evenly; one that is left out gives way to the next.

    Of a suite that runs the first so many of endless missions, these are the first, too: their numbers
    say nothing about them. Only what the suite's rule leaves out is counted as skipped.
    """
    if options.missions is not None or options.select is not None:
        raise InputError("--quick chooses the missions itself: leave out --missions and --select")
    few: int | None = getattr(suite, "QUICK_MISSIONS", None)
    if few is None or suite.DEFAULT_MISSIONS is not None:
        return choose_missions(suite, options._replace(quick=False, missions=few))
    everything = list(suite.missions(options))
    chosen: list[Mission] = []
    skipped: Counter[str] = Counter()
    following = 0
    for turn in range(few):
        following = max(following, turn * len(everything) // few)
        while following < len(everything):
            reason = suite.leave_out(everything[following], options)
            if not reason:
                break
            skipped[reason] += 1
            following += 1
        chosen += islice(everything, following, following + 1)
        following += 1
    return chosen, skipped
