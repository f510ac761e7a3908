"""Recording what the navigator considers, tick by tick."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.dwa.config import Weights
from dynastar.episode import Trace

NO_TERMS = np.full(len(Weights._fields), np.nan, np.float32)  # a weight for each term
NO_CHOICE = np.full(3, np.nan, np.float32)


class Considered(NamedTuple):
    """What was considered in one tick: a row of a Trace."""

    candidates: npt.NDArray[np.float32]
    refused: npt.NDArray[np.uint8]
    terms: npt.NDArray[np.float32]
    chosen: npt.NDArray[np.float32]
    tracks: npt.NDArray[np.float32]
    reason: str


def considered(status: Any) -> Considered:
    """What a controller with the ``status`` of a Navigator considered in its last tick."""
    choice = getattr(status, "choice", None)
    candidates, refused = np.empty((0, 3), np.float32), np.empty(0, np.uint8)
    terms, chosen = NO_TERMS, NO_CHOICE
    if choice is not None:
        candidates = np.column_stack([choice.samples, choice.score]).astype(np.float32)
        refused = choice.refused.astype(np.uint8)
        if choice.manoeuvre is not None:
            chosen = np.array(choice.manoeuvre[:3], np.float32)
            terms = choice.terms[int(np.argmax(choice.score))].astype(np.float32)
    tracks = [(t.x, t.y, t.vx, t.vy, t.radius) for t in getattr(status, "tracks", ())]
    table = np.array(tracks, np.float32).reshape(-1, 5)
    return Considered(candidates, refused, terms, chosen, table, str(status.reason))


class Sensed:
    """Which cells of a navigator's planning map are blocked by what was sensed, as they change.

    ``frame`` is (resolution, x, y, yaw) of the cells.
    """

    def __init__(self) -> None:
        self.frame = (1.0, 0.0, 0.0, 0.0)
        self._known: npt.NDArray[np.bool_] | None = None

    def changes(self, navigator: Any) -> npt.NDArray[np.int32]:
        """The cells changed since the last call (m, 3): row, column, and 1 if blocked, else 0."""
        planning_map = getattr(navigator, "planning_map", None)
        if planning_map is None:
            return np.empty((0, 3), np.int32)
        seen, (resolution, x, y, yaw) = planning_map.seen, planning_map.grid.frame
        self.frame = (resolution, x, y, yaw)
        if self._known is None or self._known.shape != seen.shape:
            self._known = np.zeros_like(seen)
        rows, columns = np.nonzero(seen != self._known)
        if len(rows):
            self._known = seen.copy()
        return np.column_stack([rows, columns, seen[rows, columns]]).astype(np.int32)


class Tracer:
    """Gathers a Trace from a controller that is a Navigator, or has one as ``navigator``."""

    def __init__(self, controller: Any) -> None:
        self._controller = controller
        self._sensed = Sensed()
        self._candidates: list[npt.NDArray[np.float32]] = []
        self._refused: list[npt.NDArray[np.uint8]] = []
        self._terms: list[npt.NDArray[np.float32]] = []
        self._chosen: list[npt.NDArray[np.float32]] = []
        self._tracks: list[npt.NDArray[np.float32]] = []
        self._reasons: list[str] = []
        self._seen: list[npt.NDArray[np.int32]] = []

    def tick(self, status: Any) -> tuple[Considered, npt.NDArray[np.int32]]:
        """Notes one more tick, with the status after it; returns what was noted of it."""
        navigator = getattr(self._controller, "navigator", self._controller)
        one, cells = considered(status), self._sensed.changes(navigator)
        self._candidates.append(one.candidates)
        self._refused.append(one.refused)
        self._terms.append(one.terms)
        self._chosen.append(one.chosen)
        self._tracks.append(one.tracks)
        self._reasons.append(one.reason)
        if len(cells):
            now = np.full((len(cells), 1), len(self._reasons) - 1, np.int32)
            self._seen.append(np.hstack([now, cells]))
        return one, cells

    def trace(self) -> Trace:
        """All of it."""
        return Trace(
            np.concatenate([np.empty((0, 3), np.float32), *self._candidates]),
            np.concatenate([np.empty(0, np.uint8), *self._refused]),
            np.array([len(one) for one in self._refused], np.int64),
            np.array(self._terms, np.float32).reshape(-1, len(NO_TERMS)),
            np.array(self._chosen, np.float32).reshape(-1, 3),
            np.concatenate([np.empty((0, 5), np.float32), *self._tracks]),
            np.array([len(one) for one in self._tracks], np.int64),
            np.array(self._reasons, np.str_),
            np.concatenate([np.empty((0, 4), np.int32), *self._seen]),
            self._sensed.frame,
        )
