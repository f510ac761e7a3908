"""The hybrid navigator (section V): perceive, route, guidance, dynamic window, send."""

from collections.abc import Sequence

import numpy.typing as npt

from dynastar.config import counted, shown, summary
from dynastar.dwa.config import DwaConfig
from dynastar.dwa.dwa import Choice
from dynastar.geometry import Goal, Twist, as_goals
from dynastar.grid import OccupancyGrid
from dynastar.navigator.aligned import turned_disc, turned_goal
from dynastar.navigator.arrival import has_arrived, stays_near
from dynastar.navigator.braking import Acting, Commands
from dynastar.navigator.config import NavigatorConfig, fitted, margin_of, refined
from dynastar.navigator.driving import Driving
from dynastar.navigator.inputs import as_given_path, as_robot
from dynastar.navigator.last_turn import LastTurn, turn_by
from dynastar.navigator.mission import Mission
from dynastar.navigator.planners import Cells, Planners, radii_of
from dynastar.navigator.recovery import Recovery
from dynastar.navigator.replanning import Route
from dynastar.navigator.sensing import Sensing
from dynastar.navigator.status import RobotState, Status
from dynastar.path import Path
from dynastar.perception import MovingObstacle, PlanningMap
from dynastar.planning import Planner
from dynastar.robot import Robot
from dynastar.scan import LaserScan

Movers = Sequence[MovingObstacle] | None


