"""External planners: the protocol they follow, and how their paths become plans."""

import logging
import math
import time
from typing import Any, Protocol

import numpy as np

from dynastar.config import shown
from dynastar.errors import InputError, NoPath, PlanningError
from dynastar.grid import OccupancyGrid
from dynastar.path import Path
from dynastar.planning.plan_type import Plan

log = logging.getLogger("dynastar")

Point = tuple[float, float]

AWAY = 2.0  # cells that a path's ends may lie off the start and goal asked for


class Planner(Protocol):
    """Any object that plans, for ``Navigator(..., planner=...)``."""

    def plan(self, grid: OccupancyGrid, start: Point, goal: Point, radius: float) -> Path:
        """The path of a disc of ``radius`` metres from ``start`` to ``goal``, (x, y) in metres.

        It may end elsewhere within the navigator's ``goal_tolerance``.
        What the map shows and what was seen since is occupied in ``grid``, unknown cells are as the
        navigator takes them. Raises NoPath, GoalOccupied or StartOccupied where there is none.
        """


def check_planner(planner: Any) -> None:
    """Raises InputError for what is no planner of one's own, or None."""
    if planner is not None and not callable(getattr(planner, "plan", None)):
        raise InputError(
            f"a planner: got {shown(planner)}, expected an object with a method plan(grid, start, goal, "
            "radius); NavigatorConfig(planner=PlannerConfig(planner=NAME)) takes one of dynastar's"
        )


def plan_by(
    planner: Planner,
    grid: OccupancyGrid,
    start: Point,
    goal: Point,
    radius: float,
    tolerance: float = 0.0,
) -> Plan:
    """The plan of an external planner, which may end ``tolerance`` metres from the goal.

    Raises PlanningError, whatever the planner raises.
    """
    name, began = type(planner).__name__, time.perf_counter()
    try:
        path = planner.plan(grid, start, goal, radius)
        path = path if isinstance(path, Path) else Path(np.asarray(path, dtype=np.float64))
    except PlanningError:
        raise
    except Exception as error:
        log.exception("the planner %s failed", name)
        raise NoPath(f"the planner {name} failed: {error!r:.200}") from error
    off = AWAY * grid.resolution
    for end, wanted, what, most in (
        (0, start, "begins", off),
        (-1, goal, "ends", max(off, tolerance)),
    ):
        gap = math.dist(path.points[end], wanted)
        if gap > most:
            raise NoPath(
                f"the path of the planner {name} {what} {gap:.3g} m from ({wanted[0]:g}, {wanted[1]:g})"
            )
    took = 1e3 * (time.perf_counter() - began)
    cells = np.empty((0, 2), np.int32)
    length = path.length / grid.resolution
    return Plan(name, path, path, cells, length, 0, None, took, radius, 0.0)
