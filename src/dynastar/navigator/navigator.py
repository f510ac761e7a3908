"""The hybrid navigator (section V): plan, follow, avoid, replan, recover, arrive or say why not."""

import logging
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynastar.clearance import distance_field
from dynastar.dwa import Choice, DynamicWindow, Margins, Passing, Start, Surroundings, Wish
from dynastar.errors import GoalOccupied, NoPath, PlanningError
from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator.braking import REST, Commands
from dynastar.navigator.chart import Chart
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.lookout import Lookout
from dynastar.navigator.profile import SpeedProfile, bend_speed, points, wary_speed
from dynastar.navigator.progress import Progress
from dynastar.navigator.recovery import Recovery
from dynastar.navigator.senses import Senses
from dynastar.navigator.status import RobotState, Status
from dynastar.navigator.target import at_bearing, leading_away, local_target, on_one_side
from dynastar.obstacles import MovingObstacle
from dynastar.path import Path
from dynastar.robot import Robot
from dynastar.scan import LaserScan

log = logging.getLogger("dynastar")

FASTER = 1e-3  # m/s by which going on past movers is worth more than what the window chose
OUT_OF_SIGHT = "the path is out of sight"
PATH_SPACING = 0.1  # m between the points of the path that simi compares with


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
        self.robot, self.config = robot, config
        half_diagonal = config.layer.resolution / math.sqrt(2.0)
        lever = math.hypot(robot.lidar.x, robot.lidar.y)
        if not robot.footprint.is_disc:
            lever += robot.footprint.circumscribed
        self.margins = Margins(
            half_diagonal + 2.0 * config.pose_error + config.heading_error * lever,
            config.mover_margin + config.pose_error,
            config.mover_error,
            config.linger,
        )

        self.window = DynamicWindow(robot, config.dwa, config.period)
        self.passing = Passing(robot, config.period)
        self.senses = Senses(robot, config)
        self.lookout = Lookout(robot, config)
        self.progress, self.recovery = Progress(), Recovery(config)
        self.status = Status()
        self._goals: list[Goal] = []
        self._path: Path | None = None
        self._s = self._clear_from = 0.0
        self._commands = Commands(robot.limits, config.period, config.latency)
        self._waiting_since: float | None = None
        # So fast that it can stop for what comes into view at the edge of sight.
        self._wary = wary_speed(robot.limits, config.mover_speed, robot.lidar.range_max)
        self.set_map(grid)

    def set_map(self, grid: OccupancyGrid) -> None:
        """Another map; what was seen is kept round the robot, the next tick plans anew."""
        shape = self.robot.footprint
        # What a certified stop needs, and what the field between its cells may fall short by.
        margin = self.margins.standing + 0.5 * self.config.layer.resolution
        self.chart = Chart(
            grid, self.config, shape.circumscribed + margin, shape.inscribed + margin
        )
        self.senses.set_grid(grid)
        self._path = None
        self.status = replace(self.status, planning_frame=self.chart.frame)
        if self.status.state == "blocked":
            self.set_goal(self._goals)

    def set_goal(self, goal: Goal | Sequence[Goal]) -> None:
        """One goal, or several to reach in order: (x, y) metres and a heading in radians or None."""
        goals = [goal] if isinstance(goal, Goal) else [Goal(*g) for g in goal]
        for x, y, heading in goals:
            if not all(map(math.isfinite, (x, y, heading or 0.0))):
                raise ValueError(f"a goal is ({x}, {y}, {heading}): expected finite numbers")
        self._goals = goals
        self._path = None
        self.recovery.reset()
        self._say("following" if goals else "idle", "new goal" if goals else "no goal", error=None)

    def command(
        self,
        state: RobotState,
        scan: LaserScan | Sequence[LaserScan] | None,
        movers: Sequence[MovingObstacle] | None = None,
    ) -> Twist:
        """The twist to drive from now on; ``movers`` replaces what the tracker finds in the scans."""
        scans = [] if scan is None else [scan] if isinstance(scan, LaserScan) else list(scan)
        fault = self.senses.place(state)
        if fault is None:
            fault = self.senses.take_in(scans, state.stamp, self.chart.known)
        if fault is not None:
            self._say("sensor_lost", fault, choice=None)
            return self._commands.brake(state)
        if self.status.state == "sensor_lost":
            self._say("following" if self._goals else "idle", "data are back")
            self.progress.restart(state.stamp)
        around = self.senses.surroundings(state.stamp, movers)
        changed = self.chart.take_in(self.senses.layer)
        self.status = replace(
            self.status, tracks=self.senses.tracker.movers, goals_left=len(self._goals)
        )
        if not self._goals or self.status.state == "blocked":
            return self._commands.brake(state)
        if self._arrived(state):
            self._goals.pop(0)
            self._path = None
            self.recovery.reset()
            if not self._goals:
                self._say("arrived", "the goal is reached", goals_left=0)
                return self._commands.brake(state)
        if not self._plan(state, changed):
            return self._commands.brake(state)
        return self._drive(state, around)

    # -- planning ---------------------------------------------------------------------------------

    def _plan(self, state: RobotState, changed: bool) -> bool:
        """Keeps a path that leads to the goal; False if there is none for now."""
        here = (state.pose.x, state.pose.y)
        if self.config.global_path == "straight":
            if self._path is None:
                self.progress.restart(state.stamp)
            self._follow(Path(np.array([here, self._goals[0][:2]])))
            return True
        if self._path is None:
            return self._replan(state, self.recovery.reason or "a plan is needed")
        self._s = self._path.project(*here, low=self._s - 0.5, high=self._s + 2.0)
        if self.config.global_path == "once":
            return True
        if self.progress.unseen(state.stamp, 2.0) and self.recovery.may_replan(state.stamp):
            return self._replan(state, OUT_OF_SIGHT)
        foot = self._path.at(self._s)
        if math.dist(foot, here) > self.config.deviation:
            return self._replan(state, "avoiding led away from the path")
        if changed:
            begin = max(self._s, self._clear_from + 1e-3)
            rest = self._path.points[self._path.arc > begin]
            if (
                len(rest)
                and self.chart.blocked_at(np.vstack([self._path.at(begin), rest])) is not None
            ):
                return self._replan(state, "an obstacle blocks the path")
        return True

    def _replan(self, state: RobotState, reason: str) -> bool:
        goal = self._goals[0]
        first = self.status.plan_id == 0
        try:
            plan = self.chart.plan((state.pose.x, state.pose.y), (goal.x, goal.y), explored=True)
        except PlanningError as error:
            return self._no_plan(state, error)
        self._follow(plan.path, plan.clear_from)
        if reason == OUT_OF_SIGHT:
            self.progress.rebase()
        else:
            self.progress.restart(state.stamp)
        self.status = replace(
            self.status,
            plan=plan,
            plan_id=self.status.plan_id + 1,
            plan_reason=reason,
            replans=self.status.replans + (0 if first else 1),
            error=None,
        )
        return True

    def _follow(self, path: Path, clear_from: float = 0.0) -> None:
        """Takes a path, which is as clear as it should be from ``clear_from`` metres on."""
        self._path, self._s, self._clear_from = path, 0.0, clear_from
        self._profile = SpeedProfile(path, self.robot.limits, self.chart.speed_limit(points(path)))

    def _no_plan(self, state: RobotState, error: PlanningError) -> bool:
        """No way on the chart: what was seen may be gone, so forget it once and wait a little."""
        passing = isinstance(error, (NoPath, GoalOccupied)) and bool(self.chart.seen.any())
        if passing or self.senses.tracker.movers:
            if self.recovery.give_up():
                self._say("blocked", f"no way is left: {error}", error=error)
            elif self.recovery.may_forget(state.stamp):
                self.chart.forget()
                self._recovered(state, "forget what was seen: no way is left")
            return False
        self._say("blocked", str(error), error=error)
        return False

    # -- driving ----------------------------------------------------------------------------------

    def _drive(self, state: RobotState, around: Surroundings) -> Twist:
        assert self._path is not None
        config, now = self.config, state.stamp
        pose, twist = self._commands.when_one_acts(state)
        goal = self._goals[0]
        tight = self.robot.footprint.inscribed + self.margins.standing
        clearances = (tight + config.comfort, tight)
        if config.target == "distance":
            target, seen = self._path.at(self._s + config.lookahead), True
        else:
            target, seen = local_target(
                self._path, self._s, state.pose[:2], config.lookahead, clearances, around
            )
        if self._s < self._clear_from - 0.05:  # first out of where it is too tight
            target, seen = self._path.at(self._clear_from), True
        spare = self.window.clearance(around, state.pose) - self.margins.standing
        if spare < 0.25 * config.layer.resolution:
            target = leading_away(target, (state.pose.x, state.pose.y), around)
        near = math.hypot(goal.x - state.pose.x, goal.y - state.pose.y) <= config.goal_tolerance
        heading = goal.heading if near else None
        aligning = heading is not None
        if heading is not None:
            target = at_bearing(state.pose, heading - state.pose.theta)
        target, bearing = on_one_side(target, state.pose, state.twist.omega)
        self.progress.note_sight(now, seen)
        if self.progress.note(now, self._path.length - self._s, bearing):
            self.recovery.progressed(now)
        careful = self.lookout.speed(
            now, state.twist.v, self._wary, self._path, self._s,
            self.senses.layer, self.chart, self.senses.tracker,
        )  # fmt: skip
        wish = Wish(
            target,
            self._path.paced(
                self._s, self._s + self.robot.limits.v_max * config.dwa.horizon, PATH_SPACING
            ),
            PATH_SPACING,
            min(
                self._profile.at(self._s),
                self._profile.at(self._s + state.twist.v * (2.0 * config.period + config.latency)),
                self._wary,
                careful,
                float(bend_speed(abs(bearing), self.robot.limits)),
            ),
        )
        if self.recovery.active(now):
            return self._recover(state, pose, twist, around, wish)
        choice = self.window.choose(
            pose, twist, around, wish, self._margins(state), config.latency, turn_only=aligning
        )
        self._judge(state, choice, seen, aligning, target)
        if self.recovery.active(now):
            return self._recover(state, pose, twist, around, wish)
        return self._carry_out(state, choice, pose, twist, around, wish)

    def _judge(
        self,
        state: RobotState,
        choice: Choice,
        seen: bool,
        aligning: bool,
        target: tuple[float, float],
    ) -> None:
        """Says what is going on, and starts a recovery when nothing is."""
        now = state.stamp
        held_up = choice.refused_for_movers > 0
        slow = abs(state.twist.v) < 0.05 and (
            choice.command is None or abs(choice.command.v) < 0.05
        )
        if held_up and slow and not aligning:
            if self._waiting_since is None:
                self._waiting_since = now
            if now - self._waiting_since < self.config.patience:
                self.progress.restart(now)
                self._say("waiting", "a mover passes", choice=choice, target=target)
                return
        else:
            self._waiting_since = None
        if self.progress.stuck(now, self.config.stuck_time):
            self._stuck(state)
        elif aligning:
            self._say("turning", "to the goal's heading", choice=choice, target=target)
        elif seen:
            self._say("following", "the path", choice=choice, target=target)
        else:
            self._say("avoiding", "the path cannot be seen from here", choice=choice, target=target)

    def _stuck(self, state: RobotState) -> None:
        """The next gentlest way out: turn, back off, forget, replan; in the end, give up."""
        if self.recovery.give_up():
            self._say("blocked", "no progress, whatever was tried")
            return
        step = self.recovery.next(state.stamp, self.robot.limits.v_min < 0.0)
        self._recovered(state, step)
        if step == "forget":
            self.senses.forget()
            self.chart.forget()
        if step in ("forget", "replan") and self.config.global_path == "replanned":
            self._path = None
        self.progress.restart(state.stamp)

    def _recovered(self, state: RobotState, detail: str) -> None:
        log.info("recovery at %.1f s: %s", state.stamp, detail)
        self._say("recovering", detail, recoveries=self.status.recoveries + 1)

    def _recover(
        self, state: RobotState, pose: Pose2D, twist: Twist, around: Surroundings, wish: Wish
    ) -> Twist:
        """Turns towards the path, or backs straight off, through the same window and promise.

        Where it would stand in the way of movers it gets out of their way first.
        """
        back_off = self.recovery.step == "back off"
        if back_off:
            command = self.window.back_off(
                pose, twist, around, self._margins(state), self.config.latency
            )
            self._say("recovering", "back off", target=at_bearing(pose, math.pi))
        else:
            choice = self.window.choose(
                pose, twist, around, wish, self._margins(state), self.config.latency, turn_only=True
            )
            command = choice.command
            self._say("recovering", "turn towards the path", choice=choice, target=wish.target)
        if len(around.movers) and (command is None or command == REST):
            start, limit = self._start(state, pose, twist, around, wish)
            command = self.passing.evade(start, limit) or command
        return self._commands.send(state, command)

    def _carry_out(
        self,
        state: RobotState,
        choice: Choice,
        pose: Pose2D,
        twist: Twist,
        around: Surroundings,
        wish: Wish,
    ) -> Twist:
        """Drives as chosen, out of the way of movers if standing is no good, or brakes."""
        command = choice.command
        idle = command is None or command == REST
        if len(around.movers) and (choice.refused_for_movers or idle):
            start, limit = self._start(state, pose, twist, around, wish)
            past = self.passing.go_on(
                start,
                faster_than=-math.inf if command is None else command.v + FASTER,
                v_limit=min(limit, self._wary),
                hoped=self._hoped(state, around),
            )
            if past is None and idle:
                past = self.passing.evade(start, limit)
            command = command if past is None else past
        return self._commands.send(state, command)

    def _start(
        self, state: RobotState, pose: Pose2D, twist: Twist, around: Surroundings, wish: Wish
    ) -> tuple[Start, float]:
        """Where a way past movers begins, and the map's speed limit (m/s) there."""
        ahead = np.arange(len(wish.path), dtype=np.float64)
        pace = self._profile.along(self._s + PATH_SPACING * ahead)
        path = np.column_stack([wish.path, pace])
        limit = float(self.chart.speed_limit(np.array([pose[:2]]))[0])
        start = Start(pose, twist, around, path, self._margins(state), self.config.latency)
        return start, limit

    def _hoped(self, state: RobotState, around: Surroundings) -> Surroundings | None:
        """After long in one place, the surroundings with what is out of sight as the chart has it."""
        if not self.progress.dwells(state.stamp, state.pose[:2], self.config.patience):
            return None
        blocked = self.chart.blocked_under(self.senses.layer)
        return around._replace(field=distance_field(blocked, around.resolution))

    def _margins(self, state: RobotState) -> Margins:
        """The margins, with what a heading error adds over the length of a stop."""
        limits = self.robot.limits
        stop = state.twist.v**2 / (2.0 * limits.v_brake)
        ahead = abs(state.twist.v) * (self.config.latency + 2.0 * self.config.period)
        return self.margins._replace(
            standing=self.margins.standing + self.config.heading_error * (stop + ahead)
        )

    # -- the end ----------------------------------------------------------------------------------

    def _arrived(self, state: RobotState) -> bool:
        goal = self._goals[0]
        if math.hypot(goal.x - state.pose.x, goal.y - state.pose.y) > self.config.goal_tolerance:
            return False
        if goal.heading is None:
            return True
        return abs(wrap_angle(goal.heading - state.pose.theta)) <= self.config.heading_tolerance

    def _say(self, state: str, reason: str, **more: object) -> None:
        self.status = replace(self.status, state=state, reason=reason, **more)  # type: ignore[arg-type]
