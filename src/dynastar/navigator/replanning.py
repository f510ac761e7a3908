"""The global path of a mission, and when another one is planned."""

import math

import numpy as np

from dynastar.errors import GoalOccupied, NoPath, PlanningError
from dynastar.geometry import Goal, Pose2D
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.guidance import Lead
from dynastar.navigator.mission import Mission
from dynastar.navigator.planning_map import PlanningMap
from dynastar.navigator.status import RobotState
from dynastar.path import Path
from dynastar.planning import Plan

REPLAN_PERIOD = 1.0  # s between two plans at the least
REVIEW_PERIOD = 5.0  # s after which a better plan is looked for
SPACING = 0.1  # m between the points of a given path that are looked at
BETTER = 0.9  # of what is left of a path, up to which a new one replaces it
CLEARLY = 0.99  # of the length of a path by Eq. 2, up to which an exact one replaces it


class Route:
    """The path that is driven, or None while there is none, and how far along it the robot is (m)."""

    def __init__(
        self, planning_map: PlanningMap, mission: Mission, config: NavigatorConfig
    ) -> None:
        self.planning_map, self.config = planning_map, config
        self._mission = mission
        self.path: Path | None = None
        self.s = 0.0
        self.plan: Plan | None = None
        self.plan_id, self.reason, self.replans = 0, "", 0
        self._given: Path | None = None
        self._planned = False  # for this goal
        self._unsure = False  # whether an exact search may find a shorter path
        self._planned_at = -math.inf
        self._no_path_since: float | None = None
        self._forgotten = 0
        self._stand = Path(np.zeros((1, 2)))  # where the robot waits while there is no path

    def set_map(self, planning_map: PlanningMap) -> None:
        """Another map: the next tick plans anew."""
        self.planning_map, self.path = planning_map, None

    def start_over(self, given: Path | None = None) -> None:
        """Another goal, or a path that is ``given`` and only followed."""
        self.path, self.s, self._given = None, 0.0, given
        self._planned = self._unsure = False
        self._no_path_since, self._forgotten = None, 0

    def ends_within(self, distance: float) -> bool:
        """Whether a given path has been followed but for ``distance`` (m); of a planned one always."""
        return self._given is None or (
            self.path is not None and self.path.length - self.s <= distance
        )

    def lead(self, ahead: float) -> Lead:
        """The path to follow, or the pose at which to wait for one; of a given path ``ahead`` m."""
        if self.path is None:
            return Lead(self._stand, 0.0, math.inf)
        return Lead(self.path, self.s, math.inf if self._given is None else ahead)

    def keep(self, state: RobotState, changed: bool, reachable: bool) -> bool:
        """Keeps a path that leads to the goal; whether it is a new one.

        ``changed`` tells whether the planning map did, ``reachable`` whether a way leads along the path
        out of the local map. Without any way left, the mission is blocked.
        """
        since = state.stamp - self._planned_at
        if self.path is None:
            if self._given is not None:
                self._join(self._given, state.pose)
                return True
            waits = self._no_path_since is not None and since < REPLAN_PERIOD
            return not waits and self._replan(state, "a plan is needed")
        here = (state.pose.x, state.pose.y)
        self.s = self.path.project(*here, low=self.s - 0.5, high=self.s + 2.0)
        if self._unsure:
            return self._improve(state)
        if since < REPLAN_PERIOD or self._given is not None:
            return False
        if not reachable:
            return self._replan(state, "the path is blocked nearby")
        if changed:
            rest = self.path.points[self.path.arc > self.s]
            ahead = np.vstack([self.path.at(self.s), rest])
            if len(rest) and self.planning_map.blocked_at(ahead) is not None:
                return self._replan(state, "an obstacle blocks the path")
        return since > REVIEW_PERIOD and self._replan(state, "a shorter path", BETTER)

    def _join(self, path: Path, pose: Pose2D) -> None:
        """Follows a given path from where the robot is nearest, the first such place along it."""
        if self.s == 0.0:
            points = path.resampled(0.0, path.length, SPACING)
            gap = np.hypot(points[:, 0] - pose.x, points[:, 1] - pose.y)
            first = int(np.argmax(gap <= gap.min() + self.config.goal_tolerance))
            self.s = path.length * first / (len(points) - 1)
        self.path = path

    def drop(self) -> None:
        """Forgets the path and what was sensed, so that the next tick looks for a way anew."""
        self.planning_map.forget()
        self.path = None

    def _replan(self, state: RobotState, reason: str, below: float = math.inf) -> bool:
        """A new plan, taken if it is shorter than ``below`` times what is left of the present one."""
        self._planned_at = state.stamp
        try:
            plan = self._plan(state, self.planning_map.exact if below < math.inf else "")
        except PlanningError as error:
            if self.path is None or below == math.inf:
                self._without_path(state, error)
            return False
        self._no_path_since = None
        if self.path is not None and plan.path.length > below * (self.path.length - self.s):
            return False
        self.replans += self._planned
        self._planned, self._unsure = True, below == math.inf and self.planning_map.exact != ""
        self._take(plan, reason)
        self._mission.error = None
        return True

    def _improve(self, state: RobotState) -> bool:
        """The shortest path in place of one by Eq. 2, if it is clearly shorter; whether it is."""
        self._unsure = False
        assert self.path is not None
        try:
            plan = self._plan(state, self.planning_map.exact)
        except PlanningError:
            return False
        if plan.path.length > CLEARLY * (self.path.length - self.s):
            return False
        self._take(plan, "an exact search found a shorter path")
        return True

    def _plan(self, state: RobotState, planner: str) -> Plan:
        goal: Goal = self._mission.goals[0]
        here = (state.pose.x, state.pose.y)
        return self.planning_map.plan(here, (goal.x, goal.y), True, planner)

    def _take(self, plan: Plan, reason: str) -> None:
        self.path, self.s = plan.path, 0.0
        self.plan, self.plan_id, self.reason = plan, self.plan_id + 1, reason

    def _without_path(self, state: RobotState, error: PlanningError) -> None:
        """No path on the planning map: what was sensed may be gone, so forget it and look again."""
        mission = self._mission
        sensed = isinstance(error, NoPath | GoalOccupied) and bool(self.planning_map.seen.any())
        if not sensed or self._forgotten >= self.config.attempts:
            mission.block(f"no way is left: {error}" if sensed else str(error), error)
            return
        self.path = None
        if self._no_path_since is None:
            self._no_path_since = state.stamp
            self._stand = Path(np.array([state.pose[:2]]))
        elif state.stamp - self._no_path_since > self.config.stuck_time:
            self._forgotten += 1
            self._no_path_since = None
            self.planning_map.forget()
            mission.recover(state.stamp, "forget what was sensed: no way is left")
