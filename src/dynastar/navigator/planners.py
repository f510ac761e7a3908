"""The planners of a navigator: one search for each of several clearances."""

import numpy as np
import numpy.typing as npt

from dynastar.errors import GoalOccupied, NoPath, PlanningError, StartOccupied
from dynastar.footprint import Footprint
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.waiting_place import waiting_place, ways_to
from dynastar.perception import LocalMap
from dynastar.perception.planning_map import Patch, PlanningMap
from dynastar.planning import GridPlanner, Plan, Planner, plan_by
from dynastar.planning.external import check_planner

Mask = npt.NDArray[np.bool_]
Cells = npt.NDArray[np.int32]
Point = tuple[float, float]

PLAN_MARGIN = 0.03  # m beyond the footprint that a plan keeps clear, at least
LONGER = 1.03  # times the tightest plan's length, a plan with room to spare is too long


def radii_of(footprint: Footprint, margin: float) -> tuple[float, float]:
    """The radii (m) of a roomy plan, which lets the robot turn everywhere, and of the tightest.

    ``margin`` (m) is that of the footprint from obstacles.
    """
    return footprint.circumscribed + margin, footprint.half_gap + max(margin, PLAN_MARGIN)


class Planners:
    """Plans on a planning map, with room to spare where there is room, up to the goal's tolerance.

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
        self.planning_map, self.tolerance = planning_map, config.goal_tolerance
        # The robot rests near the end of its path, not on it: two cells are left for that.
        cell, _ = planning_map.lattice
        self._roomy_tolerance = max(0.0, self.tolerance - 2.0 * cell)
        roomy, tight = radii
        self.by_width = [
            GridPlanner(
                planning_map.grid, radius, config.unknown, config.planner, planning_map.factor
            )
            for radius in sorted({roomy + config.comfort, roomy, tight}, reverse=True)
        ]
        check_planner(planner)
        self._planner = planner
        # The search that finds the shortest path, where one is wanted.
        self.exact = "auto" if config.planner.exact and planner is None else ""

    def mark(self, patch: Patch | None) -> bool:
        """Update the planners where the planning map changed. Returns True if anything did."""
        if patch is not None:
            for planner in self.by_width:
                planner.mark(*patch)
        return patch is not None

    def forget(self) -> None:
        """Drop the obstacles sensed."""
        self.mark(self.planning_map.forget())

    def plan(self, start: Point, goal: Point, planner: str = "") -> Plan:
        """Plan with the largest clearance whose path is at most 3 % longer than the tightest plan.

        ``planner`` names another search than the configured one. A start too close to something
        for a roomy planner has to be led out of that by a way that the tightest can follow. Where
        only sensed obstacles keep the robot from the goal, the plan ends where it waits for that.
        Raises what the tightest planner raises, or GoalObstructed if the robot is to wait where it
        is. A start that only sensed obstacles occupy is a NoPath.
        """
        try:
            tight = self._ask(self.by_width[-1], start, goal, planner)
        except StartOccupied as error:
            if ways_to(self.planning_map, start, self.by_width[-1].radius, 0.0) is None:
                raise
            raise NoPath(str(error)) from None  # what was sensed is in the way, and may go
        except (NoPath, GoalOccupied) as error:
            place = self._waiting_place(start, goal, error)
            return self._ask(self.by_width[-1], start, place, planner)
        for width in self.by_width[:-1]:
            try:
                plan = self._ask(width, start, goal, planner)
            except (NoPath, GoalOccupied, StartOccupied):
                continue
            if plan.path.length > LONGER * tight.path.length:
                continue
            lead = plan.path.part(0.0, plan.clear_from)
            if plan.clear_from == 0.0 or self.blocked_at(lead) is None:
                return plan
        return tight

    def _waiting_place(self, start: Point, goal: Point, error: PlanningError) -> Point:
        """Where to wait for the goal. Raises ``error`` if the map alone rules the goal out."""
        ways = ways_to(self.planning_map, goal, self.by_width[-1].radius, self.tolerance)
        if ways is None or not self.planning_map.seen.any():
            raise error
        place = waiting_place(ways, self.by_width, start)
        if place is None:
            raise NoPath(str(error))
        return place

    def blocked_at(self, points: npt.NDArray[np.float64]) -> float | None:
        """Metres along a polyline (n, 2) to where even the tightest planner could not go."""
        return self.by_width[-1].path_blocked_at(points)

    def closed_under(self, local_map: LocalMap) -> Mask:
        """Cells (n, n) of a local map where even the tightest planner does not fit."""
        return ~self.planning_map.under(self.by_width[-1].free, local_map, outside=False)

    def explored(self, plan: Plan | None) -> Cells:
        """The cells (m, 2) that the search of the last plan expanded, row by row; none of a user's."""
        if plan is None or self._planner is not None:
            return np.empty((0, 2), np.int32)
        [width] = (width for width in self.by_width if width.radius == plan.radius)
        return width.explored

    def _ask(self, width: GridPlanner, start: Point, goal: Point, planner: str) -> Plan:
        """A plan of a planner's width, or the plan of the user's planner."""
        is_tight = width is self.by_width[-1]
        tolerance = self.tolerance if is_tight else self._roomy_tolerance
        if self._planner is None:
            return width.plan(start, goal, planner=planner, tolerance=tolerance)
        grid = OccupancyGrid(self.planning_map.blocked, self.planning_map.grid.frame)
        return plan_by(self._planner, grid, start, goal, width.radius, tolerance)
