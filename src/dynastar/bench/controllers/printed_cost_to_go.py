"""``printed`` with a cost-to-go for the heading to a target: a step from print to robot."""

import math
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.bench.controllers.costmap import PADDING
from dynastar.bench.controllers.printed import Floats, PrintedReplanning, Trajectories
from dynastar.clearance import lower_bounds
from dynastar.geometry import Pose2D
from dynastar.guidance.cost_to_go import KNOWN
from dynastar.guidance.marching import Seed, extend, march, queue_for
from dynastar.navigator import RobotState

CELL = 0.1  # m, about the side of the cells of the cost-to-go
EVERY = 1.0  # s after which it is made anew
Layer = npt.NDArray[np.float32]

BEYOND = 4.5  # m that it is known beyond the robot: as far as an arc of 3 s leads at 1.5 m/s


class PrintedCostToGo(PrintedReplanning):
    """The second reading with the progress along a cost-to-go in place of ``heading``.

    The cost-to-go is the length (m) of the shortest way to the goal that is free for the robot's disc, on
    the map and in what the scans show.
    """

    def __init__(self, *given: Any, **more: Any) -> None:
        super().__init__(*given, **more)
        self._side = max(1, round(CELL / self.costmap.resolution))  # cells of the costmap to one
        self._layers: list[Layer] = []  # the values, 0 where not known; where known; extended
        self._made = -math.inf, (math.nan, math.nan)

    def towards(self, state: RobotState, end: Trajectories, path: Floats) -> Floats:
        """How much nearer (m) to the goal the end points are than the robot; 0 where they are not."""
        goal = self._goals[0]
        if state.stamp >= self._made[0] + EVERY or goal[:2] != self._made[1]:
            self._layers = self._distances(state.pose, goal[:2])
            self._made = state.stamp, goal[:2]
        here, *there = self._read(np.append(state.pose.x, end.x), np.append(state.pose.y, end.y))
        return np.maximum(here - np.array(there), 0.0)

    def _distances(self, pose: Pose2D, goal: tuple[float, float]) -> list[Layer]:
        """The cost-to-go of each cell: its layers."""
        side, fine = self._side, self.costmap.resolution
        room = lower_bounds((~self.costmap.blocked).view(np.uint8), fine) - 0.5 * fine
        fits = room >= self.robot.footprint.circumscribed + PADDING
        cost = np.where(fits[side // 2 :: side, side // 2 :: side], 1.0, np.inf)
        (row, stop_row), (column, stop_column) = (
            np.clip(np.floor(axis).astype(int), 1, most - 2)
            for axis, most in zip(
                self._cells(*np.array([goal, pose[:2]]).T), cost.shape, strict=True
            )
        )
        cost[row, column] = 1.0
        stop = int(stop_row), int(stop_column)
        resolution = side * fine
        seed = Seed(int(row), int(column), 0.0)
        value = march(cost, resolution, seed, stop, BEYOND, queue_for(cost.size))
        known = np.isfinite(value)
        layers = np.where(known, value, 0.0), known, extend(value, resolution)
        return [layer.astype(np.float32) for layer in layers]

    def _cells(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Rows and columns of points (m): cell (0, 0) is from 0 to 1."""
        cells = self.costmap.grid.frame.points_to_grid(np.column_stack([x, y])) / self._side
        return cells[:, 0], cells[:, 1]

    def _read(self, x: Floats, y: Floats) -> Floats:
        """The cost-to-go at points (m), bilinear between the cells where it is known."""
        rows, columns = (axis.astype(np.float32) - 0.5 for axis in self._cells(x, y))
        total, weight, beyond = (
            cv2.remap(layer, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            for layer in self._layers
        )
        read = np.where(weight > KNOWN, total / np.maximum(weight, KNOWN), beyond)
        return np.asarray(read.ravel(), np.float64)
