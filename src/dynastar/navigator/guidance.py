"""The cost-to-go over the local map, joined to the global path's remaining length."""

import math
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.clearance import DistanceField, lower_bounds
from dynastar.dwa.cost_to_go import (
    add_moving,
    descend,
    favour,
    leave,
    nearest_open,
    trace,
    travel_cost,
    value_at,
)
from dynastar.dwa.marching import extend, march, queue_for
from dynastar.dwa.scene import CostToGo
from dynastar.path import Path
from dynastar.perception.prediction import People

Floats = npt.NDArray[np.float64]
Point = tuple[float, float]

FACTOR = 2  # cells of the local map to one of the cost-to-go
FAVOUR = 0.85  # of the cost along the line that was followed before, so that it is kept to
LINE = 50  # points of that line
BEYOND = 3.0  # m that the cost-to-go is known beyond the robot
BESIDE = 6.0  # extra cost of a metre 1 m or more beside a path that is kept to
NEAR = 6  # cells to the nearest one where the robot fits, at most


class Lead(NamedTuple):
    """The path that leads a robot, ``s`` (m) along it.

    With ``ahead`` (m) finite it is kept to, and only so much of it counts.
    """

    path: Path
    s: float
    ahead: float = math.inf


class Guidance:
    """Keeps the cost-to-go of the present path; its arrays are made once.

    With ``simi`` the distances to the path are those to any path, else only to one that is given.

    ``reachable`` tells whether a way leads from the robot to where the path leaves the local map.
    """

    def __init__(
        self, cells: int, resolution: float, margin: float, comfort: float, simi: bool = False
    ) -> None:
        n = cells // FACTOR
        self.spacing = resolution * FACTOR
        self._margin, self._comfort, self._simi = margin, comfort, simi
        self._cost, self._filled = np.empty((n, n)), np.empty((n, n))
        self._value, self._slope = np.full((n, n), np.inf), np.empty((n, n, 2))
        self._queue = queue_for(n * n)
        self._line, self._count = np.empty((LINE, 2)), 0
        self.reachable = False
        self._field: CostToGo | None = None

    @property
    def line(self) -> Floats:
        """Points (n, 2), ``spacing`` metres apart, along the descent from the robot."""
        return self._line[: self._count]

    def cost_to_go(self, x: float, y: float) -> float:
        """Metres left to the goal from a point, by the last update; inf before the first."""
        return math.inf if self._field is None else float(value_at(self._field, x, y))

    def update(
        self,
        obstacles: DistanceField,
        lead: Lead,
        here: Point,
        people: People,
        meeting: tuple[float, float, float, float],
    ) -> tuple[DistanceField, CostToGo]:
        """Distances to the path ahead, and the cost-to-go for a robot at ``here``.

        ``obstacles`` are distances to the local map's obstacles. ``meeting`` says when and how the
        robot meets moving obstacles: the predictions' begin and step (s), its speed (m/s), its
        radius (m).
        """
        distance, x0, y0, _ = obstacles
        a, n = self.spacing, len(self._cost)
        travel_cost(distance, FACTOR, self._margin, self._comfort, self._cost)
        given = lead.ahead < math.inf
        beside = self._distances_to(lead, x0, y0) if given or self._simi else obstacles
        if given:
            self._cost += BESIDE * np.minimum(beside.distance, 1.0)
        begin, step, speed, radius = meeting
        robot = (float(here[0]), float(here[1]))
        add_moving(self._cost, (a, x0, y0), people, (begin, step), robot, radius, speed)
        favour(self._cost, (a, x0, y0), self.line, FAVOUR)
        row = min(max(int((here[1] - y0) / a), 0), n - 1)
        column = min(max(int((here[0] - x0) / a), 0), n - 1)
        stop = nearest_open(self._cost, row, column, NEAR)
        seed = self._seed(lead, x0, y0)
        march(self._cost, a, seed, stop, BEYOND, self._value, self._queue)
        self.reachable = bool(np.isfinite(self._value[stop]))
        extend(self._value, a, self._filled)
        descend(self._value, self._filled, self._slope)
        cost_to_go = CostToGo(self._value, self._filled, self._slope, x0, y0, a)
        self._field = cost_to_go
        self._count = trace(cost_to_go, *robot, self._line)
        return beside, cost_to_go

    def _distances_to(self, lead: Lead, x0: float, y0: float) -> DistanceField:
        """Distances (m) to the part of the path that lies ahead in the local map."""
        a = self.spacing
        points = lead.path.resampled(lead.s, lead.s + min(lead.ahead, a * len(self._cost)), a)
        cells = np.round((points - (x0, y0)) / a - 0.5).astype(np.int32)
        off = np.ones(self._cost.shape, np.uint8)
        cv2.polylines(off, [cells], False, 0)
        return DistanceField(lower_bounds(off, a), x0, y0, a)

    def _seed(self, lead: Lead, x0: float, y0: float) -> tuple[int, int, float]:
        """The cell where the path leaves the local map, or ends, and the length (m) left from there."""
        path, s = lead.path, lead.s
        span = s, min(path.length, s + lead.ahead)
        row, column, at = leave(
            path.points, path.arc, span, self._cost, (self.spacing, x0, y0), NEAR // 2
        )
        return int(row), int(column), path.length - float(at)
