"""Faults of a drive, its odometry and the loop of commands, as messages for the status."""

import math

from dynastar.geometry import Pose2D, Twist, wrap_angle
from dynastar.navigator.latency_check import LatencyCheck
from dynastar.navigator.pose_history import PoseHistory
from dynastar.navigator.status import RobotState
from dynastar.robot import Limits

PATIENCE = 3.0  # s of commands that move nothing
MOVED, TURNED = 0.02, 0.03  # m and rad by which the robot has moved
ASKED, ASKED_TURN = 0.1, 0.2  # m and rad that commands have asked for in all
LATE = 1.5  # of the declared period
FASTER, FARTHER = 1.3, 0.2  # times the way by the odometry, and m, that poses may be farther


class DriveCheck:
    """Compares commands, one every ``period`` (s), with what the robot's poses and twists show."""

    def __init__(self, limits: Limits, period: float, latency: float) -> None:
        self._period, self._latency = period, latency  # as declared
        self._acting = LatencyCheck(limits, latency)
        self._at = Pose2D(math.inf, math.inf)  # where the robot was when it moved last
        self._since = self._now = math.nan
        self._asked = self._asked_turn = 0.0  # m and rad since then

    def note(self, state: RobotState, command: Twist) -> None:
        """Record a command given in a state."""
        self._acting.note(state, command)
        moved = math.dist(state.pose[:2], self._at[:2]) > MOVED
        if moved or abs(wrap_angle(state.pose.theta - self._at.theta)) > TURNED:
            self._at, self._since = state.pose, state.stamp
            self._asked = self._asked_turn = 0.0
        self._now = state.stamp
        self._asked += command.v * self._period
        self._asked_turn += command.omega * self._period

    @property
    def turned_in_vain(self) -> float:
        """The angle (rad) that commands have asked for since the robot moved last."""
        return abs(self._asked_turn)

    def hints(self, poses: PoseHistory) -> list[str]:
        """What has been odd for some seconds."""
        found, declared = [], self._period
        if poses.period > LATE * declared:
            found.append(f"commands come {poses.period:.2f} s apart, not {declared:.2f} s")
        if self._acting.longer is not None:
            found.append(
                f"commands act after about {self._acting.longer:.2f} s, not {self._latency:.2f} s: "
                "declare latency"
            )
        asked = abs(self._asked) > ASKED or abs(self._asked_turn) > ASKED_TURN
        if asked and self._now - self._since > PATIENCE:
            found.append(
                f"commands have moved nothing for {self._now - self._since:.0f} s: is the drive "
                "switched off, or slower than limits.v_least and omega_least say?"
            )
        away, driven, lasted = poses.travelled()
        if away > FASTER * driven + FARTHER:
            found.append(
                f"the poses moved {away:.2f} m in {lasted:.0f} s, but the odometry's speeds only "
                f"{driven:.2f} m"
            )
        return found
