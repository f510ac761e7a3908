"""The planners of a navigator: one search for each of several clearances."""

import numpy as np
import numpy.typing as npt

from dynastar.errors import GoalOccupied, NoPath, StartOccupied
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import NavigatorConfig
from dynastar.perception.planning_map import Patch, PlanningMap
from dynastar.planning import GridPlanner, Plan, Planner, plan_by

Point = tuple[float, float]

LONGER = 1.03  # times the tightest plan's length, a plan with room to spare is too long


class Planners:
    """Plans on a planning map, with room to spare where there is room.

    One planner keeps ``comfort`` more clearance than the first of ``radii`` (m), one that, and one the
    second. Where a roomier finds no way, or only a longer one, the plan is that of the next. A
    ``planner`` given is asked in their place, for the same radii. Points are in the map frame.
    """

    def __init__(
        self,
        planning_map: PlanningMap,
        config: NavigatorConfig,
        radii: tuple[float, float],
        planner: Planner | None = None,
    ) -> None:
        self.planning_map = planning_map
        roomy, tight = radii
        self.by_width = [
            GridPlanner(
                planning_map.grid, radius, config.unknown, config.planner, planning_map.factor
            )
            for radius in sorted({roomy + config.comfort, roomy, tight}, reverse=True)
        ]
        self._planner = planner
        # The search that finds the shortest path, where one is wanted.
        self.exact = "auto" if config.planner.exact and planner is None else ""

    def mark(self, patch: Patch | None) -> bool:
        """Take in what changed on the planning map. Returns True if anything did."""
        if patch is not None:
            for planner in self.by_width:
                planner.mark(*patch)
        return patch is not None

    def forget(self) -> None:
        """Drop the obstacles sensed."""
        self.mark(self.planning_map.forget())

    def plan(self, start: Point, goal: Point, explored: bool, planner: str = "") -> Plan:
        """Plan with the largest clearance whose path is at most 3 % longer than the tightest plan.

        ``planner`` names another search than the configured one. A start too close to something
        for a roomy planner has to be led out of that by a way that the tightest can follow. Raises
        what the tightest planner raises.
        """
        tight = self._ask(self.by_width[-1], start, goal, explored, planner)
        for width in self.by_width[:-1]:
            try:
                plan = self._ask(width, start, goal, explored, planner)
            except (NoPath, GoalOccupied, StartOccupied):
                continue
            if plan.path.length > LONGER * tight.path.length:
                continue
            lead = plan.path.resampled(0.0, plan.clear_from, 1e9)
            if plan.clear_from == 0.0 or self.blocked_at(lead) is None:
                return plan
        return tight

    def blocked_at(self, points: npt.NDArray[np.float64]) -> float | None:
        """Metres along a polyline (n, 2) to where even the tightest planner could not go."""
        return self.by_width[-1].path_blocked_at(points)

    def _ask(
        self, width: GridPlanner, start: Point, goal: Point, explored: bool, planner: str
    ) -> Plan:
        """A plan of a planner's width, by that planner or by the one that stands in for all."""
        if self._planner is None:
            return width.plan(start, goal, explored, planner)
        blocked = self.planning_map.blocked.astype(np.int8)
        grid = OccupancyGrid(blocked * 100, self.planning_map.grid.frame)
        return plan_by(self._planner, grid, start, goal, width.radius)
