"""The hybrid navigator (section V): perceive, plan, decide, send."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from dynastar.clearance import DistanceField, lower_bounds
from dynastar.config import choose
from dynastar.dwa.clearance import kept_margin
from dynastar.dwa.config import DwaConfig
from dynastar.dwa.dwa import Choice, DynamicWindow
from dynastar.dwa.scene import AT_REST, Scene
from dynastar.errors import InputError
from dynastar.geometry import Goal, Pose2D, Twist, as_goals, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator.braking import Commands
from dynastar.navigator.config import NavigatorConfig, fitted
from dynastar.navigator.guidance import Guidance
from dynastar.navigator.mission import Mission
from dynastar.navigator.planning_map import PlanningMap
from dynastar.navigator.progress import Progress
from dynastar.navigator.replanning import Route
from dynastar.navigator.sensing import Sensing
from dynastar.navigator.status import RobotState, Status, as_floats
from dynastar.navigator.warm_up import ROOM, Straight, drive_a_little
from dynastar.path import Path
from dynastar.perception import MovingObstacle
from dynastar.perception.prediction import predict
from dynastar.planning import Planner, warm_up_all
from dynastar.robot import ROBOTS, Robot, slew
from dynastar.scan import LaserScan

GENTLE = 0.7  # of the braking that slowing down for a speed limit or a heading uses
PLAN_MARGIN = 0.03  # m beyond the footprint that a plan keeps clear
KEPT = 3.0  # least weight of keeping to a path that was given
STANDING = 0.02  # m/s up to which the robot is said to wait


class Navigator:
    """Takes a robot to its goals: give it every state and scan, and drive as it says.

    Single-threaded, without a clock of its own; ``command`` never raises while driving: trouble is
    a braking twist and a ``status``. A ``planner`` takes the place of dynastar's own, ``robot`` may be
    a name in ``ROBOTS``. Raises InputError for a map, robot or settings that are none.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        robot: Robot | str,
        config: NavigatorConfig = NavigatorConfig(),
        planner: Planner | None = None,
    ) -> None:
        robot = choose(robot, ROBOTS, "robot") if isinstance(robot, str) else robot
        for what, value, kind in (
            ("a map", grid, OccupancyGrid),
            ("a robot", robot, Robot),
            ("a navigator's settings", config, NavigatorConfig),
        ):
            if not isinstance(value, kind):
                raise InputError(
                    f"{what}: got {type(value).__name__}, expected {kind.__name__}"
                    + ("" if kind is not Robot else f", or one of {', '.join(ROBOTS)}")
                )
        if not config.reverse:
            robot = replace(robot, limits=robot.limits._replace(v_min=max(robot.limits.v_min, 0.0)))
        config = fitted(config, robot.footprint.inscribed)
        self.robot, self.config = robot, config
        half_diagonal = config.local_map.resolution / math.sqrt(2.0)
        lever = math.hypot(robot.lidar.x, robot.lidar.y)
        if not robot.footprint.is_disc:
            lever += robot.footprint.circumscribed
        self.margin = half_diagonal + 2.0 * config.pose_error + config.heading_error * lever
        self.sensing = Sensing(robot, config)
        self.retune(config.dwa)
        self.progress = Progress(config.stuck_time)
        self.mission = Mission()
        self._planner = planner
        self._choice: Choice | None = None
        self._asked: tuple[Pose2D, Twist, Scene, Twist] | None = None
        self._commands = Commands(robot.limits, config.period, config.latency)
        self.planning_map = self._planning_map_of(grid)
        self.route = Route(self.planning_map, self.mission, config)
        if planner is None:
            warm_up_all()
        warm_up()

    @property
    def status(self) -> Status:
        """State of the navigator and its reason: a copy, as of the last command."""
        mission, route, choice = self.mission, self.route, self._choice
        return Status(
            mission.state,
            mission.reason,
            route.replans,
            mission.recoveries,
            route.plan,
            route.plan_id,
            route.reason,
            self.planning_map.frame,
            self.sensing.tracker.tracks,
            "" if choice is None else choice.limited_by,
            len(mission.goals),
            mission.error,
            choice,
        )

    def survey(self) -> Choice | None:
        """The last command's candidates with the scores of all; None where none were searched.

        For pictures: it takes longer than ``command``, and changes nothing. Call it before the next.
        """
        if self._asked is None or self.window.complete:
            return self._choice
        return self.window.survey(*self._asked)

    def retune(self, dwa: DwaConfig) -> None:
        """Other settings of the dynamic window from now on; path, goals and what was seen stay."""
        config = self.config = self.config._replace(dwa=dwa)
        self.window = DynamicWindow(self.robot, dwa, config.period)
        self.guidance = Guidance(
            len(self.sensing.local_map.states),
            config.local_map.resolution,
            self.robot.footprint.inscribed + self.margin,
            dwa.comfort,
            dwa.weights.simi > 0.0,
        )
        self._last = AT_REST

    def set_map(self, grid: OccupancyGrid) -> None:
        """Another map; what was seen is kept round the robot, the next tick plans anew."""
        self.planning_map = self._planning_map_of(grid)
        self.route.set_map(self.planning_map)
        if self.mission.state == "blocked":
            self._set_out(self.mission.goals, "a new map")

    def _planning_map_of(self, grid: OccupancyGrid) -> PlanningMap:
        shape = self.robot.footprint
        radii = shape.circumscribed + self.margin, shape.inscribed + PLAN_MARGIN
        self.sensing.set_grid(grid)
        return PlanningMap(grid, self.config, radii, self._planner)

    def set_goal(self, goal: Sequence[float | None] | Sequence[Sequence[float | None]]) -> None:
        """One goal, or several to reach in order: (x, y) metres and a heading in radians or None.

        Tuples do as well as Goals. Raises InputError for what is no goal.
        """
        goals = as_goals(goal)
        self._set_out(goals, "new goal" if goals else "no goal")

    def follow(self, path: Path | npt.ArrayLike, heading: float | None = None) -> None:
        """Drives along a path (n, 2), metres, to its end and to a ``heading`` there, if given (rad).

        Nothing is planned. Obstacles on the path are passed within the local map, and waited for
        where that cannot be done. Loops that are shorter than what the robot drives within
        ``dwa.horizon`` are cut. Raises InputError for a path without points or not finite.
        """
        path = path if isinstance(path, Path) else Path(np.asarray(path, dtype=np.float64))
        if heading is not None and not math.isfinite(heading):
            raise InputError(f"the heading at the end is {heading}: expected radians or None")
        x, y = map(float, path.points[-1])
        self._set_out([Goal(x, y, heading)], "new path", path)

    def cancel(self) -> None:
        """Drops goals and path; the robot comes to rest by its certified stop and is idle."""
        self._set_out([], "cancelled")

    def _set_out(self, goals: Sequence[Goal], reason: str, path: Path | None = None) -> None:
        self.mission.begin(goals, reason)
        self._start_over(path)

    def _start_over(self, path: Path | None = None) -> None:
        """Forgets path, manoeuvre and attempts of the last goal."""
        self.route.start_over(path)
        self.progress.reset()
        self._last = AT_REST

    def command(
        self,
        state: RobotState,
        scan: LaserScan | Sequence[LaserScan] | None,
        movers: Sequence[MovingObstacle] | None = None,
    ) -> Twist:
        """The twist to drive from now on; ``movers`` replaces what the tracker finds in the scans."""
        self._choice, self._asked = None, None
        state, mission = self._within_limits(as_floats(state)), self.mission
        fault = self._perceive(state, scan)
        if fault is not None:
            mission.lose(fault)
            return self._commands.brake(state)
        if mission.regain():
            self.progress.restart(state.stamp)
        changed = self.planning_map.take_in(self.sensing.local_map)
        if mission.under_way and self._arrived(state):
            mission.reach()
            self._start_over()
        if mission.under_way and self.route.keep(state, changed, self.guidance.reachable):
            self.progress.restart(state.stamp)
        if not mission.under_way:
            return self._commands.brake(state)
        return self._commands.send(state, self._decide(state, movers))

    def _perceive(
        self, state: RobotState, scan: LaserScan | Sequence[LaserScan] | None
    ) -> str | None:
        """Takes in where the robot is and what it sees; what is wrong with that, in words, or None."""
        scans = [] if scan is None else [scan] if isinstance(scan, LaserScan) else list(scan)
        fault = self.sensing.place(state)
        return fault or self.sensing.take_in(scans, state.stamp, self.planning_map.known)

    def _within_limits(self, state: RobotState) -> RobotState:
        """The state without speeds that the robot cannot have, as a glitch of the odometry reports."""
        v, omega = state.twist
        if not (math.isfinite(v) and math.isfinite(omega)):
            return state
        limits = self.robot.limits
        v = min(max(v, limits.v_min), limits.v_max)
        omega = min(max(omega, -limits.omega_max), limits.omega_max)
        return state._replace(twist=Twist(v, omega))

    # -- driving ----------------------------------------------------------------------------------

    def _decide(self, state: RobotState, movers: Sequence[MovingObstacle] | None) -> Twist | None:
        """The command, by the dynamic window or to turn to the goal's heading; None to stop."""
        pose, measured = self._commands.when_one_acts(state)
        twist = self._commands.carried_on(measured)
        scene = self._scene(state, pose, movers)
        goal = self.mission.goals[0]
        if self.route.path is not None and goal.heading is not None and self._near(goal, pose):
            self.mission.say("turning", "to the goal's heading")
            self._last = AT_REST
            command = self._turned(pose, twist, goal.heading)
            return command if self.window.admits(pose, twist, scene, command, measured) else None
        self._asked = pose, twist, scene, measured
        choice = self._choice = self.window.choose(*self._asked)
        self._last = choice.left
        self._judge(state, choice, len(scene.people.now) > 0)
        return choice.command if self.mission.under_way else None

    def _scene(
        self, state: RobotState, pose: Pose2D, movers: Sequence[MovingObstacle] | None
    ) -> Scene:
        """The scene for the window at the time when a command takes effect."""
        config, limits, local = self.config, self.robot.limits, self.sensing.local_map
        span, resolution = self.window.span, local.config.resolution
        occupied = self.planning_map.stands_in(local)
        distances = lower_bounds((~occupied).view(np.uint8), resolution)
        obstacles = DistanceField(distances, *local.origin, resolution)
        moving = self.sensing.moving(state.stamp, movers)
        times = config.latency, span.step, span.horizon_steps
        people = predict(moving, config.prediction, times, obstacles)
        lead = self.route.lead(limits.v_max * span.step * span.horizon_steps)
        beside, cost_to_go = self.guidance.update(
            obstacles, lead, (pose.x, pose.y), people,
            (config.latency, span.step, limits.v_max, span.risk_radius),
        )  # fmt: skip
        hidden = self.sensing.unseen(occupied, state.stamp)
        stop = state.twist.v**2 / (2.0 * limits.v_brake)
        stop += abs(state.twist.v) * (config.latency + 2.0 * config.period)
        closed = DistanceField(local.field, *local.origin, resolution)
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
            beside,
            KEPT if lead.ahead < math.inf else 0.0,
        )

    def _speed_cap(self, pose: Pose2D) -> float:
        """The speed (m/s) that leaves room to slow down for the map's speed limits ahead."""
        if self.planning_map.grid.speed_limit is None:
            return self.robot.limits.v_max
        line = self.guidance.line
        ahead = np.maximum(np.arange(len(line)) - 1.0, 0.0) * self.guidance.spacing
        limit = self.planning_map.speed_limit(np.vstack([[pose.x, pose.y], line]))
        brake = 2.0 * GENTLE * self.robot.limits.v_brake
        slowed = np.sqrt(limit[1:] ** 2 + brake * ahead)
        return float(min(self.robot.limits.v_max, limit[0], slowed.min(initial=math.inf)))

    def _judge(self, state: RobotState, choice: Choice, people: bool) -> None:
        """Says what is going on, and starts anew where there has been no progress for long."""
        mission = self.mission
        standing = choice.command is None or abs(choice.command.v) < STANDING
        if self.route.path is None:
            mission.say("waiting", "there is no path for now")
            return
        if people and standing:
            mission.say("waiting", "a moving obstacle passes")
        elif choice.refusals["moving obstacle"]:
            mission.say("avoiding", "a moving obstacle is near")
        else:
            mission.say("following", "the path")
        here = (state.pose.x, state.pose.y)
        if not self.progress.stuck(state.stamp, here, self.guidance.cost_to_go):
            return
        if self.progress.rounds > self.config.attempts:
            mission.block("no progress, whatever was tried")
            return
        self.route.drop()
        mission.recover(state.stamp, "no progress: forget what was sensed and plan anew")

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
        goal = self.mission.goals[0]
        pose, twist = self._commands.when_one_acts(state)
        stop = 0.5 * twist.v * abs(twist.v) / self.robot.limits.v_brake
        rest = pose._replace(
            x=pose.x + stop * math.cos(pose.theta), y=pose.y + stop * math.sin(pose.theta)
        )
        at_end = self.route.ends_within(self.config.goal_tolerance)
        if not (at_end and self._near(goal, state.pose) and self._near(goal, rest)):
            return False
        if goal.heading is None:
            return True
        if abs(twist.omega) > 0.1:
            return False
        return abs(wrap_angle(goal.heading - state.pose.theta)) <= self.config.heading_tolerance


_warm = False


def warm_up() -> None:
    """Compiles or loads what commands call, once a process."""
    global _warm
    if not _warm:
        _warm = True
        config = NavigatorConfig(latency=0.1)
        drive_a_little(Navigator(ROOM, ROBOTS["jackal"], config, Straight()))
