"""The hybrid navigator (section V): perceive, plan, decide, send."""

import logging
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynastar.dwa.clearance import kept_margin
from dynastar.dwa.dwa import Choice, DynamicWindow
from dynastar.dwa.scene import AT_REST, DistanceField, Scene
from dynastar.errors import GoalOccupied, NoPath, PlanningError
from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator.braking import Commands
from dynastar.navigator.config import NavigatorConfig, fitted
from dynastar.navigator.guidance import Guidance
from dynastar.navigator.planning_map import PlanningMap
from dynastar.navigator.progress import Progress
from dynastar.navigator.sensing import Sensing
from dynastar.navigator.status import RobotState, Status
from dynastar.path import Path
from dynastar.perception import MovingObstacle
from dynastar.perception.local_map import SEEN_OCCUPIED
from dynastar.perception.prediction import predict
from dynastar.robot import Robot, slew
from dynastar.scan import LaserScan

log = logging.getLogger("dynastar")

REPLAN_PERIOD = 1.0  # s between two plans at the least
REVIEW_PERIOD = 5.0  # s after which a better plan is looked for
BETTER = 0.9  # of what is left of a path, up to which a new one replaces it
GENTLE = 0.7  # of the braking that slowing down for a speed limit or a heading uses
PLAN_MARGIN = 0.03  # m beyond the footprint that a plan keeps clear


