"""The global path of a mission, and when another one is planned."""

import math
from typing import NamedTuple

import numpy as np

from dynastar.errors import GoalObstructed, NoPath, PlanningError
from dynastar.geometry import Goal, Pose2D
from dynastar.guidance import PathTarget
from dynastar.navigator.aligned import turned, turned_path, turned_pose
from dynastar.navigator.arrival import rest_pose
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.planners import Planners
from dynastar.navigator.status import RobotState
from dynastar.navigator.waiting_place import WAIT_WITHIN
from dynastar.path import Path
from dynastar.planning import Plan
from dynastar.robot import Limits

REPLAN_PERIOD = 1.0  # s between two plans at the least
REVIEW_PERIOD = 5.0  # s after which a better plan is looked for
SPACING = 0.1  # m between the points of a given path that are looked at
BETTER = 0.9  # of what is left of a path, up to which a new one replaces it
GOAL_IS_FREE = "the way to the goal is free"
NO_PATH = "there is no path for now"
CLEARLY_SHORTER = 0.99  # of the length of a path by Eq. 2, up to which an exact one replaces it


class RouteEvent(NamedTuple):
    """What happened to the route in a tick.

    ``is_new`` tells of another path. ``blocked`` is the reason why there can be none, and ``error`` that of
    the planner.
    """

    is_new: bool = False
    blocked: str = ""
    error: PlanningError | None = None


KEPT, REPLACED = RouteEvent(), RouteEvent(is_new=True)


