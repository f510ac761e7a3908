"""Controllers that know nothing of obstacles, alone, behind a guard, and behind zones round the robot.

``straight`` drives straight to the goal, ``random`` holds random speeds, ``adversary`` drives at the
nearest obstacle, and at others when it gets no nearer. The last two give up after DURATION.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dynastar.bench.controllers.monitor import Monitor
from dynastar.bench.controllers.status import Status
from dynastar.geometry import Goal, Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Guard, Guarded, RobotState
from dynastar.robot import Robot
from dynastar.scan import LaserScan

DURATION = 15.0  # s that a controller without a goal drives
HELD = 2.0  # s for which random speeds are held at the longest
AT_NEAREST, AT_ANOTHER = 3.0, 2.0  # s for which the adversary drives at the nearest, and at another
TURNING_GAIN = 2.0  # 1/s
SLOWING_GAIN = 1.0  # 1/s, of the distance to the goal


class Driver(ABC):
    """Drives without a look at obstacles; ``safe`` may change its commands."""

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: Any) -> None:
        del grid
        self.robot, self.config, self.status = robot, config, Status()

    def set_goal(self, goals: Sequence[Goal]) -> None:
        """The goals, of which the last counts. They also seed what is random."""
        self.goal = goals[-1]
        self.random = np.random.default_rng([abs(int(1e3 * at)) for at in self.goal[:2]])
        self.status = replace(self.status, state="following", reason="new goal")

    def command(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """The twist to drive from now on."""
        over = self.over(state)
        wanted = Twist(0.0, 0.0) if over else self.wanted(state, scan)
        given = self.safe(state, scan, wanted)
        self.status = replace(
            self.status, state=over or "following", reason=over, limited_by=given.reason
        )
        return given.command

    def safe(self, state: RobotState, scan: LaserScan | None, wanted: Twist) -> Guarded:
        """What is driven where ``wanted`` is asked for."""
        del state, scan
        return Guarded(wanted, False)

    def over(self, state: RobotState) -> str:
        """The state in which the mission has ended, or ""."""
        return "blocked" if state.stamp >= DURATION else ""

    @abstractmethod
    def wanted(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """The twist that is asked for."""

    def at_bearing(self, bearing: float) -> Twist:
        """Full speed in the direction of a bearing (rad from straight ahead), turning to it first."""
        limits = self.robot.limits
        omega = min(max(TURNING_GAIN * bearing, -limits.omega_max), limits.omega_max)
        return Twist(limits.v_max * max(math.cos(bearing), 0.0), omega)


class Straight(Driver):
    """Straight to the goal."""

    def over(self, state: RobotState) -> str:
        """Arrived, if it is."""
        near = math.dist(state.pose[:2], self.goal[:2]) <= 0.9 * self.config.goal_tolerance
        return "arrived" if near else ""

    def wanted(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """At the goal's bearing, slower near it."""
        del scan
        x, y, theta = state.pose
        dx, dy = self.goal.x - x, self.goal.y - y
        v, omega = self.at_bearing(wrap_angle(math.atan2(dy, dx) - theta))
        return Twist(min(v, SLOWING_GAIN * math.hypot(dx, dy)), omega)


class Random(Driver):
    """Random speeds, each held for a while."""

    _until = -math.inf
    _held = Twist(0.0, 0.0)

    def wanted(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """The speeds of the moment, anywhere within the limits."""
        del scan
        if state.stamp >= self._until:
            limits, random = self.robot.limits, self.random
            self._until = state.stamp + random.uniform(0.0, HELD)
            v = random.uniform(limits.v_min, limits.v_max)
            self._held = Twist(v, random.uniform(-limits.omega_max, limits.omega_max))
        return self._held


class Adversary(Driver):
    """At the nearest obstacle, and now and then at another."""

    _another = 0.0  # which of the hits, as a fraction of their number

    def wanted(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """Full speed at an obstacle."""
        ranges = np.empty(0) if scan is None else scan.readings()
        hits = np.flatnonzero(np.isfinite(ranges))
        if scan is None or not len(hits):
            return Twist(self.robot.limits.v_max, 0.0)
        hit = hits[np.argmin(ranges[hits])]
        if state.stamp % (AT_NEAREST + AT_ANOTHER) < AT_NEAREST:
            self._another = self.random.random()
        else:
            hit = hits[int(self._another * len(hits))]
        x, y, theta = scan.mount
        angle, distance = theta + scan.angles[hit], ranges[hit]
        return self.at_bearing(
            math.atan2(y + distance * math.sin(angle), x + distance * math.cos(angle))
        )


class Behind(Driver):
    """A driver whose commands pass through a ``dynastar.Guard`` without a map."""

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: Any) -> None:
        super().__init__(grid, robot, config)
        self.guard = Guard(robot, config)

    def safe(self, state: RobotState, scan: LaserScan | None, wanted: Twist) -> Guarded:
        """What the guard makes of it."""
        return self.guard.filter(state, scan, wanted)


class Watched(Driver):
    """A driver whose commands pass through zones round the robot."""

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: Any) -> None:
        super().__init__(grid, robot, config)
        self.monitor = Monitor()

    def safe(self, state: RobotState, scan: LaserScan | None, wanted: Twist) -> Guarded:
        """What the zones leave of it."""
        del state
        return self.monitor.filter(scan, wanted)


class GuardedStraight(Behind, Straight):
    """Straight to the goal, guarded."""


class GuardedRandom(Behind, Random):
    """Random speeds, guarded."""


class GuardedAdversary(Behind, Adversary):
    """At the nearest obstacle, guarded."""


class MonitoredStraight(Watched, Straight):
    """Straight to the goal, with zones."""


class MonitoredRandom(Watched, Random):
    """Random speeds, with zones."""


class MonitoredAdversary(Watched, Adversary):
    """At the nearest obstacle, with zones."""
