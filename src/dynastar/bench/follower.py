"""Path following alone, beside which the hybrid is measured: planned once, and driven with closed eyes."""

import math
from collections.abc import Sequence
from dataclasses import replace

from dynastar.bench.speed_profile import SpeedProfile, bend_speed, points
from dynastar.errors import PlanningError
from dynastar.geometry import Goal, Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState, State, Status
from dynastar.navigator.aligned import turned
from dynastar.path import Path
from dynastar.robot import Robot, slew

NEAREST = 0.3  # m along the path to the point that is pursued, at least
AHEAD = 0.6  # s, and at a speed that much further; twice that cuts corners into what stands there
TURN_IN_PLACE = 1.2  # rad, a point further aside is turned to before driving
CALM = 0.1  # share of the turning acceleration that bends are slowed down for


class Follower:
    """Pure pursuit [Coulter1992] of one plan for each goal; scans are not looked at.

    It plans on the navigator's planning map, slows down for bends and goals, and turns in place
    where the path leads far aside. A goal's heading is not turned to.
    """

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: NavigatorConfig) -> None:
        self.robot, self.config = robot, config
        limits = robot.limits
        self._calm = limits._replace(
            omega_accel=CALM * limits.omega_accel, omega_brake=CALM * limits.omega_brake
        )
        self.planners = Navigator(grid, robot, config).planners
        self.status = Status(planning_frame=self.planners.planning_map.grid.frame)
        self._goals: list[Goal] = []
        self._path: Path | None = None
        self._s = 0.0

    def set_goal(self, goal: Goal | Sequence[Goal]) -> None:
        """One goal, or several to reach in order."""
        self._goals = [goal] if isinstance(goal, Goal) else [Goal(*g) for g in goal]
        self._path = None
        self._say("following", "new goal")

    def command(self, state: RobotState, scan: object = None) -> Twist:
        """The twist to drive from now on."""
        del scan
        here = state.pose[:2]
        if self._goals and math.dist(here, self._goals[0][:2]) <= self.config.goal_tolerance:
            self._goals.pop(0)
            self._path = None
            if not self._goals:
                self._say("arrived", "the goal is reached")
        if not self._goals or (self._path is None and not self._plan(state)):
            return self._ramped(state, 0.0, 0.0)
        return self._pursue(state)

    def _plan(self, state: RobotState) -> bool:
        goal = self._goals[0]
        try:
            plan = self.planners.plan(state.pose[:2], (goal.x, goal.y))
        except PlanningError as error:
            self._goals = []
            self._say("blocked", str(error))
            self.status = replace(self.status, error=error)
            return False
        self._path, self._s = plan.path, 0.0
        planning_map = self.planners.planning_map
        places = turned(points(plan.path), -planning_map.grid.frame.yaw)
        limits = planning_map.speed_limit(places)
        self._profile = SpeedProfile(plan.path, self._calm, limits)
        self.status = replace(
            self.status, plan=plan, plan_id=self.status.plan_id + 1, plan_reason="a plan is needed"
        )
        return True

    def _pursue(self, state: RobotState) -> Twist:
        """Along the arc from here that touches the heading and meets the point that is pursued."""
        assert self._path is not None
        limits, pose, v = self.robot.limits, state.pose, state.twist.v
        self._s = self._path.project(*pose[:2], low=self._s, high=self._s + 2.0)
        x, y = self._path.at(self._s + NEAREST + AHEAD * max(v, 0.0))
        off = wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.theta)
        if abs(off) > TURN_IN_PLACE:
            fastest = math.sqrt(limits.omega_brake * abs(off))
            return self._ramped(state, 0.0, math.copysign(min(limits.omega_max, fastest), off))
        curvature = 2.0 * math.sin(off) / max(math.dist(pose[:2], (x, y)), 1e-3)
        speed = min(
            self._profile.at(self._s),
            self._profile.at(self._s + 2.0 * v * self.config.period),
            float(bend_speed(abs(off), self._calm)),
            limits.omega_max / max(abs(curvature), 1e-9),
        )
        return self._ramped(state, speed, max(v, 0.1) * curvature)

    def _ramped(self, state: RobotState, v: float, omega: float) -> Twist:
        """As near to what is wanted as the limits let the robot come within a period."""
        limits, period = self.robot.limits, self.config.period
        omega = max(-limits.omega_max, min(limits.omega_max, omega))
        return Twist(
            slew(state.twist.v, v, limits.v_accel, limits.v_brake, period),
            slew(state.twist.omega, omega, limits.omega_accel, limits.omega_brake, period),
        )

    def _say(self, state: State, reason: str) -> None:
        self.status = replace(
            self.status, state=state, reason=reason, goals_left=len(self._goals), error=None
        )
