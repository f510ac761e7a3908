"""The global path of a controller: planned on its costmap, and planned anew every second."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress

import numpy as np
import numpy.typing as npt

from dynastar.bench.controllers.costmap import PADDING, Costmap
from dynastar.errors import PlanningError
from dynastar.geometry import Goal
from dynastar.path import Path
from dynastar.planning import GridPlanner, Plan, PlannerConfig
from dynastar.robot import Robot

Mask = npt.NDArray[np.bool_]

PERIOD = 1.0  # s between two plans, as the planner of Nav2 has it
ROOMS = (0.3, 0.1)  # m beside the circumscribed radius that a path keeps where that is no detour
DETOURS = (1.2, 1.5)  # over the narrow path's length, the longest that such a path may be
SHORTER = 0.9  # a new path replaces a clear one only where it is that much shorter


class PlannedPath(ABC):
    """A path planned on a costmap; a subclass says in ``update`` when it is planned.

    ``planners`` has a planner for each of ``radii`` (m). ``s`` (m) is how far along the path the
    robot is.
    """

    def __init__(self, costmap: Costmap, radii: Sequence[float], config: PlannerConfig) -> None:
        self.planners = [
            GridPlanner(costmap.grid, radius, "blocked", config, costmap.factor) for radius in radii
        ]
        self.mark((0, 0, costmap.blocked))
        self.plan: Plan | None = None
        self.s = 0.0

    @property
    def path(self) -> Path | None:
        """The path of the present plan."""
        return None if self.plan is None else self.plan.path

    def mark(self, window: tuple[int, int, Mask]) -> None:
        """Takes over cells of the costmap that changed."""
        for planner in self.planners:
            planner.mark(*window)

    def drop(self) -> None:
        """Forgets the path, so that the next ``update`` plans."""
        self.plan = None

    def blocked(self, radius: float) -> bool:
        """Whether the path from ``s`` on is blocked for the disc of the last planner's ``radius`` (m)."""
        assert self.path is not None
        rest = self.path.points[self.path.arc > self.s + 1e-6]
        if len(rest) == 0:
            return False
        ahead = np.vstack([self.path.at(self.s), rest])
        return self.planners[-1].path_blocked_at(ahead, 0.9 * radius) is not None

    @abstractmethod
    def update(self, here: tuple[float, float], goal: Goal, now: float) -> bool:
        """Follows the progress of the robot, ``here`` (m), and plans; True for a new path.

        Raises PlanningError where there is no path, and keeps none then.
        """


class Route(PlannedPath):
    """Plans with the circumscribed radius and some room, or narrowly where that is far round."""

    def __init__(self, costmap: Costmap, robot: Robot) -> None:
        shape = robot.footprint
        self._narrow = shape.inscribed + PADDING
        radii = (*(shape.circumscribed + room for room in ROOMS), self._narrow)
        super().__init__(costmap, radii, PlannerConfig(planner="auto"))
        self._planned_at = -math.inf

    def drop(self) -> None:
        """Forgets the path, so that the next ``update`` plans."""
        super().drop()
        self._planned_at = -math.inf

    def update(self, here: tuple[float, float], goal: Goal, now: float) -> bool:
        """Plans every second, and sooner where the path is blocked."""
        blocked = False
        if self.path is not None:
            self.s = self.path.project(*here, low=self.s - 0.3, high=self.s + 2.0)
            blocked = self.blocked(self._narrow)
        if self.plan is not None and not blocked and now - self._planned_at < PERIOD:
            return False
        if blocked and now - self._planned_at < 0.2 * PERIOD:
            return False
        self._planned_at = now
        try:
            new = self._best(here, (goal.x, goal.y))
        except PlanningError:
            self.plan = None
            raise
        left = math.inf if self.path is None or blocked else self.path.length - self.s
        if new.path.length > SHORTER * left:
            return False
        self.plan, self.s = new, 0.0
        return True

    def _best(self, start: tuple[float, float], goal: tuple[float, float]) -> Plan:
        *roomy, narrow = self.planners
        plan = narrow.plan(start, goal)
        for planner, detour in zip(roomy, DETOURS, strict=True):
            with suppress(PlanningError):
                wide = planner.plan(start, goal)
                short = wide.path.length <= detour * plan.path.length
                # From too near to something, a plan leads out without regard to its radius.
                if short and narrow.path_blocked_at(wide.path.points, 0.99 * self._narrow) is None:
                    return wide
        return plan
