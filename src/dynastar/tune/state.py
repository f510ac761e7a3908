"""What a search has found so far, kept in a file so that it goes on where it was stopped."""

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dynastar.errors import DataError, InputError
from dynastar.io.files import MAX_TEXT_BYTES, jsonable, read_bytes, write_json
from dynastar.tune.objective import FAILURE, loss

FILE = "state.json"
KEPT = (  # of a row
    *("suite", "number", "repeat", "seed", "outcome", "right", "blocked_rightly", "reason"),
    *("contacts_moving", "contacts_resting", "time", "length", "smoothness"),
)

Row = dict[str, Any]


@dataclass
class Trial:
    """A setting and what came of it: rows of the first worlds, and why it was stopped."""

    values: dict[str, float]
    rows: list[Row] = field(default_factory=list)
    stopped: str = ""
    done: bool = False

    def losses(self, default: Sequence[Row]) -> list[float]:
        """The loss in each world driven, relative to the default's row."""
        return [loss(row, of) for row, of in zip(self.rows, default, strict=False)]

    def mean(self, default: Sequence[Row]) -> float:
        """The mean loss in the worlds that were driven."""
        losses = self.losses(default)
        return sum(losses) / len(losses)

    def failures(self, default: Sequence[Row]) -> int:
        """The number of worlds in which it failed."""
        return sum(one >= FAILURE for one in self.losses(default))


@dataclass
class State:
    """The state of a search: its trials, of which the first is the default, and the final rows.

    ``asked`` is what the search depends on, ``spent_s`` the seconds of wall time used so far. The final
    rows compare the default with trial ``report_of``.
    """

    asked: dict[str, Any]
    trials: list[Trial] = field(default_factory=list)
    spent_s: float = 0.0
    report_of: int = 0
    report_default: list[Row] = field(default_factory=list)
    report_tuned: list[Row] = field(default_factory=list)

    @property
    def default(self) -> list[Row]:
        """The rows of the default settings, in the worlds of the search."""
        return self.trials[0].rows

    @property
    def finished(self) -> list[Trial]:
        """Trials that are done, stopped ones too."""
        return [trial for trial in self.trials if trial.done]

    @property
    def best(self) -> Trial | None:
        """The trial with the least mean loss of those that drove all worlds; the earliest of equal ones."""
        whole = [trial for trial in self.finished if not trial.stopped]
        return min(whole, key=lambda trial: trial.mean(self.default)) if whole else None

    def save(self, folder: Path) -> None:
        """Writes the state; a reader sees all of it or the one before."""
        write_json(folder / FILE, {**vars(self), "trials": [vars(one) for one in self.trials]})


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Keeps other searches out of a folder; raises InputError if one is running there.

    Where the system or the file system has no such locks nothing is kept out.
    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        from fcntl import LOCK_EX, LOCK_NB, flock
    except ImportError:
        yield
        return
    held = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            try:
                flock(held, LOCK_EX | LOCK_NB)
            except BlockingIOError:
                raise InputError(
                    f"{folder}: another search runs in it: name another --out"
                ) from None
        yield
    finally:
        os.close(held)


def load_state(folder: Path, asked: Mapping[str, Any]) -> State:
    """The state in a folder, or a new one.

    Raises InputError if it is of another search, DataError if it cannot be read.
    """
    file = folder / FILE
    if not file.exists():
        return State(dict(asked))
    try:
        table = json.loads(read_bytes(file, MAX_TEXT_BYTES, InputError))
        trials = [Trial(**one) for one in table.pop("trials")]
        state = State(trials=trials, **table)
        spent = state.spent_s
        whole = isinstance(state.asked, dict) and all(
            isinstance(one.values, dict) and isinstance(one.rows, list) for one in trials
        )
        whole = whole and type(spent) in (int, float) and 0.0 <= spent < math.inf
        if not whole:
            raise ValueError("expected the state of a search")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise DataError(f"{file} cannot be read ({error!s:.100}): name another --out") from None
    differ = [name for name, value in jsonable(asked).items() if state.asked.get(name) != value]
    if differ:
        raise InputError(
            f"{folder} holds a search with other {', '.join(differ)}: name another --out, or give "
            "the same options"
        )
    return state


def kept(row: Mapping[str, Any], suite: str) -> Row:
    """What is kept of a mission's row."""
    return {key: value for key, value in {**row, "suite": suite}.items() if key in KEPT}