class Navigator:
    """Takes a robot to its goals: give it every state and scan, and drive as it says.

    Single-threaded, without a clock of its own; ``command`` never raises while driving: trouble is
    a braking twist and a ``status``.
    """

    def __init__(
        self, grid: OccupancyGrid, robot: Robot, config: NavigatorConfig = NavigatorConfig()
    ) -> None:
        if not config.reverse:
            robot = replace(robot, limits=robot.limits._replace(v_min=max(robot.limits.v_min, 0.0)))
        config = fitted(config, robot.footprint.inscribed)
        self.robot, self.config = robot, config
        half_diagonal = config.local_map.resolution / math.sqrt(2.0)
        lever = math.hypot(robot.lidar.x, robot.lidar.y)
        if not robot.footprint.is_disc:
            lever += robot.footprint.circumscribed
        self.margin = half_diagonal + 2.0 * config.pose_error + config.heading_error * lever
        self.window = DynamicWindow(robot, config.dwa, config.period)
        self.sensing = Sensing(robot, config)
        self.guidance = Guidance(
            len(self.sensing.local_map.states),
            config.local_map.resolution,
            robot.footprint.inscribed + self.margin,
            config.dwa.comfort,
        )
        self.progress = Progress(config.stuck_time)
        self.status = Status()
        self._goals: list[Goal] = []
        self._path: Path | None = None
        self._stand = Path(np.zeros((1, 2)))  # where it waits while there is no path
        self._s = 0.0
        self._last = AT_REST
        self._planned_at = -math.inf
        self._no_path_since: float | None = None
        self._forgotten = 0
        self._commands = Commands(robot.limits, config.period, config.latency)
        self.set_map(grid)

    def set_map(self, grid: OccupancyGrid) -> None:
        """Another map; what was seen is kept round the robot, the next tick plans anew."""
        shape = self.robot.footprint
        self.planning_map = PlanningMap(
            grid, self.config, shape.circumscribed + self.margin, shape.inscribed + PLAN_MARGIN
        )
        self.sensing.set_grid(grid)
        self._path = None
        self.status = replace(self.status, planning_frame=self.planning_map.frame)
        if self.status.state == "blocked":
            self.set_goal(self._goals)

    def set_goal(self, goal: Goal | Sequence[Goal]) -> None:
        """One goal, or several to reach in order: (x, y) metres and a heading in radians or None."""
        goals = [goal] if isinstance(goal, Goal) else [Goal(*g) for g in goal]
        for x, y, heading in goals:
            if not all(map(math.isfinite, (x, y, heading or 0.0))):
                raise ValueError(f"a goal is ({x}, {y}, {heading}): expected finite numbers")
        self._goals = goals
        self._start_over()
        self._say("following" if goals else "idle", "new goal" if goals else "no goal", error=None)

    def command(
        self,
        state: RobotState,
        scan: LaserScan | Sequence[LaserScan] | None,
        movers: Sequence[MovingObstacle] | None = None,
    ) -> Twist:
        """The twist to drive from now on; ``movers`` replaces what the tracker finds in the scans."""
        scans = [] if scan is None else [scan] if isinstance(scan, LaserScan) else list(scan)
        state = self._within_limits(state)
        fault = self.sensing.place(state)
        if fault is None:
            fault = self.sensing.take_in(scans, state.stamp, self.planning_map.known)
        if fault is not None:
            self._say("sensor_lost", fault, choice=None)
            return self._commands.brake(state)
        if self.status.state == "sensor_lost":
            self._say("following" if self._goals else "idle", "data are back")
            self.progress.restart(state.stamp)
        changed = self.planning_map.take_in(self.sensing.local_map)
        self.status = replace(
            self.status, tracks=self.sensing.tracker.tracks, goals_left=len(self._goals)
        )
        if not self._goals or self.status.state == "blocked":
            return self._commands.brake(state)
        if self._arrived(state):
            self._goals.pop(0)
            self._start_over()
            if not self._goals:
                self._say("arrived", "the goal is reached", goals_left=0)
                return self._commands.brake(state)
        if not self._plan(state, changed) and self.status.state == "blocked":
            return self._commands.brake(state)
        return self._drive(state, movers)

    def _within_limits(self, state: RobotState) -> RobotState:
        """The state without speeds that the robot cannot have, as a glitch of the odometry reports."""
        v, omega = state.twist
        if not (math.isfinite(v) and math.isfinite(omega)):
            return state
        limits = self.robot.limits
        v = min(max(v, limits.v_min), limits.v_max)
        omega = min(max(omega, -limits.omega_max), limits.omega_max)
        return state._replace(twist=Twist(v, omega))

    def _start_over(self) -> None:
        """Forgets the path and the attempts to reach the last goal."""
        self._path, self._no_path_since, self._forgotten = None, None, 0
        self.progress.reset()

    # -- planning ---------------------------------------------------------------------------------

    def _plan(self, state: RobotState, changed: bool) -> bool:
        """Keeps a path that leads to the goal; False if there is none for now."""
        since = state.stamp - self._planned_at
        if self._path is None:
            waits = self._no_path_since is not None and since < REPLAN_PERIOD
            return False if waits else self._replan(state, "a plan is needed")
        here = (state.pose.x, state.pose.y)
        self._s = self._path.project(*here, low=self._s - 0.5, high=self._s + 2.0)
        if since < REPLAN_PERIOD or self.config.global_path == "once":
            return True
        if not self.guidance.reachable:
            return self._replan(state, "the path is blocked nearby")
        if changed:
            rest = self._path.points[self._path.arc > self._s]
            ahead = np.vstack([self._path.at(self._s), rest])
            if len(rest) and self.planning_map.blocked_at(ahead) is not None:
                return self._replan(state, "an obstacle blocks the path")
        if since > REVIEW_PERIOD:
            return self._replan(state, "a shorter path", below=BETTER)
        return True

    def _replan(self, state: RobotState, reason: str, below: float = math.inf) -> bool:
        """A new plan, taken if it is shorter than ``below`` times what is left of the present one."""
        goal = self._goals[0]
        self._planned_at = state.stamp
        try:
            plan = self.planning_map.plan(
                (state.pose.x, state.pose.y), (goal.x, goal.y), explored=True
            )
        except PlanningError as error:
            return (self._path is not None and below < math.inf) or self._no_plan(state, error)
        self._no_path_since = None
        if self._path is not None and plan.path.length > below * (self._path.length - self._s):
            return True
        again = self.status.plan_id > 0
        self._path, self._s = plan.path, 0.0
        self.progress.restart(state.stamp)
        self.status = replace(
            self.status,
            plan=plan,
            plan_id=self.status.plan_id + 1,
            plan_reason=reason,
            replans=self.status.replans + again,
            error=None,
        )
        return True

    def _no_plan(self, state: RobotState, error: PlanningError) -> bool:
        """No path on the planning map: what was sensed may be gone, so forget it and look again."""
        sensed = isinstance(error, NoPath | GoalOccupied) and bool(self.planning_map.seen.any())
        if not sensed or self._forgotten >= self.config.attempts:
            self._say("blocked", f"no way is left: {error}" if sensed else str(error), error=error)
            return False
        self._path = None
        if self._no_path_since is None:
            self._no_path_since = state.stamp
            self._stand = Path(np.array([state.pose[:2]]))
        elif state.stamp - self._no_path_since > self.config.stuck_time:
            self._forgotten += 1
            self._no_path_since = None
            self.planning_map.forget()
            self._recovered(state, "forget what was sensed: no way is left")
        return False

    def _recovered(self, state: RobotState, detail: str) -> None:
        log.info("recovery at %.1f s: %s", state.stamp, detail)
        self._say("recovering", detail, recoveries=self.status.recoveries + 1)

    # -- driving ----------------------------------------------------------------------------------

    def _drive(self, state: RobotState, movers: Sequence[MovingObstacle] | None) -> Twist:
        """Chooses a command by the dynamic window, or turns to the goal's heading."""
        pose, twist = self._commands.when_one_acts(state)
        scene = self._scene(state, pose, movers)
        goal = self._goals[0]
        if self._path is not None and goal.heading is not None and self._near(goal, pose):
            command = self._turned(pose, twist, goal.heading)
            self._say("turning", "to the goal's heading", choice=None)
            self._last = AT_REST
            admitted = self.window.admits(pose, twist, scene, command)
            return self._commands.send(state, command if admitted else None)
        choice = self.window.choose(pose, twist, scene)
        self._last = choice.left
        self._judge(state, choice, len(scene.people.now) > 0)
        return self._commands.send(state, choice.command)

    def _scene(
        self, state: RobotState, pose: Pose2D, movers: Sequence[MovingObstacle] | None
    ) -> Scene:
        """What the window is judged against, as of the time from which a command acts."""
        config, limits, local = self.config, self.robot.limits, self.sensing.local_map
        span = self.window.span
        occupied = (local.states == SEEN_OCCUPIED) | self.planning_map.blocked_under(local)
        moving = self.sensing.moving(state.stamp, movers)
        people = predict(moving, config.prediction, config.latency, span.step, span.horizon_steps)
        path, s = (self._stand, 0.0) if self._path is None else (self._path, self._s)
        obstacles, cost_to_go = self.guidance.update(
            local, occupied, path, s, (pose.x, pose.y), people,
            (config.latency, span.step, limits.v_max, span.risk_radius),
        )  # fmt: skip
        hidden = self.sensing.unseen(occupied, state.stamp)
        stop = state.twist.v**2 / (2.0 * limits.v_brake)
        stop += abs(state.twist.v) * (config.latency + 2.0 * config.period)
        closed = DistanceField(local.field, *local.origin, local.config.resolution)
        margin = self.margin + config.heading_error * stop
        stands = (pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta))
        return Scene(
            closed,
            obstacles,
            cost_to_go,
            people,
            hidden,
            margin,
            kept_margin(closed, self.window.body, margin, stands),
            config.latency,
            self._last,
            self._speed_cap(pose),
        )

    def _speed_cap(self, pose: Pose2D) -> float:
        """The speed (m/s) that leaves room to slow down for the map's speed limits ahead."""
        line = self.guidance.line
        ahead = np.maximum(np.arange(len(line)) - 1.0, 0.0) * self.guidance.spacing
        limit = self.planning_map.speed_limit(np.vstack([[pose.x, pose.y], line]))
        brake = 2.0 * GENTLE * self.robot.limits.v_brake
        slowed = np.sqrt(limit[1:] ** 2 + brake * ahead)
        return float(min(self.robot.limits.v_max, limit[0], slowed.min(initial=math.inf)))

    def _judge(self, state: RobotState, choice: Choice, people: bool) -> None:
        """Says what is going on, and starts anew where there has been no progress for long."""
        standing = choice.command is None or abs(choice.command.v) < 0.02
        if self._path is None:
            state_, reason = "waiting", "there is no path for now"
        elif people and standing:
            state_, reason = "waiting", "a moving obstacle passes"
        else:
            state_, reason = "following", "the path"
        self._say(state_, reason, choice=choice, limited_by=choice.limited_by)
        if self._path is None:
            return
        here = (state.pose.x, state.pose.y)
        if not self.progress.stuck(state.stamp, here, self.guidance.cost_to_go):
            return
        if self.progress.rounds > self.config.attempts:
            self._say("blocked", "no progress, whatever was tried")
            return
        self.planning_map.forget()
        self._path = None
        self._recovered(state, "no progress: forget what was sensed and plan anew")

    def _turned(self, pose: Pose2D, twist: Twist, heading: float) -> Twist:
        """A step towards turning on the spot to a heading, slow enough to stop there."""
        limits, period = self.robot.limits, self.config.period
        off = wrap_angle(heading - pose.theta)
        rate = math.sqrt(2.0 * GENTLE * limits.omega_brake * abs(off))
        rate = min(limits.omega_max, rate, abs(off) / period)
        return Twist(
            slew(twist.v, 0.0, limits.v_accel, limits.v_brake, period),
            slew(
                twist.omega,
                math.copysign(rate, off),
                limits.omega_accel,
                limits.omega_brake,
                period,
            ),
        )

    # -- the end ----------------------------------------------------------------------------------

    def _near(self, goal: Goal, pose: Pose2D) -> bool:
        return math.hypot(goal.x - pose.x, goal.y - pose.y) <= self.config.goal_tolerance

    def _arrived(self, state: RobotState) -> bool:
        """Whether the robot is at its goal, and will still be when it has come to rest."""
        goal = self._goals[0]
        pose, twist = self._commands.when_one_acts(state)
        stop = 0.5 * twist.v * abs(twist.v) / self.robot.limits.v_brake
        rest = pose._replace(
            x=pose.x + stop * math.cos(pose.theta), y=pose.y + stop * math.sin(pose.theta)
        )
        if not (self._near(goal, state.pose) and self._near(goal, rest)):
            return False
        if goal.heading is None:
            return True
        if abs(twist.omega) > 0.1:
            return False
        return abs(wrap_angle(goal.heading - state.pose.theta)) <= self.config.heading_tolerance

    def _say(self, state: str, reason: str, **more: object) -> None:
        self.status = replace(self.status, state=state, reason=reason, **more)  # type: ignore[arg-type]
