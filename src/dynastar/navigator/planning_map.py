"""The map that global plans are made on: the map, finer if need be, and what was seen since."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.clearance import inflate
from dynastar.errors import GoalOccupied, NoPath, StartOccupied
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.planning_map_kernels import cells_under, stands_under, take_over
from dynastar.perception import Known, LocalMap
from dynastar.planning import GridPlanner, Plan, Planner, plan_by

Mask = npt.NDArray[np.bool_]
Cells = npt.NDArray[np.int64]
Point = tuple[float, float]
Window = tuple[Cells, Cells, Cells]

ROUNDED = 1e-6  # by which a resolution is off that has been a float32, as in ROS's messages
LONGER = 1.03  # times the tightest plan's length, a plan with room to spare is too long


class PlanningMap:
    """Plans on the map and the obstacles seen, with room to spare where there is room.

    One planner keeps ``comfort`` more clearance than the first of ``radii`` (m), one that, and one the
    second. Where a roomier finds no way, or only a longer one, the plan is that of the next. A
    ``planner`` given is asked in their place, for the same radii.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        config: NavigatorConfig,
        radii: tuple[float, float],
        planner: Planner | None = None,
    ) -> None:
        factor = math.ceil(grid.resolution / config.planning_resolution - ROUNDED)
        self.grid = grid.refined(factor)
        self.frame = self.grid.frame
        self.prior = self.grid.blocked(config.unknown)
        self._unknown = self.grid.unknown
        if self.grid.keepout is not None:
            self._unknown = self._unknown & ~self.grid.keepout
        roomy, tight = radii
        widths = sorted({roomy + config.comfort, roomy, tight}, reverse=True)
        self.planners = [
            GridPlanner(self.grid, r, config.unknown, config.planner, factor) for r in widths
        ]
        self._planner = planner
        # The search that finds the shortest path, where one is wanted.
        self.exact = "auto" if config.planner.exact and planner is None else ""
        self.seen = np.zeros(self.prior.shape, np.bool_)
        self.cleared = np.zeros(self.prior.shape, np.bool_)
        self._marks = np.zeros(self.prior.size + 1, np.uint8)
        self._under: tuple[tuple[float, float], Window] | None = None
        near = inflate(self.grid.occupied, 1.0, outside_blocked=True)
        self.known = Known(near, self.frame)

    @property
    def blocked(self) -> Mask:
        """Blocked cells: of the map and of what was sensed."""
        return (self.prior & ~self.cleared) | self.seen

    def take_in(self, layer: LocalMap) -> bool:
        """Marks what the local map shows occupied and clears what it shows free; whether that changed."""
        top, bottom, left, right = take_over(
            layer.states, self._window(layer),
            self._marks, self.known.mask, self._unknown, self.seen, self.cleared,
        )  # fmt: skip
        if bottom <= top:
            return False
        self._mark(top, bottom, left, right)
        return True

    def stands_in(self, layer: LocalMap) -> Mask:
        """Whether something is in each of a local map's cells: seen there, mapped, or off the map."""
        under = self._window(layer)[2]
        stands = np.empty(under.shape, np.bool_)
        stands_under(layer.states, under, self.prior, self.seen, self.cleared, stands)
        return stands

    def on_free_ground(self, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Select the points (n, 2 or more), metres, on free cells of the map."""
        cells = np.floor(self.frame.points_to_grid(points[:, :2])).astype(np.int64)
        inside = ((cells >= 0) & (cells < self.prior.shape)).all(axis=1)
        rows, columns = cells[inside].T
        return points[inside][~self.grid.occupied[rows, columns]]

    def forget(self) -> None:
        """Drops everything seen."""
        rows, columns = np.nonzero(self.seen)
        self.seen[:] = False
        if len(rows):
            self._mark(rows.min(), rows.max() + 1, columns.min(), columns.max() + 1)

    def plan(self, start: Point, goal: Point, explored: bool, planner: str = "") -> Plan:
        """The roomiest plan that is as short as any; raises what the tightest planner raises.

        ``planner`` names another search than the configured one. A start too close to something
        for a roomy planner has to be led out of that by a way that the tightest can follow.
        """
        tight = self._ask(self.planners[-1], start, goal, explored, planner)
        for width in self.planners[:-1]:
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

    def _ask(
        self, width: GridPlanner, start: Point, goal: Point, explored: bool, planner: str
    ) -> Plan:
        """A plan of a planner's width, by that planner or by the one that stands in for all."""
        if self._planner is None:
            return width.plan(start, goal, explored, planner)
        grid = OccupancyGrid(self.blocked.astype(np.int8) * 100, self.frame)
        return plan_by(self._planner, grid, start, goal, width.radius)

    def blocked_at(self, points: npt.NDArray[np.float64]) -> float | None:
        """Metres along a polyline (n, 2) to where even the tightest planner could not go."""
        return self.planners[-1].path_blocked_at(points)

    def speed_limit(self, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """The map's speed limit (m/s, inf for none) at points (n, 2)."""
        limits = np.full(len(points), np.inf)
        if self.grid.speed_limit is not None:
            cells = np.floor(self.frame.points_to_grid(points)).astype(np.int64)
            inside = ((cells >= 0) & (cells < self.prior.shape)).all(axis=1)
            limits[inside] = self.grid.speed_limit[cells[inside, 0], cells[inside, 1]]
        return limits

    def _window(self, layer: LocalMap) -> Window:
        """The chart's cells [low, high) under a local map, and the index of the one under each of its."""
        if self._under is not None and self._under[0] == layer.origin:
            return self._under[1]
        window = cells_under(
            len(layer.states), layer.config.resolution, layer.origin,
            tuple(map(float, self.frame)), self.prior.shape,
        )  # fmt: skip
        self._under = layer.origin, window
        return self._under[1]

    def _mark(self, top: int, bottom: int, left: int, right: int) -> None:
        part = np.s_[top:bottom, left:right]
        patch = (self.prior[part] & ~self.cleared[part]) | self.seen[part]
        for planner in self.planners:
            planner.mark(int(top), int(left), patch)
