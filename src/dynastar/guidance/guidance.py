"""The cost-to-go over the local map, joined to the global path's remaining length."""

import math
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.clearance import lower_bounds
from dynastar.field import Field, blocks
from dynastar.guidance.cost_to_go import CostToGo, End, trace, value_at, with_descent
from dynastar.guidance.marching import Seed, extend, march, queue_for
from dynastar.guidance.seed import nearest_open, path_exit_cell
from dynastar.guidance.travel_cost import Encounter, add_encounters, travel_cost
from dynastar.path import Path
from dynastar.perception.prediction import Prediction

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

COARSENING = 2  # cells of the local map to one of the cost-to-go
KNOWN_BEYOND = 3.0  # m that the cost-to-go is known beyond the robot
OFF_PATH_COST = 6.0  # extra cost of a metre 1 m or more beside a path that is kept to
PATH_CELLS = 1  # cells beside the path where the robot may be
ROUNDING = 1e-6  # m, for points on the border of two cells
OPEN_WITHIN = 6  # cells to the nearest one where the robot fits, at most


class PathTarget(NamedTuple):
    """A path and the arc length ``s`` (m) of the robot on it.

    ``ahead`` (m) is finite only for a path given by the user: lateral deviation then costs, and the
    path beyond is ignored.
    """

    path: Path
    s: float
    ahead: float = math.inf

    @property
    def is_given(self) -> bool:
        """True for a path given by the user."""
        return self.ahead < math.inf


class Guide(NamedTuple):
    """The way to the goal over the local map.

    ``distance_to_path`` is to the path ahead, ``line`` (n, 2) the descent from the robot, ``reachable``
    tells whether a way leads from the robot to where the path leaves the local map.
    """

    cost_to_go: CostToGo
    distance_to_path: Field
    line: Floats
    reachable: bool

    def cost_at(self, x: float, y: float) -> float:
        """Metres left to the goal from a point."""
        return float(value_at(self.cost_to_go, x, y))


class Guidance:
    """Computes the cost-to-go of the present path.

    ``keep_to_path`` asks for the distances to planned paths, too (needed for sigma > 0).
    """

    def __init__(
        self, cells: int, resolution: float, margin: float, comfort: float, keep_to_path: bool
    ) -> None:
        self.resolution, self._cells = resolution * COARSENING, cells // COARSENING  # along a side
        self._margin, self._comfort, self._keep_to_path = margin, comfort, keep_to_path
        self._queue = queue_for(self._cells**2)

    def update(
        self,
        obstacles: Field,
        closed: Mask,
        target: PathTarget,
        moving: Prediction,
        encounter: Encounter,
    ) -> Guide:
        """The way to the goal for a robot at the place of ``encounter``.

        ``obstacles`` are distances to the local map's obstacles, ``closed`` (cells, cells) where the
        planner does not fit, which is closed here as well, except along the path.
        """
        a, x0, y0 = self.resolution, obstacles.x0, obstacles.y0
        metre = travel_cost(obstacles.values, COARSENING, self._margin, self._comfort)
        off_path = self._off_path(target, x0, y0, PATH_CELLS)
        metre[blocks(np.logical_and, closed, COARSENING) & off_path] = np.inf
        cost, to_path = Field(metre, x0, y0, a), obstacles
        if target.is_given or self._keep_to_path:
            off_path = self._off_path(target, x0, y0)
            to_path = Field(lower_bounds(off_path.view(np.uint8), a), x0, y0, a)
        if target.is_given:
            metre += OFF_PATH_COST * np.minimum(to_path.values, 1.0)
        add_encounters(cost, moving, encounter)
        stop = self._cell_of(encounter, cost)
        seed = self._seed(target, cost)
        value = march(metre, a, seed, stop, KNOWN_BEYOND, self._queue)
        x, y = x0 + (seed.column + 0.5) * a + seed.right, y0 + (seed.row + 0.5) * a + seed.up
        end = End(x, y, seed.value, seed.per_metre)
        cost_to_go = with_descent(Field(value, x0, y0, a), extend(value, a), end)
        line = trace(cost_to_go, encounter.x, encounter.y, self._cells)
        return Guide(cost_to_go, to_path, line, reachable=bool(np.isfinite(value[stop])))

    def _cell_of(self, encounter: Encounter, cost: Field) -> tuple[int, int]:
        """The cell of the robot, or the nearest where it fits; the robot is in the local map."""
        row, column = (
            min(max(int(metres / self.resolution), 0), self._cells - 1)
            for metres in (encounter.y - cost.y0, encounter.x - cost.x0)
        )
        return nearest_open(cost.values, row, column, OPEN_WITHIN)

    def _off_path(self, target: PathTarget, x0: float, y0: float, beside: int = 0) -> Mask:
        """The cells that the path ahead does not lead through, nor so many cells ``beside``."""
        a = self.resolution
        end = target.s + min(target.ahead, a * self._cells)
        points = target.path.resampled(target.s, end, a)
        cells = np.round((points - (x0, y0)) / a - 0.5).astype(np.int32)
        off = np.ones((self._cells, self._cells), np.uint8)
        cv2.polylines(off, [cells], False, 0, 1 + 2 * beside)
        return off.view(np.bool_)

    def _seed(self, target: PathTarget, cost: Field) -> Seed:
        """Where the path leaves the local map, or ends, and the length (m) left from there."""
        path, a = target.path, self.resolution
        span = target.s, min(path.length, target.s + target.ahead)
        row, column, s = path_exit_cell(path.points, path.arc, span, cost, OPEN_WITHIN // 2)
        x, y = path.at(s)
        right, up = x - cost.x0 - (column + 0.5) * a, y - cost.y0 - (row + 0.5) * a
        if max(abs(right), abs(up)) > 0.5 * a + ROUNDING:
            right = up = 0.0  # the robot does not fit at the point itself, but in a cell near by
        metre = float(cost.values[row, column])
        return Seed(row, column, path.length - s, right, up, metre if metre < np.inf else 1.0)
