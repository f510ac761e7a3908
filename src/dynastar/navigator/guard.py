"""The navigator's safety alone: a guard for the commands of any other controller."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynastar.config import shown, summary
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator.admissibility import Admissibility
from dynastar.navigator.aligned import turned_pose
from dynastar.navigator.arrival import GENTLE_BRAKING
from dynastar.navigator.braking import REST, Acting, Commands
from dynastar.navigator.config import NavigatorConfig, fitted
from dynastar.navigator.inputs import as_robot
from dynastar.navigator.sensing import Sensing
from dynastar.navigator.status import RobotState, is_finite, slowed
from dynastar.perception import MovingObstacle
from dynastar.perception.planning_map import NoMap, PlanningMap
from dynastar.robot import Robot, poses_along, stopping_time
from dynastar.scan import LaserScan

SAME = 1e-9  # m/s and rad/s, by which a command that is passed on may differ
STEADY = 0.5  # s for which a robot that was held back could hold what it speeds up to
STOP_POSES = 16  # of the way to a stop
TOO_SLOW = "slower than the drive can"
LIDAR_TEST = "slower, to test a lidar"


@dataclass(frozen=True)
class Guarded:
    """What a guard makes of a command: the ``command`` to drive, and how it differs.

    ``changed`` tells whether it is another one than given, ``reason`` why: "acceleration" (the robot
    needs more time), "speed limit" (of the robot or the map), "slower than the drive can",
    "no certified stop", "moving obstacle", "unseen space", "slower, to test a lidar" (one that told
    nothing new), or what is wrong with the data or the command. It is "" if nothing was changed.
    """

    command: Twist
    changed: bool
    reason: str = ""

    def __repr__(self) -> str:
        driven = f"{self.command.v:.2f} m/s and {self.command.omega:.2f} rad/s"
        return summary(self, driven, f"changed ({shown(self.reason)})" if self.changed else "")


class Guard:
    """Lets only commands pass after which the robot can still stop, from whatever source.

    Give it every state and scan with the controller's command, and drive as it says. It needs no goal
    and no map; with a ``grid``, its keep-out zones and speed limits count. Sensing, the declared
    errors and the check of a command are those of ``Navigator``.

    Single-threaded, without a clock of its own; ``filter`` never raises. ``robot`` may be a name in
    ``ROBOTS``. Raises InputError if ``robot``, ``config`` or ``grid`` has the wrong type.

    The first command compiles the kernels, or loads them; ``dynastar.warm_up`` does that ahead.
    """

    def __init__(
        self,
        robot: Robot | str,
        config: NavigatorConfig | None = None,
        grid: OccupancyGrid | None = None,
    ) -> None:
        config = NavigatorConfig() if config is None else config
        robot = as_robot(NoMap().grid if grid is None else grid, robot, config)
        config = fitted(config, robot)
        self.robot, self.config = robot, config
        self.sensing = Sensing(robot, config, self._planning_map(grid))
        self._check = Admissibility(robot, config)
        self._commands = Commands(robot.limits, config.period, config.latency, config.drive_error)
        self._acts_at: Pose2D | None = None  # in the map frame, where the last command acts from
        self._cut = False  # whether the last command was held back
        self.last = Guarded(Twist(0.0, 0.0), False)

    def __repr__(self) -> str:
        on = "no map" if isinstance(self._map, NoMap) else self._map.grid.size()
        return summary(self, f"robot {shown(self.robot.name)}", on, repr(self.last))

    def set_map(self, grid: OccupancyGrid | None) -> None:
        """Use another map, or none. What was seen is kept, unless the map has another yaw.

        Raises InputError if the map is not valid.
        """
        if grid is not None:
            as_robot(grid, self.robot, self.config)
        self.sensing = self.sensing.on_map(self._planning_map(grid))

    def _planning_map(self, grid: OccupancyGrid | None) -> PlanningMap:
        config = self.config
        if grid is None:
            return NoMap(config.resolution)
        return PlanningMap(grid, config.resolution, config.unknown)

    @property
    def _map(self) -> PlanningMap:
        return self.sensing.planning_map

    @property
    def hints(self) -> list[str]:
        """What has been odd about drive, odometry and lidars for some seconds."""
        return self._commands.check.hints(self.sensing.poses) + self.sensing.feed.hints

    @property
    def stop(self) -> npt.NDArray[np.float64]:
        """Poses (n, 3) of the way to rest that is free after the last command: x, y (m), heading (rad).

        There are none before the first state with a pose.
        """
        command = self.last.command
        if self._acts_at is None:
            return np.empty((0, 3))
        duration = self.config.period + 0.5 * stopping_time(command, self.robot.limits)
        return poses_along(self._acts_at, command, np.linspace(0.0, duration, STOP_POSES))

    def filter(
        self,
        state: RobotState,
        scan: LaserScan | Sequence[LaserScan] | None,
        command: Twist | None,
        movers: Sequence[MovingObstacle] | None = None,
    ) -> Guarded:
        """The ``command`` if the robot can stop after it, or what comes nearest to it.

        That is the same arc driven slower, else a turn on the spot, else the stop that was certified
        last. None for a command brakes, as does one that is not finite and all that makes the
        navigator brake. ``movers`` replaces what the tracker finds in the scans.
        """
        given, wrong = _as_twist(command)
        state, movers, fault = self.sensing.perceive(state, scan, movers)
        if self.sensing.poses.clock_is_another:
            self.forget_times()
        acting = self._commands.when_one_acts(state)
        if is_finite(state):
            self._acts_at = turned_pose(acting.pose, self._map.grid.frame.yaw)
        self._commands.period = self.sensing.poses.period
        fault = fault or wrong
        if fault is not None:
            return self._done(given, self._commands.brake(state), fault)
        self._check.window.set_period(self.sensing.poses.period)
        chosen, reason = self._nearest(state, acting, movers, given)
        return self._done(given, self._commands.send(state, chosen), reason)

    def forget_times(self) -> None:
        """Begin anew with another clock: what was sensed is dropped, the stop is still continued."""
        self.sensing = Sensing(self.robot, self.config, self._map, under_way=True)
        self._commands.forget_times()

    def _nearest(
        self,
        state: RobotState,
        acting: Acting,
        movers: Sequence[MovingObstacle] | None,
        given: Twist,
    ) -> tuple[Twist | None, str]:
        """The admissible command nearest to the one given, None to stop, and why it differs."""
        pose, measured = acting
        twist = self._commands.carried_on(measured)
        stops = self._commands.stops_from(state, acting, twist)
        view = self.sensing.view(state.stamp, movers, self._check.times)
        asked = self._within_limits(pose, given)
        around = self._check.surroundings(pose, state.twist.v, view)
        steady = STEADY if self._cut else 0.0
        command, refusal = self._check.window.nearest(around, stops, twist, asked, steady)
        self._cut = bool(refusal)
        tried = self.sensing.on_trial(state, command)
        if refusal or tried == command:
            return tried, refusal or self._limit(given, asked, command)
        return tried, LIDAR_TEST

    def _limit(self, given: Twist, asked: Twist, command: Twist | None) -> str:
        """Which limit a command keeps that is not the one given."""
        least = (self.robot.limits.v_least, self.robot.limits.omega_least)
        speeds = zip(asked, command or REST, least, strict=True)
        if any(driven == 0.0 < abs(wanted) < lowest for wanted, driven, lowest in speeds):
            return TOO_SLOW
        return "acceleration" if asked == given else "speed limit"

    def _within_limits(self, pose: Pose2D, given: Twist) -> Twist:
        """The command given, on the same arc within the limits of the robot and of the map's zones."""
        limits, spacing = self.robot.limits, self._map.grid.resolution
        v = max(given.v, 0.0) if limits.v_min == 0.0 else given.v
        way = limits.v_max**2 / (2.0 * GENTLE_BRAKING * limits.v_brake)
        lengths = spacing * np.arange(1.0, math.ceil(way / spacing) + 2.0)
        line = poses_along(pose, Twist(v, given.omega), lengths / max(abs(v), SAME))
        cap = self._check.speed_cap(pose, line[:, :2], spacing, self._map)
        highest = min(cap, -limits.v_min if v < 0.0 else limits.v_max)
        return slowed(Twist(v, given.omega), Twist(highest, limits.omega_max))

    def _done(self, given: Twist, command: Twist, reason: str) -> Guarded:
        away = max(abs(command.v - given.v), abs(command.omega - given.omega))
        changed = not away <= SAME
        self.last = Guarded(command, changed, reason if changed else "")
        return self.last


def _as_twist(command: Twist | None) -> tuple[Twist, str | None]:
    """The command as floats, NaN if it is not valid, and what is wrong with it or None."""
    nothing = Twist(math.nan, math.nan)
    if command is None:
        return nothing, "no command"
    try:
        v, omega = map(float, command)
    except (TypeError, ValueError, OverflowError):
        v = omega = math.nan
    if math.isfinite(v) and math.isfinite(omega):
        return Twist(v, omega), None
    return nothing, f"the command is {shown(command)}: expected a Twist of finite speeds"
