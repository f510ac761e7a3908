"""How a robot gets on that is stuck although a path leads on: it drives a way over poses."""

import math
from collections.abc import Sequence
from itertools import takewhile, zip_longest
from typing import NamedTuple

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


class Waypoint(NamedTuple):
    """A pose (m, rad), and how the robot comes there: ahead (1), back (-1) or by a turn (0)."""

    x: float
    y: float
    heading: float
    ahead: float


class WayOut:
    """A way over poses to where the cost-to-go is lower, and how far the robot is on it.

    A move that takes longer than ``patience`` (s) ends it.
    """

    def __init__(self, limits: Limits, patience: float) -> None:
        self.limits, self.patience = limits, patience
        self.forget()

    def forget(self) -> None:
        """No way is looked for or driven."""
        self.is_wanted = False
        self.way: list[Waypoint] = []
        self._since = -math.inf

    def look(self, scene: Scene, window: DynamicWindow, pose: Pose2D, now: float) -> None:
        """Look for a way from where the robot rests; a disc round its axle gains nothing by turning."""
        if len(window.rules.body.vertices) == 0:
            return
        at, self._since = state_at(*pose, 0.0, 0.0), now
        for spare in SPARES:
            found = search_poses(scene, window.rules, at, GAIN, spare)
            self.way = joined([Waypoint(*row) for row in found.tolist()])
            if self.way:
                return

    def goes_on(self, pose: Pose2D, now: float) -> bool:
        """Whether the robot is on a way that has not ended."""
        while self.way and self._has_ended(pose):
            self.way, self._since = self.way[1:], now
        if not self.way:
            return False
        if now - self._since > self.patience or math.dist(pose[:2], self.way[0][:2]) > LOST:
            self.forget()
        return bool(self.way)

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
        move = self.way[0]
        if move.ahead == 0.0:
            angle = wrap_angle(move.heading - pose.theta)
            asked = turn_by(angle, TURNED, twist, self.limits, window.rules.period, in_vain)
        else:
            asked = self._arc(pose, move.ahead, scene.v_cap)
        return window.nearest(scene.around, stops, twist, asked)[0]

    def _has_ended(self, pose: Pose2D) -> bool:
        x, y, heading, ahead = self.way[0]
        if ahead == 0.0:
            return abs(wrap_angle(heading - pose.theta)) <= TURNED
        to_there, _ = _seen_from(pose, x, y)
        return ahead * to_there <= NEAR

    def _arc(self, pose: Pose2D, sign: float, v_cap: float) -> Twist:
        """The speeds that lead on an arc to a pose a little farther on, but not past a change of sign."""
        run = list(takewhile(lambda move: move.ahead == sign, self.way))
        ahead, left = _seen_from(pose, *run[min(AIM, len(run) - 1)][:2])
        curvature = 2.0 * left / max(ahead**2 + left**2, NEAR**2)
        limits, end = self.limits, math.dist(pose[:2], run[-1][:2])
        stops = math.sqrt(2.0 * GENTLE_BRAKING * limits.v_brake * end)
        v = max(min(SPEED * limits.v_max, v_cap, stops), limits.v_least)
        v = v if sign > 0.0 else -min(v, -limits.v_min)
        v /= max(1.0, abs(v * curvature) / limits.omega_max)
        return Twist(v, v * curvature)


def joined(way: Sequence[Waypoint]) -> list[Waypoint]:
    """A way with one turn in place of several, each by less than half a turn: the same way round."""
    kept, turns = [], 0
    for move, following in zip_longest(way, way[1:]):
        turns = turns + 1 if move.ahead == 0.0 else 0
        is_last = turns == 0 or following is None or following.ahead != 0.0
        if is_last or turns % (HEADINGS // 2 - 1) == 0:
            kept.append(move)
    return kept


def _seen_from(pose: Pose2D, x: float, y: float) -> tuple[float, float]:
    """A place as the robot sees it: metres ahead and to the left."""
    return compose(inverse(pose), Pose2D(x, y, 0.0))[:2]
