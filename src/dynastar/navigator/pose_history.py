"""The poses of the last seconds: scans are placed by them, and faults of the pose are found."""

import math
from collections import deque
from collections.abc import Sequence
from itertools import pairwise

from dynastar.geometry import Pose2D, interpolate, wrap_angle
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.status import RobotState, is_finite
from dynastar.robot import Limits, arc

AT_REST = 0.01  # m/s and rad/s up to which the robot is at rest
FARTHEST = 1e6  # m from the map's origin, where positions still tell cells apart
KEPT_FOR = 2.0  # s, no less than any scan_age
OTHER_CLOCK = 1.0  # s of rising stamps after time went back, from which on that is a clock anew
FASTER = 1.2  # times the highest speed, up to which a pose has not jumped
JUMP = 0.05  # m
LONGEST_CARRIED = 0.5  # s for which a pose is carried on at its twist
ON_TIME = 1.1  # of the declared period, up to which commands are not late
LONGEST_PERIOD = 1.0  # s
TURN_JUMP = 0.1  # rad


class PoseHistory:
    """The robot's states of the last two seconds, newest last."""

    def __init__(self, limits: Limits, config: NavigatorConfig) -> None:
        self._limits, self._config = limits, config
        self._states: deque[RobotState] = deque()
        self._was_there = False  # before the oldest state that is kept
        self._back: tuple[float, float] | None = None  # first and last stamp since time went back
        self._calls: deque[int] = deque()  # in which each of the states was given

    def fault(self, state: RobotState) -> str | None:
        """Describe why a state cannot be used, or None."""
        if not is_finite(state):
            return (
                "the robot's state is not finite: expected a stamp, a pose and a twist of numbers"
            )
        x, y, theta = state.pose
        if max(math.hypot(x, y) / math.sqrt(2.0), abs(theta)) > FARTHEST:  # at any yaw of the map
            return f"the robot's pose is ({x:g}, {y:g}, {theta:g}): expected within 1e6 m and rad"
        if self._states and state.stamp < self._states[-1].stamp:
            begun, last = self._back or (state.stamp, state.stamp)
            self._back = begun if last <= state.stamp else state.stamp, state.stamp
            return f"time went back by {self._states[-1].stamp - state.stamp:.6g} s"
        self._back = None
        if self._repeats(state.stamp):
            return f"the robot's state repeats: its stamp is still {state.stamp:.6g} s"
        return None

    def _repeats(self, stamp: float) -> bool:
        """Whether one stamp has been given for longer than ``scan_age``.

        A call takes as long as those of the states before took by their stamps, so that a loop may be
        faster than the odometry, and no longer than the declared period.
        """
        if not self._states or stamp > self._states[-1].stamp:
            return False
        self._calls[-1] += 1
        before, span = sum(self._calls) - self._calls[-1], stamp - self._states[0].stamp
        a_call = min(self._config.period, span / before if before else math.inf)
        return self._calls[-1] * a_call > self._config.scan_age

    @property
    def clock_is_another(self) -> bool:
        """Whether time went back, and has risen for a while since."""
        first, last = self._back or (0.0, 0.0)
        return last - first >= OTHER_CLOCK

    def add(self, state: RobotState) -> bool:
        """Keep a state; True if the pose jumped, which drops those before (the map was corrected)."""
        jumped = bool(self._states) and self._is_jump(self._states[-1], state)
        if not self._states:
            self._was_there = max(map(abs, state.twist)) <= AT_REST
        if jumped:
            self._states.clear()
            self._calls.clear()
            self._was_there = False
        elif self._states and self._states[-1].stamp == state.stamp:
            self._states.pop()
        self._states.append(state)
        if len(self._calls) < len(self._states):
            self._calls.append(1)
        while state.stamp - self._states[0].stamp > KEPT_FOR:
            self._states.popleft()
            self._calls.popleft()
            self._was_there = False
        return jumped

    @property
    def period(self) -> float:
        """The declared time between commands (s), or the longest of the last two seconds if longer."""
        stamps = [state.stamp for state in self._states]
        longest = max((b - a for a, b in pairwise(stamps)), default=0.0)
        declared = self._config.period
        return declared if longest <= ON_TIME * declared else min(longest, LONGEST_PERIOD)

    def travelled(self) -> tuple[float, float, float]:
        """How far apart first and last pose are (m), the way by the twists (m), and the time (s)."""
        if not self._states:
            return 0.0, 0.0, 0.0
        first, last = self._states[0], self._states[-1]
        driven = sum(
            0.5 * abs(before.twist.v + after.twist.v) * (after.stamp - before.stamp)
            for before, after in pairwise(self._states)
        )
        away = math.hypot(last.pose.x - first.pose.x, last.pose.y - first.pose.y)
        return away, driven, last.stamp - first.stamp

    def pose_at(self, stamp: float) -> Pose2D | None:
        """The pose at a time (s), as ``pose_at`` has it; None if it is not known.

        Before the first state it was the same if the robot was at rest then. Before a jump it is not known.
        """
        first = self._states[0]
        if stamp < first.stamp:
            return first.pose if self._was_there else None
        return pose_at(self._states, stamp)

    def _is_jump(self, last: RobotState, state: RobotState) -> bool:
        """Whether the pose moved further than the robot can have."""
        limits, config, dt = self._limits, self._config, state.stamp - last.stamp
        moved = math.hypot(state.pose.x - last.pose.x, state.pose.y - last.pose.y)
        turned = abs(wrap_angle(state.pose.theta - last.pose.theta))
        fastest = max(limits.v_max, -limits.v_min)
        return (
            moved > FASTER * fastest * dt + 4.0 * config.pose_error + JUMP
            or turned > FASTER * limits.omega_max * dt + 4.0 * config.heading_error + TURN_JUMP
        )


def pose_at(states: Sequence[RobotState], stamp: float) -> Pose2D:
    """The pose at a time (s): interpolated between two states, carried on at the twist of the last.

    Before the first state it is that of the first.
    """
    after = states[-1]
    if stamp > after.stamp:
        return arc(after.pose, after.twist, min(stamp - after.stamp, LONGEST_CARRIED))
    for before in reversed(states):
        if before.stamp <= stamp:
            span = after.stamp - before.stamp
            fraction = (stamp - before.stamp) / span if span > 0.0 else 0.0
            return interpolate(before.pose, after.pose, fraction)
        after = before
    return after.pose
