"""dynastar in navground (extra ``navground``): the behavior ``Dynastar``, and its parts.

Once this module is imported, an agent of a scenario may have it::

    kinematics: {type: 2WDiff, max_speed: 1.4, wheel_axis: 0.5}
    behavior: {type: Dynastar, optimal_speed: 1.0}
    state_estimation: {type: Lidar, range: 5.0, resolution: 361}
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from navground.core import Behavior, Frame, Kinematics, SensingState, Twist2

from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, RobotState, configured
from dynastar.robot import Lidar, Limits, Robot
from dynastar.scan import LaserScan

REVERSE, FOR_SPEED = 0.3, 0.8  # at most: m/s backwards; of the wheels' speed, without turning
FARTHEST = 20.0  # m ahead, at most, to a goal in a target's direction
BORDER, RESOLUTION = 10.0, 0.05  # m, of the map round position and goal
JUMP = 1.0  # m in a step, from which on a lattice has moved the agent


def robot_of(behavior: Behavior, lidar: Lidar, accel: float, turn: float) -> Robot:
    """The Robot of an agent, with the accelerations (m/s2, rad/s2) that navground does not limit."""
    kinematics: Any = behavior.kinematics
    v_max, omega_max = behavior.optimal_speed, behavior.max_angular_speed
    if kinematics.is_wheeled():
        v_max = min(v_max, FOR_SPEED * kinematics.max_speed)
        omega_max = min(omega_max, 2.0 * (kinematics.max_speed - v_max) / kinematics.wheel_axis)
    v_min = -min(REVERSE, getattr(kinematics, "max_backward_speed", 0.0))
    limits = Limits(v_max, omega_max, accel, turn, accel, turn, v_min=v_min)
    return Robot("navground", limits, Footprint.disc(behavior.radius), lidar)


def scan_of(state: SensingState, stamp: float) -> LaserScan:
    """The scan of an unnamed lidar; on a full circle the last beam repeats the first, and is dropped."""
    keys = ("start_angle", "fov", "max_range", "range")
    (start,), (fov,), (farthest,), ranges = (state.get_buffer(key).data for key in keys)
    step = fov / (len(ranges) - 1)
    ranges = np.maximum(ranges[: -1 if fov > math.tau - 1e-5 else None], 1e-3)
    return LaserScan(stamp, ranges, start, step, 0.0, farthest)


def lidar_of(scan: LaserScan) -> Lidar:
    """The Lidar that such a scan comes from."""
    fov = math.tau if scan.full_circle else scan.angle_increment * (len(scan.ranges) - 1)
    return Lidar(len(scan.ranges), fov, 0.0, scan.range_max, theta=scan.angle_min + 0.5 * fov)


def twist_of(behavior: Behavior) -> Twist:
    """Speed ahead and turning rate of an agent."""
    twist = behavior.get_twist(Frame.relative)
    return Twist(float(twist.velocity[0]), twist.angular_speed)


class DynastarBehavior(Behavior, name="Dynastar"):  # type: ignore[call-arg, misc]
    """Drives to a target's position (and heading), or in its direction; its speed is not heeded.

    Before the first step, ``settings`` (the navigator's, as nested tables) and ``accelerations`` (m/s2,
    rad/s2) may be set. ``navigator`` is there for its status from then on.
    """

    def __init__(self, kinematics: Kinematics | None = None, radius: float = 0.0) -> None:
        super().__init__(kinematics, radius)
        self.settings: Mapping[str, Any] = {}
        self.navigator: Navigator | None = None
        self.accelerations, self._time, self._state = (1.0, 3.0), 0.0, SensingState()
        self._goal: Goal | None = None
        self._shift = self._last = np.zeros(2)

    def get_environment_state(self) -> SensingState:
        """What the lidar writes into."""
        return self._state

    def compute_cmd_internal(self, time_step: float) -> Twist2:
        """The command of this step."""
        here = self.pose.position.astype(np.float64)
        if self.navigator is not None and math.dist(here, self._last) > JUMP:
            self._shift = self._shift + self._last - here  # a lattice has moved the agent
        self._last = here
        (x, y), scan = (here + self._shift).tolist(), scan_of(self._state, self._time)
        state = RobotState(self._time, Pose2D(x, y, self.pose.orientation), twist_of(self))
        command = self._aim(state.pose, scan, time_step).command(state, scan)
        self._time += time_step
        return Twist2((command.v, 0.0), command.omega, frame=Frame.relative)

    def _aim(self, pose: Pose2D, scan: LaserScan, period: float) -> Navigator:
        """The navigator, with the present target as its goal."""
        target, goal = self.target, self._goal
        if target.position is not None:
            x, y = (target.position + self._shift).tolist()
            goal = Goal(x, y, target.orientation and wrap_angle(target.orientation))
        elif target.direction is None:
            goal = None
        elif np.dot(np.subtract((goal or pose)[:2], pose[:2]), target.direction) < 0.5 * FARTHEST:
            goal = Goal(*(pose[:2] + FARTHEST * target.direction).tolist())
        if self.navigator is not None and goal == self._goal:
            return self.navigator
        grid, self._goal = free_map(pose, goal or Goal(*pose)), goal
        if self.navigator is None:
            robot = robot_of(self, lidar_of(scan), *self.accelerations)
            own = {"period": period, "goal_tolerance": max(target.position_tolerance, 0.05)}
            self.navigator = Navigator(grid, robot, configured("default", {**own, **self.settings}))
        self.navigator.set_map(grid)
        self.navigator.set_goal([] if goal is None else goal)
        return self.navigator


def free_map(pose: Pose2D, goal: Goal) -> OccupancyGrid:
    """A map without obstacles round a pose and a goal: navground's agents have none."""
    low, high = np.minimum(pose[:2], goal[:2]) - BORDER, np.maximum(pose[:2], goal[:2]) + BORDER
    occupied = np.zeros(np.ceil((high - low) / RESOLUTION).astype(int)[::-1], dtype=bool)
    return OccupancyGrid.from_occupied(occupied, RESOLUTION, *low.tolist())