class Navigator:
    """Takes a robot to its goals: give it every state and scan, and drive as it says.

    Single-threaded, without a clock of its own; ``command`` never raises while driving: trouble is
    a braking twist and a ``status``. A ``planner`` takes the place of dynastar's own, ``robot`` may be
    a name in ``ROBOTS``. Raises InputError if ``grid``, ``robot`` or ``config`` has the wrong type.

    The first command compiles the kernels, or loads them; ``dynastar.warm_up`` does that ahead.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        robot: Robot | str,
        config: NavigatorConfig = NavigatorConfig(),
        planner: Planner | None = None,
    ) -> None:
        robot = as_robot(grid, robot, config)
        config = fitted(config, robot)
        self.robot, self.config, self._grid = robot, config, grid
        planning_map = PlanningMap(grid, config.resolution, config.unknown)
        self.sensing = Sensing(robot, config, planning_map)
        self.mission = Mission()
        self._last_turn, self._planner = LastTurn(config), planner
        self._commands = Commands(robot.limits, config.period, config.latency, config.drive_error)
        self.route = Route(self._planners_on(planning_map), config, robot.limits)
        self.recovery = Recovery(self.mission, self.route, robot.limits, config)
        self.progress = self.recovery.progress
        self.retune(config.dwa)

    def __repr__(self) -> str:
        mission = f"{self.mission.state} ({shown(self.mission.reason)})"
        left = counted(len(self.mission.goals), "goal")
        return summary(self, f"robot {shown(self.robot.name)}", mission, left, self._grid.size())

    @property
    def planning_map(self) -> PlanningMap:
        """The map that paths are planned on: the user's map and what was sensed."""
        return self.sensing.planning_map

    @property
    def _yaw(self) -> float:
        """The angle (rad) by which the map frame is turned against the navigator's own."""
        return self.planning_map.grid.frame.yaw

    @property
    def _goal(self) -> Goal:
        """The goal that is driven to, in the navigator's own frame."""
        return turned_goal(self.mission.goals[0], -self._yaw)

    @property
    def planners(self) -> Planners:
        """The planners on the planning map."""
        return self.route.planners

    @property
    def explored(self) -> Cells:
        """The cells (m, 2) that the search of the last plan expanded, row by row."""
        return self.planners.explored(self.route.plan)

    @property
    def status(self) -> Status:
        """State of the navigator and its reason: a copy, as of the last command."""
        mission, route, choice = self.mission, self.route, self._choice
        hints: list[str] = []  # of the drive and the lidars
        if mission.state not in ("idle", "arrived", "sensor_lost"):
            hints = self._commands.check.hints(self.sensing.poses) + self.sensing.feed.hints
        return Status(
            state=mission.state,
            reason="; ".join([mission.reason, *hints]),
            replans=route.replans,
            recoveries=mission.recoveries,
            plan=route.plan,
            plan_id=route.plan_id,
            plan_reason=route.reason,
            planning_frame=self.planning_map.grid.frame,
            tracks=tuple(turned_disc(track, self._yaw) for track in self.sensing.tracker.tracks),
            limited_by="" if choice is None else choice.limited_by,
            goals_left=len(mission.goals),
            error=mission.error,
            choice=choice,
        )

    def retune(self, dwa: DwaConfig) -> None:
        """Use other settings of the dynamic window; path, goals and what was seen stay."""
        config = self.config = self.config._replace(dwa=dwa)
        self.driving = Driving(self.robot, config, self.sensing.local_map)
        self._choice: Choice | None = None

    def set_map(self, grid: OccupancyGrid) -> None:
        """Use another map, or raise InputError; what was seen nearby stays unless its yaw is another."""
        as_robot(grid, self.robot, self.config)
        self._use(grid, self.config)
        if self.mission.is_blocked:
            self._set_out(self.mission.goals, "a new map", self.route.given)

    def _use(self, grid: OccupancyGrid, config: NavigatorConfig) -> None:
        """Plan and drive on the cells of a map, none larger than ``config`` says."""
        planning_map = PlanningMap(grid, config.resolution, config.unknown)
        self._grid, self.config = grid, config
        sensing, driving = self.sensing, self.driving
        self.sensing = sensing.on_map(planning_map)
        self.driving = Driving(self.robot, config, self.sensing.local_map)
        if self.sensing is sensing:
            self.driving.carry_on(driving)
        else:  # places in the frame of the old map
            self.recovery.reset()
            self._last_turn.reset()
        self.route.set_map(self._planners_on(planning_map))

    def _refine(self) -> None:
        """Use cells half as wide, if these are wide for the robot: sensed cells close narrow ways."""
        config = refined(self.config, self.planning_map.grid, self.robot)
        if config is not self.config:
            self._use(self._grid, config)

    def forget(self) -> None:
        """Drop all that was sensed, but for the tracks."""
        self.planners.forget()
        self.sensing.forget()

    def continue_from(self, other: "Navigator") -> None:
        """Take over stop and mission, unless that is blocked, of another navigator of the same robot."""
        self.sensing = Sensing(self.robot, self.config, self.planning_map, under_way=True)
        self.retune(self.config.dwa)
        self._commands.continue_from(other._commands)
        if other.mission.goals and not other.mission.is_blocked:
            self._set_out(other.mission.goals, "other settings", other.route.given)

    def _planners_on(self, planning_map: PlanningMap) -> Planners:
        radii = radii_of(self.robot.footprint, margin_of(self.robot, self.config))
        return Planners(planning_map, self.config, radii, self._planner)

    # -- missions ---------------------------------------------------------------------------------

    def set_goal(self, goal: Sequence[float | None] | Sequence[Sequence[float | None]]) -> None:
        """Drive to one goal, or several in order: (x, y) metres and a heading in radians or None.

        Tuples do as well as Goals. The goals that are under way already change nothing. Raises InputError
        for a goal that is not valid.
        """
        self._set_out(goals := as_goals(goal), "new goal" if goals else "no goal")

    def follow(self, path: Path | npt.ArrayLike, heading: float | None = None) -> None:
        """Drive along a path (n, 2), metres, to its end and to a ``heading`` there, if given (rad).

        Nothing is planned. Obstacles on the path are passed within the local map, and waited for
        where that cannot be done. Loops that are shorter than what the robot drives within
        ``dwa.horizon`` are cut. Another path to the same end does not begin anew. Raises InputError for
        a path without points, one that is not finite, leads farther than 1e6 m from the map's origin or is
        longer than 1e5 m, and for a heading that a goal cannot have.
        """
        path, end = as_given_path(path, heading)
        self._set_out([end], "new path", path)

    def cancel(self) -> None:
        """Drop goals and path; the robot comes to rest by its certified stop and is idle."""
        self._set_out([], "cancelled")

    def _set_out(self, goals: Sequence[Goal], reason: str, path: Path | None = None) -> None:
        if self.mission.is_under_way_to(goals) and self.route.continue_along(path):
            return
        self.mission.begin(goals, reason)
        self._start_over(path)

    def _start_over(self, path: Path | None = None) -> None:
        """Forget path, manoeuvre and attempts of the last goal."""
        self.route.start_over(path)
        self.recovery.reset()
        self._last_turn.reset()
        self.driving.forget_manoeuvre()

    def forget_times(self) -> None:
        """Drop all that has stamps, as the clock is another one: goals, path and certified stop stay."""
        self.sensing = Sensing(self.robot, self.config, self.planning_map, under_way=True)
        self._commands.forget_times()
        self.retune(self.config.dwa)
        self.route.forget_times()
        self.recovery.reset()
        self._last_turn.reset()

    # -- the tick ---------------------------------------------------------------------------------

    def command(
        self,
        state: RobotState,
        scan: LaserScan | Sequence[LaserScan] | None,
        movers: Movers = None,
    ) -> Twist:
        """The twist to drive from now on; ``movers`` replaces what the tracker finds in the scans."""
        self._choice = None
        mission = self.mission
        last_resort = self.config.unseen_speed > 0.0 and self.progress.rounds > 1
        state, movers, fault = self.sensing.perceive(state, scan, movers, last_resort)
        if self.sensing.poses.clock_is_another:
            self.forget_times()
        self._commands.period = self.sensing.poses.period
        if fault is not None:
            mission.lose(fault)
            return self._commands.brake(state)
        if mission.regain():
            self.progress.restart(state.stamp)
        self.driving.window.set_period(self.sensing.poses.period)
        changed = self.planners.mark(self.planning_map.merge(self.sensing.local_map))
        acting = self._commands.when_one_acts(state)
        if mission.under_way and self._has_arrived(state, acting):
            mission.reach()
            self._start_over()
        if mission.under_way:
            self._update_route(state, changed, movers)
        if not mission.under_way:
            return self._commands.brake(state)
        command = self._decide(state, acting, movers)
        return self._commands.send(state, self.sensing.on_trial(state, command))

    def _has_arrived(self, state: RobotState, acting: Acting) -> bool:
        at_end, limits = self.route.is_at_end, self.robot.limits
        return at_end and has_arrived(self._goal, state.pose, acting, limits, self.config)

    def _update_route(self, state: RobotState, changed: bool, movers: Movers) -> None:
        """Keep, replace or drop the path, and tell the mission what that means."""
        guide, is_taken = self.driving.guide, self.sensing.is_moving_at(self._goal, movers)
        reachable = guide is None or guide.reachable
        event = self.route.update(state, self.mission.goals[0], changed, reachable, is_taken)
        if event.is_new:
            self.mission.error = None
            self.progress.measure_anew()
        if event.blocked:
            self.mission.block(event.blocked, event.error)

    def _decide(self, state: RobotState, acting: Acting, movers: Movers) -> Twist | None:
        """The command, by the dynamic window or to turn to the goal's heading; None to stop."""
        if self.recovery.is_stopping:
            self.recovery.go_on(state, self._refine)
            return None
        pose, measured = acting
        twist = self._commands.carried_on(measured)
        stops = self._commands.stops_from(state, acting, twist)
        driving = self.driving
        view = self.sensing.view(state.stamp, movers, driving.times)
        target = self._last_turn.target(pose) or self.route.target(driving.lookahead)
        closed = self.planners.closed_under(self.sensing.local_map)
        scene = driving.scene(pose, state.twist.v, view, target, closed, self.planning_map)
        goal, limits, in_vain = self._goal, self.robot.limits, self._commands.check.turned_in_vain
        is_there = self.route.is_at_end and stays_near(goal, pose, acting, limits, self.config)
        if goal.heading is not None and is_there and self.route.path is not None:
            rules, turn = driving.window.rules, self._last_turn
            angle = turn.angle(scene, rules, pose, goal.heading)
            turn.judge(self.mission, state.stamp, angle)
            if angle is not None:
                driving.forget_manoeuvre()
                period = self.sensing.poses.period
                command = turn_by(angle, turn.short_by, twist, limits, period, in_vain)
                return command if driving.window.admits(scene.around, stops, command) else None
            if not turn.finds_place(scene, rules, pose, goal, state.stamp):
                return None
        if self.recovery.drives_out(scene, driving.window, pose, state.stamp):
            driving.forget_manoeuvre()
            way_out = self.recovery.way_out
            return way_out.command(scene, driving.window, pose, twist, stops, in_vain)
        choice = self._choice = driving.choose(pose, twist, scene, stops)
        assert driving.guide is not None
        self.mission.say_driving(choice, len(view.moving.obstacles) > 0, self.route.waits_because)
        self.recovery.judge(state, driving.guide.cost_at)
        goes_on = self.mission.under_way and not self.recovery.is_stopping
        return choice.command if goes_on else None
