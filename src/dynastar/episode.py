"""The record of a run: data only, enough to draw it, measure it and run it again."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.grid import OccupancyGrid
from dynastar.path import Trajectory

Floats = npt.NDArray[np.float64]


class PlanRecord(NamedTuple):
    """A global plan when it was made: ``points`` (n, 2) m, why it was made, explored cells (m, 2)."""

    stamp: float
    reason: str
    points: Floats
    explored: npt.NDArray[np.int32]


class EventRecord(NamedTuple):
    """Something that happened: ``kind`` is 'recovery', 'state', 'contact', ...; ``detail`` in words."""

    stamp: float
    kind: str
    detail: str


@dataclass(frozen=True, eq=False)
class Episode:
    """One mission: what was asked, what the world was, what was driven, and how it ended.

    ``radius`` is the circumscribed one and ``footprint`` (k, 2) the polygon, (0, 2) for a disc.
    Per tick (n rows): ``trajectory`` is the truth, ``commands`` (n, 2) what was asked of the drive,
    ``clearance`` (n,) the true gap between footprint and anything in metres, ``command_ms`` (n,) the
    time a ``command`` took, ``movers`` (n, m, 2) where they truly were, ``mover_radii`` (m,),
    ``states`` (n,) the navigator's state by name, ``limits`` (n,) what limited the speed as far as the
    navigator says so, else "", and empty where that was not recorded. ``obstacles`` lists the polygons
    (k, 2) that the map did not have. ``explored_frame`` is (resolution, x, y, yaw) of the plans'
    explored cells.
    """

    grid: OccupancyGrid
    robot: str
    radius: float
    footprint: Floats
    goals: Floats
    goal_tolerance: float
    trajectory: Trajectory
    commands: Floats
    clearance: Floats
    command_ms: Floats
    states: npt.NDArray[np.str_]
    movers: Floats
    mover_radii: Floats
    obstacles: tuple[Floats, ...]
    plans: tuple[PlanRecord, ...]
    events: tuple[EventRecord, ...]
    outcome: str
    reason: str
    contact: str
    explored_frame: tuple[float, float, float, float]
    limits: npt.NDArray[np.str_] = field(default_factory=lambda: np.empty(0, np.str_))
    config: dict[str, Any] = field(default_factory=dict)
    scenario: dict[str, Any] = field(default_factory=dict)