class Route:
    """The path that is driven, or None and the ``error`` that tells why; how far along it the robot is (m).

    The path and the robot's state are in the navigator's own frame; goals, given paths and plans are
    in the map frame.
    """

    def __init__(self, planners: Planners, config: NavigatorConfig, limits: Limits) -> None:
        self.planners, self.config, self._limits = planners, config, limits
        self.plan: Plan | None = None
        self.plan_id, self.reason, self.replans = 0, "", 0
        self._stand = Path(np.zeros((1, 2)))  # where the robot waits while there is no path
        self._is_short = False  # the path does not lead to the goal, only nearer or out of a zone
        self._goal_is_taken = False  # a moving obstacle is at the goal
        self._planned_at = -math.inf
        self._changed = False  # the planning map, since the path was last looked at
        self.start_over()

    def start_over(self, given: Path | None = None) -> None:
        """Another goal, or a path that is ``given`` and only followed."""
        self.path: Path | None = None
        self.error: PlanningError | None = None
        self.s, self.given = 0.0, given
        self._planned = False  # for this goal
        self._unsure = False  # an exact search may find a shorter path

    def continue_along(self, given: Path | None) -> bool:
        """Continue to the same goal, along the path that is ``given`` if that is followed.

        False, and nothing is done, where one of the two paths is planned and the other given.
        """
        if given is None or self.given is None:
            return given is self.given
        if not np.array_equal(given.points, self.given.points):
            self.start_over(given)
        return True

    def set_map(self, planners: Planners) -> None:
        """Another map: the next tick plans anew."""
        self.planners, self.path, self.error = planners, None, None

    def forget_times(self) -> None:
        """Another clock: the next tick plans anew."""
        self.path, self.error = None, None
        self._planned_at = -math.inf

    @property
    def _yaw(self) -> float:
        return self.planners.planning_map.grid.frame.yaw

    def drop(self) -> None:
        """Forget the path and what was sensed, so that the next tick plans anew."""
        self.planners.forget()
        self.path, self.error = None, None

    @property
    def is_at_end(self) -> bool:
        """Whether no more than the goal's tolerance is left of a given path. True for planned paths."""
        if self.given is None:
            return True
        return self.path is not None and self.path.length - self.s <= self.config.goal_tolerance

    def target(self, ahead: float) -> PathTarget:
        """Path to follow this tick. A user-given path is limited to the next ``ahead`` m.

        Without a path it is the waiting position.
        """
        if self.path is None:
            return PathTarget(self._stand, 0.0)
        return PathTarget(self.path, self.s, math.inf if self.given is None else ahead)

    def update(
        self,
        state: RobotState,
        goal: Goal,
        changed: bool,
        reachable: bool,
        goal_is_taken: bool = False,
    ) -> RouteEvent:
        """Advance along, replan or drop the path for this tick.

        ``changed`` tells whether the planning map did, ``reachable`` whether a way leads along the path
        out of the local map, ``goal_is_taken`` whether a moving obstacle is at the goal.
        """
        self._goal_is_taken = goal_is_taken
        self._changed = self._changed or changed
        since = state.stamp - self._planned_at
        if self.path is None:
            if self.given is not None:
                self._join(self.given, state.pose)
                return REPLACED
            waits = self.error is not None and since < REPLAN_PERIOD
            return KEPT if waits else self._replan(state, goal, "a plan is needed")
        here = (state.pose.x, state.pose.y)
        self.s = self.path.project(*here, low=self.s - 0.5, high=self.s + 2.0)
        if self._unsure:
            return self._improve(state, goal)
        if since < REPLAN_PERIOD or self.given is not None:
            return KEPT
        if not reachable:
            return self._replan(state, goal, "the path is blocked nearby")
        looks, self._changed = self._changed and self.planners.planning_map.zone is None, False
        if looks and self._is_blocked():
            return self._replan(state, goal, "an obstacle blocks the path")
        if self._is_short:
            return self._replan(state, goal, GOAL_IS_FREE)
        if since > REVIEW_PERIOD:
            return self._replan(state, goal, "a shorter path", BETTER)
        return KEPT

    @property
    def is_at_obstructed_goal(self) -> bool:
        """Whether the robot waits as near to the goal as it can come."""
        return isinstance(self.error, GoalObstructed)

    @property
    def waits_because(self) -> str:
        """Why there is no path; empty while there is one."""
        if self.path is not None:
            return ""
        if self.is_at_obstructed_goal:
            return str(self.error)
        return NO_PATH if self.error is None else f"{NO_PATH}: {self.error}"

    def waits_at_taken_goal(self, here: tuple[float, float]) -> bool:
        """Whether a moving obstacle is at the goal, and the robot near the end of the path to it."""
        if self.path is None:
            return self._goal_is_taken and self.is_at_obstructed_goal
        return self._goal_is_taken and math.dist(here, self.path.points[-1]) < WAIT_WITHIN

    def _is_blocked(self) -> bool:
        """Whether the rest of the path is blocked on the planning map."""
        assert self.path is not None
        rest = self.path.points[self.path.arc > self.s]
        ahead = np.vstack([self.path.at(self.s), rest])
        return len(rest) > 0 and self.planners.blocked_at(turned(ahead, self._yaw)) is not None

    def _join(self, path: Path, pose: Pose2D) -> None:
        """Follow a given path from where the robot is nearest, the first such place along it."""
        path = turned_path(path, -self._yaw)
        if self.s == 0.0:
            points = path.resampled(0.0, path.length, SPACING)
            gap = np.hypot(points[:, 0] - pose.x, points[:, 1] - pose.y)
            first = int(np.argmax(gap <= gap.min() + self.config.goal_tolerance))
            self.s = path.length * first / (len(points) - 1)
        self.path = path

    def _replan(
        self, state: RobotState, goal: Goal, reason: str, below: float = math.inf
    ) -> RouteEvent:
        """Make a plan and take it if it is shorter than ``below`` times the rest of the path."""
        self._planned_at = state.stamp
        is_review = below < math.inf
        try:
            plan = self._plan(state, goal, self.planners.exact if is_review else "")
        except PlanningError as error:
            if is_review:
                return KEPT
            return self._without_path(state, error)
        _, is_short = self._part_to_drive(plan, goal)
        if reason == GOAL_IS_FREE and is_short:
            return KEPT
        if self.path is not None and plan.path.length > below * (self.path.length - self.s):
            return KEPT
        self.replans += self._planned
        self._planned, self._unsure = True, not is_review and self.planners.exact != ""
        self._take(plan, goal, reason)
        return REPLACED

    def _improve(self, state: RobotState, goal: Goal) -> RouteEvent:
        """Replace the Eq. 2 path by the exact shortest path if that is at least 1 % shorter."""
        self._unsure = False
        assert self.path is not None
        try:
            plan = self._plan(state, goal, self.planners.exact)
        except PlanningError:
            return KEPT
        if plan.path.length > CLEARLY_SHORTER * (self.path.length - self.s):
            return KEPT
        self._take(plan, goal, "an exact search found a shorter path")
        return REPLACED

    def _plan(self, state: RobotState, goal: Goal, planner: str) -> Plan:
        here = turned_pose(state.pose, self._yaw)
        return self.planners.plan((here.x, here.y), (goal.x, goal.y), planner)

    def _take(self, plan: Plan, goal: Goal, reason: str) -> None:
        path, self._is_short = self._part_to_drive(plan, goal)
        self.path, self.s, self.error = turned_path(path, -self._yaw), 0.0, None
        self.plan, self.plan_id, self.reason = plan, self.plan_id + 1, reason

    def _part_to_drive(self, plan: Plan, goal: Goal) -> tuple[Path, bool]:
        """The path to drive now, and whether it ends short of the goal.

        A keep-out zone is first left, by a radius more than the plan asks for, since the robot stops a
        little short of a path's end; the rest is planned from there.
        """
        path = plan.path
        if self.planners.planning_map.zone is not None and plan.clear_from > 0.0:
            return Path(path.part(0.0, plan.clear_from + plan.radius)), True
        return path, math.dist(path.points[-1], goal[:2]) > self.config.goal_tolerance

    def _without_path(self, state: RobotState, error: PlanningError) -> RouteEvent:
        """No path on the planning map: wait where the robot is, if what was sensed is in the way."""
        sensed = isinstance(error, NoPath) and bool(self.planners.planning_map.seen.any())
        if not (sensed or isinstance(error, GoalObstructed)):
            return RouteEvent(blocked=str(error), error=error)
        if self.path is not None or self.error is None:
            self._stand = Path(np.array([rest_pose(state.pose, state.twist, self._limits)[:2]]))
        self.path, self.error = None, error
        return KEPT
