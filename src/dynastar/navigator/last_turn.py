"""The turn to the goal's heading: which way round, from which place, and how fast."""

import math

import numpy as np

from dynastar.dwa.dwa import Rules
from dynastar.dwa.motion import state_at
from dynastar.dwa.scene import Scene
from dynastar.dwa.turning import KEPT_WITHIN, has_room_to_turn, place_to_turn
from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.guidance import PathTarget
from dynastar.navigator.arrival import GENTLE_BRAKING
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.mission import Mission
from dynastar.navigator.progress import Progress
from dynastar.path import Path
from dynastar.robot import Limits, slew

LOOK_PERIOD = 3.0  # s between two searches for a place to turn
SPARES = 0.1, 0.05, 0.02, 0.0  # m beyond the margin: a place with as much room as there is
ENOUGH = 0.25  # of the room at the place, with which the turn begins: the robot is not quite there
STEADY = 0.25  # of a period's inverse, the largest turning rate over the angle left
IN_VAIN = 0.5  # 1/s, a turning rate over the angle that was asked for and not turned
NO_ROOM = "no room to turn to the goal's heading"


class LastTurn:
    """How the robot comes to the goal's heading.

    It turns on the spot, the shorter way round that has room. Without room there it drives to a
    ``place`` (x, y) within the goal's tolerance that has.
    """

    def __init__(self, config: NavigatorConfig) -> None:
        self.config = config
        self.progress = Progress(config.stuck_time)
        self.reset()

    def reset(self) -> None:
        """Another goal."""
        self.place: tuple[float, float] | None = None
        self._looked_at = -math.inf
        self._long_way = 0.0  # 1 to the left, -1 to the right, 0 while the short way is turned
        self._spare = ENOUGH * SPARES[0]
        self.progress.reset()

    @property
    def short_by(self) -> float:
        """The angle (rad) by which a turn may fall short."""
        return KEPT_WITHIN * self.config.heading_tolerance

    def target(self, pose: Pose2D) -> PathTarget | None:
        """The way to the place from which the robot can turn; None while none is looked for."""
        if self.place is None:
            return None
        return PathTarget(Path(np.array([pose[:2], self.place])), 0.0)

    def angle(self, scene: Scene, rules: Rules, pose: Pose2D, heading: float) -> float | None:
        """The angle to turn by (rad, left positive), or None if neither way round has room."""
        short = wrap_angle(heading - pose.theta)
        long = short - math.copysign(math.tau, short)
        ways = [long, short] if long * self._long_way > 0.0 else [short, long]
        at = state_at(*pose, 0.0, 0.0).pose
        for way in ways:
            if has_room_to_turn(scene, rules, at, at, way, (self._spare, self.short_by)):
                self._long_way = math.copysign(1.0, long) if way == long else 0.0
                self._spare = 0.0
                return way
        return None

    def finds_place(self, scene: Scene, rules: Rules, pose: Pose2D, goal: Goal, now: float) -> bool:
        """Whether there is a place with room: the nearest to the goal. Looks every LOOK_PERIOD."""
        if now - self._looked_at < LOOK_PERIOD:
            return self.place is not None
        self._looked_at = now
        at, reach = state_at(*pose, 0.0, 0.0).pose, self.config.goal_tolerance
        for spare in SPARES:
            need = spare, self.short_by
            found, x, y = place_to_turn(scene, rules, at, tuple(goal), reach, need)
            self.place, self._spare = ((x, y) if found else None), ENOUGH * spare
            if found:
                break
        return self.place is not None

    def judge(self, mission: Mission, now: float, angle: float | None) -> None:
        """Say that the robot turns by an ``angle``, or has no room to; give up after a long time."""
        mission.say("turning", NO_ROOM if angle is None else "to the goal's heading")
        left = math.tau if angle is None else abs(angle)
        stuck = self.progress.stuck(now, (left, 0.0), lambda left, _: left)
        if stuck and self.progress.rounds > self.config.attempts:
            why = f", {NO_ROOM}" if angle is None else ""
            mission.block(f"gave up: the goal's heading cannot be reached{why}")


def turn_by(
    angle: float, short_by: float, twist: Twist, limits: Limits, period: float, in_vain: float = 0.0
) -> Twist:
    """The command that turns on the spot by an angle (rad), slow enough to stop there.

    The rate falls in proportion to the angle that is left: a delay of a period or two that is not
    declared, or a drive that turns too fast, does not make the robot swing. It grows with the angle that
    was asked for ``in_vain`` (rad), as a drive may have a dead band. One that cannot turn so slowly, as
    declared, stops where that ends within ``short_by`` (rad), or nearer than after one more period.
    """
    rate = math.sqrt(2.0 * GENTLE_BRAKING * limits.omega_brake * abs(angle))
    steady = max(abs(angle) * STEADY / period, IN_VAIN * in_vain)
    rate = math.copysign(min(limits.omega_max, rate, steady), angle)
    omega = slew(twist.omega, rate, limits.omega_accel, limits.omega_brake, period)
    if abs(omega) < limits.omega_least:
        omega, now = math.copysign(limits.omega_least, angle), twist.omega
        after = slew(now, omega, limits.omega_accel, limits.omega_brake, period)
        turned = 0.5 * (now + after) * period + _stop(after, limits)
        if abs(angle - _stop(now, limits)) <= max(short_by, abs(angle - turned)):
            omega = 0.0
    return Twist(slew(twist.v, 0.0, limits.v_accel, limits.v_brake, period), omega)


def _stop(omega: float, limits: Limits) -> float:
    """The angle (rad) that a stop turns by."""
    return 0.5 * omega * abs(omega) / limits.omega_brake
