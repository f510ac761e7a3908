"""The search: one setting after the other is raced in the same worlds, then the best is judged."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from dynastar.errors import DynastarError
from dynastar.tune.racing import race
from dynastar.tune.sampler import propose
from dynastar.tune.space import Parameter, Values
from dynastar.tune.state import Row, State, Trial
from dynastar.tune.worlds import World

SEARCHED = 0.75  # share of the time for the search; the rest is for the final comparison

Drive = Callable[
    [Sequence[World], Values], list[Row]
]  # rows of a setting in worlds, in their order
Say = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """What a search may use: seconds in all, settings, worlds at a time, and a seed."""

    seconds: float
    settings: int | None = None
    batch: int = 8
    seed: int = 0


class TimeUp(Exception):  # noqa: N818 - no error
    """The time of a search is over."""


class Search:
    """A search and its state in ``folder``, which is written after every batch of worlds.

    ``start`` are the values of the default. ``drive`` runs missions; ``say`` is given a line of progress
    at a time.
    """

    def __init__(
        self, state: State, folder: Path, start: Values, plan: Plan, drive: Drive, say: Say
    ) -> None:
        self.state, self._folder, self._plan = state, folder, plan
        self._drive, self._say = drive, say
        if not state.trials:
            state.trials.append(Trial(dict(start)))

    def run(self, space: Sequence[Parameter], worlds: Sequence[World]) -> None:
        """Races settings in ``worlds`` until time or settings are used up."""
        state, plan = self.state, self._plan
        try:
            while True:
                trial = state.trials[-1]
                if not trial.done:
                    self._race(trial, worlds)
                if (
                    plan.settings is not None and len(state.finished) > plan.settings
                ):  # and the default
                    return
                values = propose(space, state.finished, state.default, plan.seed)
                state.trials.append(Trial(values))
        except TimeUp:
            self._say(f"{self._clock()} the time for the search is over")

    def judge(self, worlds: Iterator[World], most: int) -> None:
        """Drives the default and the best setting in up to ``most`` worlds of the report seeds.

        At least one batch is driven, however little time is left; results have no influence on the end,
        and a comparison that has used up its time is not extended.
        """
        state = self.state
        best = state.best
        if best is None or best is state.trials[0]:
            return
        number = state.trials.index(best)
        if state.report_of != number:
            state.report_of, state.report_default, state.report_tuned = number, [], []
        worlds = islice(worlds, len(state.report_tuned), most)
        while chunk := self._next(worlds):
            rows = [self._timed(chunk, trial.values) for trial in (state.trials[0], best)]
            state.report_default += rows[0]
            state.report_tuned += rows[1]
            state.save(self._folder)
            self._say(f"{self._clock()} final comparison: {len(state.report_tuned)} worlds")

    def _next(self, worlds: Iterator[World]) -> list[World]:
        """The next worlds of the final comparison; none when the time is up."""
        if self.state.report_tuned and self.state.spent_s >= self._plan.seconds:
            return []
        return list(islice(worlds, max(1, self._plan.batch // 2)))

    def _race(self, trial: Trial, worlds: Sequence[World]) -> None:
        """Drives worlds with a setting until it is stopped, or in all of them."""
        state = self.state
        best = None if state.best is None else state.best.losses(state.default)

        def drive(count: int) -> list[float]:
            if state.spent_s >= SEARCHED * self._plan.seconds and len(state.finished) > 0:
                raise TimeUp
            if new := worlds[len(trial.rows) : count]:
                trial.rows += self._timed(new, trial.values)
                state.save(self._folder)
            return trial.losses(state.default)

        raced = race(len(worlds), self._plan.batch, drive, best)
        trial.stopped, trial.done = raced.stopped, True
        state.save(self._folder)
        self._report(trial, len(worlds))

    def _timed(self, worlds: Sequence[World], values: Values) -> list[Row]:
        began = time.monotonic()
        rows = self._drive(worlds, values)
        self.state.spent_s += time.monotonic() - began
        for row in rows:
            if row["outcome"] == "error":
                words = f"{row['suite']} {row['number']}: {row['reason']}"
                if values == self.state.trials[0].values:
                    raise DynastarError(f"with the default settings a mission fails: {words}")
                self._say(f"{self._clock()} a mission fails: {words}")
        return rows

    def _report(self, trial: Trial, worlds: int) -> None:
        state = self.state
        number, default = len(state.finished) - 1, state.default
        found = f"{trial.failures(default)} failures, loss {trial.mean(default):.3f}"
        end = f"stopped after {len(trial.rows)} of {worlds} worlds: {trial.stopped}"
        best = state.best
        if not trial.stopped:
            end = "best so far" if trial is best and number else f"{worlds} worlds"
        name = f"setting {number}" if number else "default"
        self._say(f"{self._clock()} {name}: {found}; {end}")

    def _clock(self) -> str:
        minutes, seconds = divmod(int(self.state.spent_s), 60)
        return f"{minutes // 60}:{minutes % 60:02d}:{seconds:02d}"
