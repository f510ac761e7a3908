"""What the controllers here share: costmap, path, arrival, bad data and recoveries."""

import math
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dynastar.bench.controllers.costmap import Costmap, Surroundings, covering
from dynastar.bench.controllers.route import PlannedPath, Route
from dynastar.bench.controllers.status import Status
from dynastar.errors import InputError, PlanningError
from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator import RobotState
from dynastar.navigator.readings import Readings
from dynastar.robot import Robot, arc, slew
from dynastar.scan import LaserScan

REST = Twist(0.0, 0.0)
SCAN_AGE = 0.3  # s, older data stop the robot
CLOCKS = 0.1  # s that a scan may be ahead of the state
HISTORY = 40  # poses kept to place late scans by
PROGRESS = 0.3  # m that count as progress
BACK_UP = (0.4, 0.15)  # m and m/s of backing up


class PathController(ABC):
    """Follows a replanned path to the goals; a subclass says how, in ``follow``.

    It stops without usable data, turns to a goal's heading, and where it makes no progress first
    forgets what was seen, then backs up, in turns, as the behaviours of Nav2 do. Commands ramp
    within the robot's limits from the last command on.
    """

    stuck_after = 4.0  # s without progress until a recovery
    retries = 12  # recoveries without progress until the goal is given up

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: Any) -> None:
        self.robot, self.config = robot, config
        self.discs = covering(robot.footprint)
        self._readings = Readings(robot)
        self._goals: list[Goal] = []
        self._poses: deque[RobotState] = deque(maxlen=HISTORY)
        self._scan_stamp = -math.inf
        self._last = REST
        self._anchor: tuple[float, Pose2D] | None = None
        self._failed = 0
        self._backing_until = -math.inf
        self.status = Status()
        self.set_map(grid)

    def set_map(self, grid: OccupancyGrid) -> None:
        """Another map; what was seen is forgotten."""
        self.costmap = Costmap(grid, self.config.unknown)
        self.route = self.make_route()
        self.status = replace(self.status, planning_frame=self.costmap.grid.frame)

    def make_route(self) -> PlannedPath:
        """The path on the costmap."""
        return Route(self.costmap, self.robot)

    def set_goal(self, goal: Goal | Sequence[Goal]) -> None:
        """One goal, or several to reach in order."""
        self._goals = [goal] if isinstance(goal, Goal) else [Goal(*g) for g in goal]
        self.route.drop()
        self._say("following", "new goal")

    @abstractmethod
    def follow(self, state: RobotState) -> Twist | None:
        """The twist wanted along ``self.route.path``; None where there is no way on for now."""

    def without_path(self, state: RobotState) -> Twist:
        """The twist while there is no path."""
        return REST

    def command(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """The twist to drive from now on."""
        self.status = replace(self.status, limited_by="")
        if scan is not None and scan.fault() is None:
            scan = self._readings.interpreted(scan)
        fault = self._fault(state, scan)
        if fault is None and scan is not None:
            self._see(state, scan)
        if self.status.state in ("arrived", "blocked"):
            return self._ramped(REST)
        if fault is None and state.stamp - self._scan_stamp > SCAN_AGE:
            fault = f"no scan of the last {SCAN_AGE:g} s"
        if fault is not None:
            self._say("sensor_lost", fault)
            return self._ramped(REST)
        if not self._goals:
            self._say("arrived", "no goal")
            return self._ramped(REST)
        return self._ramped(self._towards_goal(state))

    # -- the mission ------------------------------------------------------------------------------

    def _towards_goal(self, state: RobotState) -> Twist:
        goal, pose = self._goals[0], state.pose
        if math.hypot(goal.x - pose.x, goal.y - pose.y) <= 0.9 * self.config.goal_tolerance:
            off = 0.0 if goal.heading is None else wrap_angle(goal.heading - pose.theta)
            if abs(off) > 0.8 * self.config.heading_tolerance:
                self._say("turning", "to the goal's heading")
                return Twist(0.0, self.turning(off))
            self._goals.pop(0)
            self.route.drop()
            self._failed, self._anchor = 0, None
            if not self._goals:
                self._say("arrived", "the goal is reached")
            return REST
        if not self._plan(state):
            return self.without_path(state)
        if state.stamp < self._backing_until:
            return self._back_up(state)
        wanted = self.follow(state)
        if wanted is None:
            self._say("waiting", "something is in the way")
        else:
            self._say("following", "the path")
        self._watch_progress(state)
        return wanted or REST

    def _plan(self, state: RobotState) -> bool:
        here, goal = (state.pose.x, state.pose.y), self._goals[0]
        first = self.status.plan_id == 0
        try:
            if self.route.update(here, goal, state.stamp):
                why = "a plan is needed" if first else "planned anew"
                self.status = replace(
                    self.status,
                    plan=self.route.plan,
                    plan_id=self.status.plan_id + 1,
                    plan_reason=why,
                )
            return self.route.plan is not None
        except PlanningError as error:
            if first and isinstance(error, InputError):
                self._say("blocked", str(error), error=error)
            else:
                self._say("waiting", str(error))
                self._watch_progress(state)
            return False

    def _watch_progress(self, state: RobotState) -> None:
        """Starts a recovery after a while in one place, and gives up after many."""
        here, now = state.pose, state.stamp
        if self._anchor is None or math.dist(here[:2], self._anchor[1][:2]) > PROGRESS:
            if self._anchor is not None and now >= self._backing_until + self.stuck_after:
                self._failed = 0
            self._anchor = (now, here)
        if now - self._anchor[0] < self.stuck_after:
            return
        self._anchor = (now, here)
        self._failed += 1
        if self._failed > self.retries:
            self._say("blocked", f"gave up: no progress after {self.retries} recoveries")
            return
        if self._failed % 2 == 0 and self.robot.limits.v_min < 0.0:
            self._backing_until = now + BACK_UP[0] / BACK_UP[1]
            detail = "back up"
        else:
            self.costmap.forget()
            self.route.mark((0, 0, self.costmap.blocked))
            self.route.drop()
            detail = "forget what was seen"
        self._say("recovering", detail, recoveries=self.status.recoveries + 1)

    def _back_up(self, state: RobotState) -> Twist:
        """Straight back, as far as that is free."""
        self._say("recovering", "back up")
        x, y, theta = state.pose
        steps = np.arange(0.0, 0.25, 0.05)
        poses = np.column_stack(
            [x - steps * math.cos(theta), y - steps * math.sin(theta), np.full(len(steps), theta)]
        )
        around = self.costmap.surroundings(state.pose, 1.0 + self.robot.footprint.circumscribed)
        gaps = around.gaps(poses, self.discs)
        if gaps[1:].min() < min(0.0, gaps[0]):
            self._backing_until = -math.inf
            return REST
        return Twist(max(-BACK_UP[1], self.robot.limits.v_min), 0.0)

    # -- data and commands ------------------------------------------------------------------------

    def _fault(self, state: RobotState, scan: LaserScan | None) -> str | None:
        """Describe why the data of this tick are unusable, or None."""
        if not all(map(math.isfinite, (state.stamp, *state.pose, *state.twist))):
            return "the robot's state is not finite"
        if self._poses and state.stamp < self._poses[-1].stamp:
            return "time went back"
        self._poses.append(state)
        if scan is None:
            return None
        wrong = scan.fault()
        if wrong is None and scan.stamp > state.stamp + CLOCKS:
            wrong = "the scan is ahead of the state"
        if wrong is None and np.isnan(scan.ranges).all():
            wrong = "the scan holds no range"
        return wrong

    def _see(self, state: RobotState, scan: LaserScan) -> None:
        if scan.stamp <= self._scan_stamp:
            return
        self._scan_stamp = scan.stamp
        taken = min(self._poses, key=lambda past: abs(past.stamp - scan.stamp))
        self.see(taken.pose, scan)

    def see(self, pose: Pose2D, scan: LaserScan) -> None:
        """Takes in a scan from the robot at ``pose``."""
        changed = self.costmap.see(pose, scan)
        if changed is not None:
            self.route.mark(changed)

    def turned(self, pose: Pose2D, off: float, around: Surroundings) -> Twist | None:
        """Turns on the spot by ``off`` (rad), or the other way round where that is not free."""
        for turn in (off, off - math.copysign(math.tau, off)):
            steps = np.linspace(0.0, turn, max(2, int(abs(turn) / 0.1) + 1))
            turned = np.array([arc(pose, Twist(0.0, step), 1.0) for step in steps])
            gaps = around.gaps(turned, self.discs)
            if gaps.min() >= min(0.0, float(gaps[0]) - 1e-6):
                return Twist(0.0, self.turning(turn))
        return None

    def free_length(
        self, pose: Pose2D, curvature: float, reach: float, around: Surroundings
    ) -> float:
        """Metres along an arc up to the first contact, at most ``reach`` and two thirds of a turn."""
        if abs(curvature) > 1e-6:
            reach = min(reach, 4.0 / abs(curvature))
        steps = np.arange(0.0, reach + 0.05, 0.05)
        half = 0.5 * curvature * steps
        chord = steps * np.sinc(half / np.pi)
        poses = np.column_stack(
            [
                pose.x + chord * np.cos(pose.theta + half),
                pose.y + chord * np.sin(pose.theta + half),
                pose.theta + 2.0 * half,
            ]
        )
        gaps = around.gaps(poses, self.discs)
        touching = np.flatnonzero(gaps < min(0.0, float(gaps[0]) - 1e-6))
        return float(steps[max(touching[0] - 1, 0)]) if len(touching) else reach

    def turning(self, off: float) -> float:
        """The turning rate (rad/s) that brakes in time to turn by ``off`` (rad)."""
        limits = self.robot.limits
        fastest = math.sqrt(limits.omega_brake * abs(off))
        # What acts late is turned meanwhile.
        late = abs(off) / (2.0 * (self.config.period + self.config.latency))
        return math.copysign(min(limits.omega_max, fastest, late), off)

    def _ramped(self, wanted: Twist) -> Twist:
        """As near to what is wanted as the limits allow a period after the last command."""
        limits, period = self.robot.limits, self.config.period
        v = min(max(wanted.v, limits.v_min), limits.v_max)
        omega = min(max(wanted.omega, -limits.omega_max), limits.omega_max)
        self._last = Twist(
            slew(self._last.v, v, limits.v_accel, limits.v_brake, period),
            slew(self._last.omega, omega, limits.omega_accel, limits.omega_brake, period),
        )
        return self._last

    def _say(self, state: str, reason: str, **more: Any) -> None:
        self.status = replace(self.status, state=state, reason=reason, **more)
