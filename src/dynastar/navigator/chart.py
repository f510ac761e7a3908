"""The chart that global plans are made on: the map, finer if need be, and what was seen since."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.clearance import inflate
from dynastar.errors import GoalOccupied, NoPath, StartOccupied
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import NavigatorConfig
from dynastar.obstacles import Known, ObstacleLayer
from dynastar.obstacles.layer import SEEN_FREE, SEEN_OCCUPIED
from dynastar.planning import GridPlanner, Plan

Mask = npt.NDArray[np.bool_]


class Chart:
    """Plans on the map and the obstacles seen, with room to spare where there is room.

    One planner keeps ``comfort`` more clearance than the footprint needs; where it finds no way the
    other, which keeps what a certified stop needs and no more, is asked.
    """

    def __init__(
        self, grid: OccupancyGrid, config: NavigatorConfig, radius: float, tight: float
    ) -> None:
        factor = math.ceil(grid.resolution / config.planning_resolution - 1e-9)
        self.grid = grid.refined(factor)
        self.frame = self.grid.frame
        self.prior = self.grid.blocked(config.unknown)
        self._unknown = self.grid.unknown
        if self.grid.keepout is not None:
            self._unknown = self._unknown & ~self.grid.keepout
        radii = sorted({radius + config.comfort, radius, tight}, reverse=True)
        self.planners = [GridPlanner(self.grid, r, config.unknown, config.planner) for r in radii]
        self.seen = np.zeros(self.prior.shape, np.bool_)
        self.cleared = np.zeros(self.prior.shape, np.bool_)
        near = inflate(self.grid.occupied, 1.0, outside_blocked=False)
        self.known = Known(near, self.frame)

    @property
    def blocked(self) -> Mask:
        """What stands in the way: the map's and the seen."""
        return (self.prior & ~self.cleared) | self.seen

    def take_in(self, layer: ObstacleLayer) -> bool:
        """Marks what the layer shows occupied and clears what it shows free; whether that changed."""
        a = layer.config.resolution
        x0, y0 = layer.origin
        low, high = self._window(layer)
        if (high <= low).any():
            return False
        part = np.s_[low[0] : high[0], low[1] : high[1]]
        occupied, free = np.zeros((2, *(high - low)), np.bool_)
        for state, target in ((SEEN_OCCUPIED, occupied), (SEEN_FREE, free)):
            rows, columns = np.nonzero(layer.states == state)
            points = np.column_stack([(columns + 0.5) * a + x0, (rows + 0.5) * a + y0])
            cells = np.floor(self.frame.points_to_grid(points)).astype(np.int64) - low
            cells = cells[((cells >= 0) & (cells < high - low)).all(axis=1)]
            target[cells[:, 0], cells[:, 1]] = True
        occupied &= ~self.known.mask[part]
        seen = occupied | (self.seen[part] & ~free)
        cleared = (self.cleared[part] | free) & self._unknown[part]
        changed = (seen != self.seen[part]) | (cleared != self.cleared[part])
        if not changed.any():
            return False
        self.seen[part], self.cleared[part] = seen, cleared
        self._mark(changed, low)
        return True

    def forget(self) -> None:
        """Drops everything seen."""
        changed = self.seen.copy()
        self.seen[:] = False
        if changed.any():
            self._mark(changed, np.zeros(2, np.int64))

    def plan(self, start: tuple[float, float], goal: tuple[float, float], explored: bool) -> Plan:
        """The roomiest plan there is; raises what the tightest planner raises if there is none.

        A start too close to something for a roomy planner has to be led out of that by a way that
        the tightest can follow.
        """
        for planner in self.planners[:-1]:
            try:
                plan = planner.plan(start, goal, explored=explored)
            except (NoPath, GoalOccupied, StartOccupied):
                continue
            lead = plan.path.resampled(0.0, plan.clear_from, 1e9)
            if plan.clear_from == 0.0 or self.blocked_at(lead) is None:
                return plan
        return self.planners[-1].plan(start, goal, explored=explored)

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

    def _window(self, layer: ObstacleLayer) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        side = len(layer.states) * layer.config.resolution
        x0, y0 = layer.origin
        corners = [(x0, y0), (x0 + side, y0), (x0, y0 + side), (x0 + side, y0 + side)]
        cells = self.frame.points_to_grid(corners)
        low = np.maximum(np.floor(cells.min(axis=0)).astype(np.int64), 0)
        high = np.minimum(np.ceil(cells.max(axis=0)).astype(np.int64), self.prior.shape)
        return low, high

    def _mark(self, changed: Mask, low: npt.NDArray[np.int64]) -> None:
        rows, columns = np.nonzero(changed)
        first = low + np.array([rows.min(), columns.min()])
        last = low + np.array([rows.max() + 1, columns.max() + 1])
        part = np.s_[first[0] : last[0], first[1] : last[1]]
        patch = (self.prior[part] & ~self.cleared[part]) | self.seen[part]
        for planner in self.planners:
            planner.mark(int(first[0]), int(first[1]), patch)
