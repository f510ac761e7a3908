"""What pages are told: messages of what lasts, in order, and the newest frame, as JSON."""

import itertools
import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.dwa.dwa import REFUSALS, TERMS
from dynastar.geometry import Goal
from dynastar.io.files import jsonable
from dynastar.page.packing import grid_data, packed, runs
from dynastar.simulation import Scenario, World
from dynastar.simulation.record import Recorder

Floats = npt.NDArray[np.float64]

_numbers = itertools.count(1)


class Journal:
    """``entries`` and ``frame`` are JSON texts; a page that has all of them knows all.

    Another journal has another ``number``, and begins with the scene.
    """

    def __init__(self, scene: dict[str, Any]) -> None:
        self.number = next(_numbers)
        self.entries: list[str] = []
        self.frame = ""
        self._events = self._plans = 0
        self._rings: dict[int, tuple[int, Floats]] = {}  # number and array, by the array's id
        self._ring_numbers = itertools.count()
        self._changes(scene["obstacles"])
        self.say("scene", **scene)

    def say(self, kind: str, **values: Any) -> None:
        """Adds an entry."""
        self.entries.append(_text({"type": kind, **values}))

    def obstacles(self, rings: Sequence[Floats]) -> None:
        """Adds which obstacles are gone and which are new; those of the scene are numbered from 0."""
        gone, new = self._changes(rings)
        if gone or new:
            self.say("obstacles", gone=gone, new=[[k, np.round(ring, 4)] for k, ring in new])

    def _changes(self, rings: Sequence[Floats]) -> tuple[list[int], list[tuple[int, Floats]]]:
        """Numbers of the obstacles that are no more in ``rings``, and those that are new in it."""
        now = {id(ring): ring for ring in rings}
        gone = [self._rings.pop(key)[0] for key in list(self._rings) if key not in now]
        new = {
            key: (next(self._ring_numbers), ring)
            for key, ring in now.items()
            if key not in self._rings
        }
        self._rings |= new
        return gone, list(new.values())

    def read(self, recorder: Recorder) -> None:
        """Adds the plans and events that are new in a recording."""
        for event in recorder.events[self._events :]:
            self.say("event", time=event.stamp, text=f"{event.kind}: {event.detail}")
        for plan in recorder.plans[self._plans :]:
            points, cells = packed(plan.points, np.float32), packed(runs(plan.explored), np.int32)
            self.say("plan", time=plan.stamp, reason=plan.reason, points=points, explored=cells)
        self._events, self._plans = len(recorder.events), len(recorder.plans)

    def show(self, frame: dict[str, Any]) -> None:
        """Sets the newest frame."""
        self.frame = _text({"type": "frame", **frame})


def scene_data(scenario: Scenario, cells: tuple[float, float, float, float]) -> dict[str, Any]:
    """A scene as the page takes it; ``cells`` is the frame of the navigator's planning map."""
    footprint = scenario.robot.footprint
    return {
        "name": scenario.name,
        "robot": scenario.robot.name,
        "grid": grid_data(scenario.grid),
        "radius": footprint.circumscribed,
        "footprint": footprint.vertices,
        "tolerance": scenario.goal_tolerance,
        "obstacles": scenario.obstacles,
        "cellFrame": list(cells),
        "termNames": TERMS,
        "refusals": {str(code): words for code, words in REFUSALS.items()},
    }


def frame_data(
    world: World, goals: tuple[Goal, ...], status: Any, considered: Any
) -> dict[str, Any]:
    """A tick as the page takes it."""
    movers = np.column_stack([np.arange(len(world.movers)), world.movers, world.mover_radii])
    chosen = None if math.isnan(considered.chosen[0]) else considered.chosen
    table = np.column_stack([considered.candidates, considered.refused])
    return {
        "time": world.time,
        "pose": _rounded(world.pose),
        "twist": _rounded(world.twist),
        "clearance": _rounded(min(world.clearance, 1e3)),
        "state": str(status.state),
        "reason": str(status.reason),
        "limit": str(status.limited_by),
        "goals": [_rounded(goal) for goal in goals],
        "movers": _rounded(movers[np.isfinite(movers[:, 1])]),
        "tracks": _rounded(considered.tracks),
        "candidates": packed(table, np.float32),
        "terms": _rounded(considered.terms),
        "chosen": None if chosen is None else _rounded(chosen),
    }


def _rounded(values: Any) -> Any:
    """Nested lists to a tenth of a millimetre; None stays."""
    if isinstance(values, tuple):
        return [None if value is None else round(float(value), 4) for value in values]
    return np.round(np.asarray(values, np.float64), 4).tolist()


def _text(data: dict[str, Any]) -> str:
    return json.dumps(jsonable(data), allow_nan=False, separators=(",", ":"))
