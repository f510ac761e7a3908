"""The commands given, and the stop that is carried on when nothing better is admissible."""

import math

import numpy as np

from dynastar.dwa.dwa import StopStart
from dynastar.dwa.motion import coast, state_at
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator.drive_check import DriveCheck
from dynastar.navigator.status import RobotState, is_finite
from dynastar.robot import Limits, slew, stopping_time

Acting = tuple[Pose2D, Twist]

REST = Twist(0.0, 0.0)
LATENCY_STEP = 0.1  # s between the latencies for which a stop is certified, at most
V_TOLERANCE = 0.08  # of v_max that the measured speed may be off the commanded one
OMEGA_TOLERANCE = 0.1  # of omega_max, the same for the turning rate


class StopProfile:
    """Both speeds ramp to zero in proportion from ``twist``, so the robot stays on the arc it is on.

    A drive goes to what it is told at its own limit and then holds, so telling it each period's
    end value would slow the gentler of the two too early and bend the arc. Each command is chosen
    so that the period's mean speed is that of the ramp.
    """

    def __init__(self, twist: Twist, limits: Limits) -> None:
        self.twist, self.limits = twist, limits
        self.duration = stopping_time(twist, limits)
        self.elapsed = 0.0

    def next(self, current: Twist, period: float) -> Twist:
        """The command for the coming period, from the speeds of the moment."""
        middle = self.elapsed + 0.5 * period
        self.elapsed += period
        left = 0.0 if self.elapsed >= self.duration else 1.0 - middle / self.duration
        return Twist(
            _lead(current.v, self.twist.v * left, self.limits.v_brake, period),
            _lead(current.omega, self.twist.omega * left, self.limits.omega_brake, period),
        )


def _lead(current: float, mean: float, brake: float, period: float) -> float:
    """The value to command for ``mean`` to be the period's mean, reached at ``brake`` and held.

    A drop D takes D / brake seconds, so the mean is current - D + D^2 / (2 brake period).
    """
    wanted = (abs(current) - abs(mean)) / (brake * period)
    drop = brake * period * (1.0 - math.sqrt(max(0.0, 1.0 - 2.0 * max(0.0, wanted))))
    if drop > abs(current) - 1e-9:
        return 0.0
    return slew(current, current - math.copysign(drop, current), brake, brake, period)


def _lesser(measured: float, commanded: float) -> float:
    """The speed of smaller magnitude, 0 where the two are of opposite sign."""
    if measured * commanded <= 0.0:
        return 0.0
    return min(measured, commanded, key=abs)


class Commands:
    """Commands under way: the motion until a new command acts, and the certified stop after it."""

    def __init__(
        self, limits: Limits, period: float, latency: float, drive_error: float = 0.0
    ) -> None:
        self.limits, self.period, self.latency = limits, period, latency
        self._faster = 1.0 + drive_error
        self._declared = period
        self.check = DriveCheck(limits, period, latency)
        self._sent: list[tuple[float, Twist]] = []
        self._last = REST
        self._stop = StopProfile(REST, limits)

    def when_one_acts(self, state: RobotState, latency: float | None = None) -> Acting:
        """Pose and twist at the time from which a command given now acts.

        That is after the declared ``latency`` (s), or another one.
        """
        latency = self.latency if latency is None else latency
        if latency <= 0.0 or not self._sent:
            return state.pose, state.twist
        ends = [stamp + latency for stamp, _ in self._sent[1:]] + [state.stamp + latency]
        commands, durations = [], []
        for (stamp, twist), end in zip(self._sent, ends, strict=True):
            span = end - max(stamp + latency, state.stamp)
            if span > 1e-9:
                commands.append(twist)
                durations.append(span)
        return self._driven(state, commands, durations) if durations else (state.pose, state.twist)

    def _driven(self, state: RobotState, commands: list[Twist], durations: list[float]) -> Acting:
        """Pose and twist after each of the commands has acted for its duration (s)."""
        now = state_at(*state.pose, *state.twist)
        after, turned = coast(now, np.array(commands), np.array(durations), self.limits)
        pose = Pose2D(after.pose.x, after.pose.y, state.pose.theta + turned)
        return pose, Twist(after.v, after.omega)

    def carried_on(self, measured: Twist) -> Twist:
        """The twist from which the next command goes on: the last command, near the measured twist.

        A drive or odometry that is a few per cent off would else eat what a command may change in a
        period. What cannot be told from such an error is bounded: a share of the highest speed, and
        what the robot brakes by in a period.
        """
        limits, period = self.limits, self.period
        off_v = V_TOLERANCE * limits.v_max + limits.v_brake * period
        off_omega = OMEGA_TOLERANCE * limits.omega_max + limits.omega_brake * period
        v = min(max(self._last.v, measured.v - off_v), measured.v + off_v)
        omega = min(max(self._last.omega, measured.omega - off_omega), measured.omega + off_omega)
        return Twist(v, omega)

    def stops_from(self, state: RobotState, acting: Acting, twist: Twist) -> list[StopStart]:
        """From where a stop has to be certified; the last is that of the declared latency.

        A command may act at once, or at the declared latency at the latest, one after the other; the
        times in between are LATENCY_STEP apart. Until then the robot follows the commands under way as
        expected, or the oldest or the newest of them alone, faster by the drive's error. The command after
        this one may act at the declared latency. The twist is the greater of the measured one and
        ``twist``, that from which the command goes on.
        """
        steps, found = math.ceil(self.latency / LATENCY_STEP - 1e-9), []
        fast = state._replace(twist=self._fast(state.twist))
        for k in range(steps + 1):
            latency = self.latency * k / max(steps, 1)
            expected = acting if k == steps else self.when_one_acts(state, latency)
            alone = self._sent[:: max(len(self._sent) - 1, 1)] if latency > 0.0 else []
            ways = [self._driven(fast, [self._fast(command)], [latency]) for _, command in alone]
            for pose, (v, omega) in [*ways, expected]:
                greater = Twist(max(v, twist.v, key=abs), max(omega, twist.omega, key=abs))
                found.append(StopStart(pose, greater, self.period + self.latency - latency))
        return found

    def _fast(self, twist: Twist) -> Twist:
        """A twist of a drive that is faster than told by its largest error."""
        return Twist(self._faster * twist.v, self._faster * twist.omega)

    def send(self, state: RobotState, command: Twist | None) -> Twist:
        """Record a command that has a certified stop; None continues the last one's stop."""
        if command is None:
            return self.brake(state)
        self._stop = StopProfile(command, self.limits)
        self._note(state, command)
        return command

    def forget_times(self) -> None:
        """Drop the stamps of commands, since the clock is another one. The stop is still continued."""
        self._sent = []
        self.check = DriveCheck(self.limits, self._declared, self.latency)

    def brake(self, state: RobotState) -> Twist:
        """Continue the last certified stop, from no more than was commanded last.

        So it ends though the state is frozen or not finite, or the odometry reads high.
        """
        twist = self._last
        if is_finite(state):
            v, omega = self.when_one_acts(state)[1]
            twist = Twist(_lesser(v, self._last.v), _lesser(omega, self._last.omega))
        command = self._stop.next(twist, self.period)
        self._note(state, command)
        return command

    def _note(self, state: RobotState, command: Twist) -> None:
        self._last, now = command, state.stamp
        if not math.isfinite(now):
            return
        if is_finite(state):
            self.check.note(state, command)
        if self._sent and self._sent[-1][0] == now:
            self._sent.pop()
        self._sent.append((now, command))
        while len(self._sent) > 1 and self._sent[1][0] + self.latency <= now:
            self._sent.pop(0)
