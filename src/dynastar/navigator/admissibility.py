"""What a command is checked against: margins, and the surroundings that a stop keeps clear of."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.dwa.clearance import kept_margin
from dynastar.dwa.dwa import DynamicWindow
from dynastar.dwa.motion import state_at
from dynastar.dwa.scene import Surroundings
from dynastar.geometry import Pose2D
from dynastar.navigator.arrival import GENTLE_BRAKING
from dynastar.navigator.config import NavigatorConfig, margin_of
from dynastar.navigator.sensing import View
from dynastar.perception.planning_map import PlanningMap
from dynastar.perception.prediction import DISCOUNTED, Times
from dynastar.robot import Robot


class Admissibility:
    """One robot's dynamic window, and what it needs to tell which commands are admissible.

    ``margin`` (m) is kept from closed space: the declared errors.
    """

    def __init__(self, robot: Robot, config: NavigatorConfig) -> None:
        self.robot, self.config, self.margin = robot, config, margin_of(robot, config)
        self.window = DynamicWindow(robot, config.dwa, config.period, config.drive_error)

    @property
    def times(self) -> Times:
        """The times of the prediction: those of roll-outs from when a command acts.

        What a robot that brakes slowly cannot stop for any more counts for as long as it takes.
        """
        schedule, limits = self.window.rules.schedule, self.robot.limits
        discounted = max(DISCOUNTED, 0.5 * limits.v_max / limits.v_brake)
        return Times(self.config.latency, schedule.period, int(schedule.step[-1]), discounted)

    def margin_at(self, v: float) -> float:
        """The margin (m) at a speed (m/s): an error of the heading counts over the way of a stop."""
        config, period = self.config, self.window.rules.period
        stop = v**2 / (2.0 * self.robot.limits.v_brake) + abs(v) * (config.latency + 2.0 * period)
        return self.margin + config.heading_error * stop

    def surroundings(self, pose: Pose2D, v: float, view: View) -> Surroundings:
        """What stops keep clear of, for a robot at ``pose`` when a command acts, and at ``v`` now (m/s)."""
        at = state_at(*pose, 0.0, 0.0).pose
        return Surroundings(
            closed=view.closed,
            moving=view.moving,
            hidden=view.hidden,
            margin_to_closed=kept_margin(
                view.closed, self.window.rules.body, self.margin_at(v), at
            ),
            latency=self.config.latency,
        )

    def speed_cap(
        self, pose: Pose2D, line: npt.NDArray[np.float64], spacing: float, planning_map: PlanningMap
    ) -> float:
        """The speed (m/s) that leaves room to slow down for the map's speed limits ahead.

        ``line`` (n, 2) are the points that come, ``spacing`` (m) apart, the first beside the robot.
        """
        limits = self.robot.limits
        if planning_map.grid.speed_limit is None:
            return limits.v_max
        ahead = np.maximum(np.arange(len(line)) - 1.0, 0.0) * spacing
        limit = planning_map.speed_limit(np.vstack([[pose.x, pose.y], line]))
        slowed = np.sqrt(limit[1:] ** 2 + 2.0 * GENTLE_BRAKING * limits.v_brake * ahead)
        return float(min(limits.v_max, limit[0], slowed.min(initial=math.inf)))
