"""A guard that is fed with messages: commands of another controller in, safe commands out."""

import math
from typing import Any, NamedTuple

from dynastar.dwa.dwa import REFUSALS
from dynastar.geometry import Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Guard, Guarded, NavigatorConfig
from dynastar.navigator.guard import LIDAR_TEST, TOO_SLOW
from dynastar.robot import Robot
from dynastar.ros.incoming import seconds, twist_of
from dynastar.ros.intake import Intake, lateness
from dynastar.ros.settings import GuardSettings, NodeSettings

PASSING = ("", "acceleration", "speed limit")  # reasons for which nothing is held back
LIMITING = (TOO_SLOW, LIDAR_TEST, *REFUSALS.values())


class GuardTick(NamedTuple):
    """Result of a tick: what the guard makes of the command, its state in a word, and why."""

    guarded: Guarded
    state: str
    reason: str


class GuardBridge(Intake):
    """A guard that brakes while commands, scans, odometry or pose are missing, late or wrong."""

    def __init__(
        self, settings: NodeSettings, robot: Robot, config: NavigatorConfig, own: GuardSettings
    ) -> None:
        super().__init__(settings, robot, config)
        self.own, self.guard = own, Guard(robot, config)
        self._command, self._commanded = Twist(0.0, 0.0), -math.inf

    @property
    def frame(self) -> str:
        """The frame of the poses."""
        odometry = self.settings.pose_source == "odom" and not self.own.use_map
        return self.odometry_frame if odometry else self.settings.global_frame

    def ask(self, message: Any, now: float) -> None:
        """Takes in a Twist or TwistStamped that came at ``now`` (s); a stamp of 0 says nothing."""
        self._command, self._commanded = twist_of(getattr(message, "twist", message)), now
        if hasattr(message, "header"):
            self._commanded = seconds(message.header.stamp) or now

    def _use_grid(self, grid: OccupancyGrid) -> None:
        self.guard.set_map(grid)

    def _drop_sensed(self) -> None:
        self.guard.forget_times()

    def request(self, **wanted: str) -> None:
        """Carries out ``restart`` or sets the ``fault``, each with its reason."""
        if "restart" in wanted:
            self._forget(wanted["restart"])
            self._drop_sensed()
            self._commanded = -math.inf
        self.fault = wanted.get("fault", self.fault)

    def tick(self, now: float) -> GuardTick:
        """The command to drive at ``now`` (s); braking, with the reason, where data are missing or late."""
        scans = self._take_new_scans()
        state, trouble = self._state(now)
        wrong = "no map has come yet" if self.own.use_map and self.grid is None else ""
        wrong = wrong or lateness("command", self._commanded, now, self.own.command_age)
        guarded = self.guard.filter(state, scans, None if wrong else self._command)
        reason = trouble or wrong or guarded.reason
        if wrong and not trouble:
            return GuardTick(guarded, "idle", reason)
        if not (trouble or all(map(math.isfinite, self._command))):
            return GuardTick(guarded, "refusing", reason)
        if reason in PASSING:
            return GuardTick(guarded, "passing", "; ".join(["the command", *self.guard.hints]))
        if reason in LIMITING:
            return GuardTick(guarded, "limiting", "; ".join([reason, *self.guard.hints]))
        return GuardTick(guarded, "sensor_lost", reason)
