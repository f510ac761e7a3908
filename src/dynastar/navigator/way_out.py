"""How a robot gets on that is stuck although a path leads on: it drives a way over poses."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.dwa.dwa import DynamicWindow, Stops
from dynastar.dwa.motion import state_at
from dynastar.dwa.pose_search import HEADINGS, search_poses
from dynastar.dwa.scene import Scene
from dynastar.geometry import Pose2D, Twist, wrap_angle
from dynastar.navigator.arrival import GENTLE_BRAKING
from dynastar.navigator.last_turn import turn_by
from dynastar.robot import Limits, slew

GAIN = 1.0  # m of progress to look for: with it the rounds of recovery start over
SPARES = 0.04, 0.0  # m beyond the margin, looked for in turn: the robot does not drive exactly
AIM = 2  # moves ahead of the next one that the robot steers for
SPEED = 0.5  # of the highest
PARTS = 1.0, 0.5, 0.2  # of the speeds that are asked for, which are tried in turn
NEAR, LOST = 0.03, 0.5  # m from the end of a move: it has ended, the robot is elsewhere
SAME = 1e-3  # m
TURNED = 0.05  # rad by which a turn may fall short


class WayOut:
    """A way over poses to where the cost-to-go is lower, and how far the robot is on it.

    The rows of ``way`` (n, 4) are those of ``search_poses``. A move that takes longer than ``patience``
    (s) ends it.
    """

    def __init__(self, limits: Limits, patience: float) -> None:
        self.limits, self.patience = limits, patience
        self.forget()

    def forget(self) -> None:
        """No way is looked for or driven."""
        self.is_wanted = False
        self.way: npt.NDArray[np.float64] = np.empty((0, 4))
        self._since = -math.inf

    def look(self, scene: Scene, window: DynamicWindow, pose: Pose2D, now: float) -> None:
        """Look for a way from where the robot rests; there is no use in turning a disc round its axle."""
        body = window.rules.body
        if body.circumscribed - body.inscribed < SAME:
            return
        at, self._since = state_at(*pose, 0.0, 0.0), now
        for spare in SPARES:
            self.way = _joined(search_poses(scene, window.rules, at, GAIN, spare))
            if len(self.way) > 0:
                return

    def goes_on(self, pose: Pose2D, now: float) -> bool:
        """Whether the robot is on a way that has not ended."""
        while len(self.way) > 0 and self._has_ended(pose):
            self.way, self._since = self.way[1:], now
        if len(self.way) == 0:
            return False
        if now - self._since > self.patience or math.dist(pose[:2], self.way[0, :2]) > LOST:
            self.forget()
        return len(self.way) > 0

    def command(
        self, scene: Scene, window: DynamicWindow, pose: Pose2D, twist: Twist, stops: Stops
    ) -> Twist | None:
        """The fastest admissible command of some along the way; None if only a stop is left."""
        *_, theta, kind = self.way[0]
        if kind == 0.0:
            angle = wrap_angle(theta - pose.theta)
            v, omega = turn_by(angle, TURNED, twist, self.limits, window.rules.period)
        else:
            v, omega = self._arc(pose, kind, scene.v_cap)
        for part in PARTS:
            command = self._towards(twist, Twist(part * v, part * omega), window.rules.period)
            if window.admits(scene.around, stops, command):
                return command
        return None

    def _towards(self, twist: Twist, wanted: Twist, period: float) -> Twist:
        """The command of one period on the way to the wanted speeds; none that the drive cannot follow."""
        limits = self.limits
        v = slew(twist.v, wanted.v, limits.v_accel, limits.v_brake, period)
        omega = slew(twist.omega, wanted.omega, limits.omega_accel, limits.omega_brake, period)
        return Twist(
            _driveable(v, wanted.v, limits.v_least),
            _driveable(omega, wanted.omega, limits.omega_least),
        )

    def _has_ended(self, pose: Pose2D) -> bool:
        x, y, theta, kind = self.way[0]
        if kind == 0.0:
            return abs(wrap_angle(theta - pose.theta)) <= TURNED
        return kind * _seen_from(pose, x, y)[0] <= NEAR

    def _arc(self, pose: Pose2D, kind: float, v_cap: float) -> Twist:
        """The speeds that lead on an arc to a pose a little farther on, but not past a change of kind."""
        others = np.flatnonzero(self.way[:, 3] != kind)
        run = self.way[: others[0]] if len(others) > 0 else self.way
        ahead, left = _seen_from(pose, *run[min(AIM, len(run) - 1)][:2])
        curvature = 2.0 * left / max(ahead**2 + left**2, NEAR**2)
        limits, end = self.limits, math.dist(pose[:2], run[-1][:2])
        stops = math.sqrt(2.0 * GENTLE_BRAKING * limits.v_brake * end)
        v = max(min(SPEED * limits.v_max, v_cap, stops), limits.v_least)
        v = v if kind > 0.0 else -min(v, -limits.v_min)
        v /= max(1.0, abs(v * curvature) / limits.omega_max)
        return Twist(v, v * curvature)


def _joined(way: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """A way with one turn in place of several, each by less than half a turn: the same way round."""
    keep, turns = np.ones(len(way), bool), 0
    for k, kind in enumerate(way[:-1, 3]):
        turns = turns + 1 if kind == 0.0 else 0
        keep[k] = kind != 0.0 or way[k + 1, 3] != 0.0 or turns % (HEADINGS // 2 - 1) == 0
    return way[keep]


def _seen_from(pose: Pose2D, x: float, y: float) -> tuple[float, float]:
    """A place as the robot sees it: metres ahead and to the left."""
    dx, dy = x - pose.x, y - pose.y
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    return cos * dx + sin * dy, cos * dy - sin * dx


def _driveable(speed: float, wanted: float, least: float) -> float:
    """A speed that a drive follows on the way to a wanted one: 0, or of ``least`` magnitude."""
    if abs(speed) >= least:
        return speed
    return math.copysign(least, wanted) if abs(wanted) >= least else 0.0
