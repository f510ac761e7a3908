"""How a robot gets on that is stuck although a path leads on: it drives a way over poses."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.dwa.dwa import DynamicWindow, Stops
from dynastar.dwa.motion import state_at
from dynastar.dwa.pose_search import HEADINGS, search_poses
from dynastar.dwa.scene import Scene
from dynastar.geometry import Pose2D, Twist, compose, inverse, wrap_angle
from dynastar.navigator.arrival import GENTLE_BRAKING
from dynastar.navigator.last_turn import turn_by
from dynastar.robot import Limits

GAIN = 1.0  # m of progress to look for: with it the rounds of recovery start over
SPARES = 0.04, 0.0  # m beyond the margin, looked for in turn: the robot does not drive exactly
AIM = 2  # moves ahead of the next one that the robot steers for
SPEED = 0.5  # of the highest
NEAR, LOST = 0.03, 0.5  # m from the end of a move: it has ended, the robot is elsewhere
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
        """Look for a way from where the robot rests; a disc round its axle gains nothing by turning."""
        if len(window.rules.body.vertices) == 0:
            return
        at, self._since = state_at(*pose, 0.0, 0.0), now
        for spare in SPARES:
            self.way = joined(search_poses(scene, window.rules, at, GAIN, spare))
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
        self,
        scene: Scene,
        window: DynamicWindow,
        pose: Pose2D,
        twist: Twist,
        stops: Stops,
        in_vain: float,
    ) -> Twist | None:
        """The admissible command nearest to one along the way; None if only a stop is left.

        ``in_vain`` as in ``turn_by``.
        """
        *_, theta, kind = self.way[0]
        if kind == 0.0:
            angle = wrap_angle(theta - pose.theta)
            asked = turn_by(angle, TURNED, twist, self.limits, window.rules.period, in_vain)
        else:
            asked = self._arc(pose, kind, scene.v_cap)
        return window.nearest(scene.around, stops, twist, asked)[0]

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


def joined(way: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """A way with one turn in place of several, each by less than half a turn: the same way round."""
    keep, turns = np.ones(len(way), bool), 0
    for k, kind in enumerate(way[:-1, 3]):
        turns = turns + 1 if kind == 0.0 else 0
        keep[k] = kind != 0.0 or way[k + 1, 3] != 0.0 or turns % (HEADINGS // 2 - 1) == 0
    return way[keep]


def _seen_from(pose: Pose2D, x: float, y: float) -> tuple[float, float]:
    """A place as the robot sees it: metres ahead and to the left."""
    return compose(inverse(pose), Pose2D(x, y, 0.0))[:2]
