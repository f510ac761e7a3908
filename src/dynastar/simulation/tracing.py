"""Recording what the navigator considers, tick by tick."""

from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.episode import Trace

NO_TERMS = np.full(5, np.nan, np.float32)
NO_CHOICE = np.full(3, np.nan, np.float32)


class Tracer:
    """Gathers a Trace from a controller that is a Navigator, or has its ``status``."""

    def __init__(self, controller: Any) -> None:
        self._navigator = getattr(controller, "navigator", controller)
        self._candidates: list[npt.NDArray[np.float32]] = []
        self._refused: list[npt.NDArray[np.uint8]] = []
        self._terms: list[npt.NDArray[np.float32]] = []
        self._chosen: list[npt.NDArray[np.float32]] = []
        self._tracks: list[npt.NDArray[np.float32]] = []
        self._reasons: list[str] = []
        self._seen: list[npt.NDArray[np.int32]] = []
        self._known: npt.NDArray[np.bool_] | None = None
        self._frame = (1.0, 0.0, 0.0, 0.0)

    def tick(self, status: Any) -> None:
        """One more tick, with the status after it."""
        survey = getattr(self._navigator, "survey", None)
        choice = None if survey is None else survey()
        candidates, refused = np.empty((0, 3), np.float32), np.empty(0, np.uint8)
        terms, chosen = NO_TERMS, NO_CHOICE
        if choice is not None:
            candidates = np.column_stack([choice.samples, choice.score]).astype(np.float32)
            refused = choice.refused.astype(np.uint8)
            if choice.manoeuvre is not None:
                v, omega, hold, _ = choice.manoeuvre
                chosen = np.array([v, omega, hold], np.float32)
                apart = np.abs(choice.samples - (v, omega)).sum(axis=1)
                if len(apart) and apart.min() < 1e-6:
                    terms = choice.terms[int(apart.argmin())].astype(np.float32)
        self._candidates.append(candidates)
        self._refused.append(refused)
        self._terms.append(terms)
        self._chosen.append(chosen)
        tracks = [(t.x, t.y, t.vx, t.vy, t.radius) for t in getattr(status, "tracks", ())]
        self._tracks.append(np.array(tracks, np.float32).reshape(-1, 5))
        self._reasons.append(str(status.reason))
        self._look()

    def _look(self) -> None:
        """Notes which cells of the planning map have changed by what was sensed."""
        planning_map = getattr(self._navigator, "planning_map", None)
        if planning_map is None:
            return
        seen, (resolution, x, y, yaw) = planning_map.seen, planning_map.frame
        self._frame = (resolution, x, y, yaw)
        if self._known is None or self._known.shape != seen.shape:
            self._known = np.zeros_like(seen)
        rows, columns = np.nonzero(seen != self._known)
        if len(rows):
            now = np.full(len(rows), len(self._reasons) - 1)
            cells = np.column_stack([now, rows, columns, seen[rows, columns]])
            self._seen.append(cells.astype(np.int32))
            self._known = seen.copy()

    def trace(self) -> Trace:
        """All of it."""
        return Trace(
            np.concatenate([np.empty((0, 3), np.float32), *self._candidates]),
            np.concatenate([np.empty(0, np.uint8), *self._refused]),
            np.array([len(one) for one in self._refused], np.int64),
            np.array(self._terms, np.float32).reshape(-1, 5),
            np.array(self._chosen, np.float32).reshape(-1, 3),
            np.concatenate([np.empty((0, 5), np.float32), *self._tracks]),
            np.array([len(one) for one in self._tracks], np.int64),
            np.array(self._reasons, np.str_),
            np.concatenate([np.empty((0, 4), np.int32), *self._seen]),
            self._frame,
        )
