"""The commands given, and the stop that is carried on when nothing better is admissible."""

import math
from typing import NamedTuple

import numpy as np

from dynastar.dwa.dwa import StopStart
from dynastar.dwa.motion import coast, state_at
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator.drive_check import DriveCheck
from dynastar.navigator.status import RobotState, is_finite
from dynastar.robot import Limits, slew, stopping_time

REST = Twist(0.0, 0.0)
ROUNDING = 1e-9  # m/s and rad/s
LATENCY_STEP = 0.1  # s between the latencies for which a stop is certified, at most
V_TOLERANCE = 0.08  # of v_max that the measured speed may be off the commanded one
OMEGA_TOLERANCE = 0.1  # of omega_max, the same for the turning rate


class Acting(NamedTuple):
    """Pose and twist at the time from which a command acts."""

    pose: Pose2D
    twist: Twist


class Sent(NamedTuple):
    """A command and the stamp (s) of the state it was given in."""

    stamp: float
    twist: Twist


class StopProfile:
    """Both speeds ramp to zero in proportion from ``twist``, so the robot stays on the arc it is on.

    A drive goes to what it is told at its own limit and then holds, so telling it each period's
    end value would slow the gentler of the two too early and bend the arc. Each command is chosen
    so that the period's mean speed is that of the ramp.
    """

    def __init__(self, twist: Twist, limits: Limits) -> None:
        self.twist, self.limits = twist, limits
        self.duration = stopping_time(twist, limits)
        self.elapsed: float | None = None  # s, None before it begins

    def next(self, current: Twist, passed: float, period: float) -> Twist:
        """The command for the coming period, from the speeds of the moment, ``passed`` s after the last."""
        self.elapsed = 0.0 if self.elapsed is None else self.elapsed + passed
        is_last = self.elapsed + period >= self.duration
        left = 0.0 if is_last else 1.0 - (self.elapsed + 0.5 * period) / self.duration
        return Twist(
            _command_for_mean(current.v, self.twist.v * left, self.limits.v_brake, period),
            _command_for_mean(
                current.omega, self.twist.omega * left, self.limits.omega_brake, period
            ),
        )


def _command_for_mean(current: float, mean: float, brake: float, period: float) -> float:
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
        self._drive_error = drive_error
        self._declared = period
        self.check = DriveCheck(limits, period, latency)
        self._sent: list[Sent] = []
        self._last, self._noted_at = REST, math.nan  # and the stamp (s) of its state
        self._stop = StopProfile(REST, limits)

    def when_one_acts(self, state: RobotState, latency: float | None = None) -> Acting:
        """Pose and twist at the time from which a command given now acts.

        That is after the declared ``latency`` (s), or another one. Until the oldest command that is known
        acts, the robot goes on as it does.
        """
        latency = self.latency if latency is None else latency
        if latency <= 0.0:
            return Acting(state.pose, state.twist)
        ends = [stamp + latency for stamp, _ in self._sent] + [state.stamp + latency]
        commands, durations = [], []
        for (stamp, twist), end in zip(
            [Sent(-math.inf, state.twist), *self._sent], ends, strict=True
        ):
            span = end - max(stamp + latency, state.stamp)
            if span > 1e-9:
                commands.append(twist)
                durations.append(span)
        if not durations:
            return Acting(state.pose, state.twist)
        return self._driven(state, commands, durations)

    def _driven(self, state: RobotState, commands: list[Twist], durations: list[float]) -> Acting:
        """Pose and twist after each of the commands has acted for its duration (s)."""
        now = state_at(*state.pose, *state.twist)
        after, turned = coast(now, np.array(commands), np.array(durations), self.limits)
        pose = Pose2D(after.pose.x, after.pose.y, state.pose.theta + turned)
        return Acting(pose, Twist(after.v, after.omega))

    def carried_on(self, measured: Twist) -> Twist:
        """The twist from which the next command goes on: the last command, near the measured twist.

        A drive or odometry that is a few per cent off would else eat what a command may change in a
        period. What cannot be told from such an error is bounded: a fraction of the highest speed, and
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
        ``twist``, that from which the command goes on, and the measured one if it is another.
        """
        steps, found = math.ceil(self.latency / LATENCY_STEP - 1e-9), []
        fast = state._replace(twist=self._fast(state.twist))
        for k in range(steps + 1):
            latency = self.latency * k / max(steps, 1)
            expected = acting if k == steps else self.when_one_acts(state, latency)
            alone = self._sent[:: max(len(self._sent) - 1, 1)] if latency > 0.0 else []
            ways = [self._driven(fast, [self._fast(command)], [latency]) for _, command in alone]
            for pose, (v, omega) in [*ways, expected]:
                hold = self.period + self.latency - latency
                greater = Twist(max(v, twist.v, key=abs), max(omega, twist.omega, key=abs))
                if self._as_told(Twist(v, omega), greater) != greater:
                    found.append(StopStart(pose, Twist(v, omega), hold))
                found.append(StopStart(pose, greater, hold))
        return found

    def _as_told(self, measured: Twist, told: Twist) -> Twist:
        """Each speed as told if the drive's error explains the measured one, else as measured."""
        error = self._drive_error
        v = told.v if abs(measured.v - told.v) <= error * abs(told.v) + ROUNDING else measured.v
        near = abs(measured.omega - told.omega) <= error * abs(told.omega) + ROUNDING
        return Twist(v, told.omega if near else measured.omega)

    def _fast(self, twist: Twist) -> Twist:
        """A twist of a drive that is faster than told by its largest error."""
        faster = 1.0 + self._drive_error
        return Twist(faster * twist.v, faster * twist.omega)

    def send(self, state: RobotState, command: Twist | None) -> Twist:
        """Record a command that has a certified stop; None continues the last one's stop."""
        if command is None:
            return self.brake(state)
        limits, now = self.limits, self._as_told(self.when_one_acts(state).twist, self._last)
        v = slew(now.v, command.v, limits.v_accel, limits.v_brake, self.period)
        omega = slew(now.omega, command.omega, limits.omega_accel, limits.omega_brake, self.period)
        self._stop = StopProfile(Twist(v, omega), limits)  # a drive may not follow at once
        self._note(state, command)
        return command

    def continue_from(self, other: "Commands") -> None:
        """Go on from the commands of ``other``, which drove the same robot."""
        self._sent, self._noted_at = list(other._sent), other._noted_at
        self._last, self._stop = other._last, other._stop

    def forget_times(self) -> None:
        """Drop the stamps of commands, since the clock is another one. The stop is still continued."""
        self._sent, self._noted_at = [], math.nan
        self.check = DriveCheck(self.limits, self._declared, self.latency)

    def brake(self, state: RobotState) -> Twist:
        """Continue the last certified stop, from no more than was commanded last.

        So it ends though the state is frozen or not finite, or the odometry reads high.
        """
        twist = self._last
        if is_finite(state):
            v, omega = self._as_told(self.when_one_acts(state).twist, self._last)
            twist = Twist(_lesser(v, self._last.v), _lesser(omega, self._last.omega))
        passed = state.stamp - self._noted_at
        passed = passed if 0.0 < passed < math.inf else self.period
        command = self._stop.next(twist, passed, self.period)
        self._note(state, command)
        return command

    def _note(self, state: RobotState, command: Twist) -> None:
        self._last, now = command, state.stamp
        if not math.isfinite(now):
            return
        self._noted_at = now
        if is_finite(state):
            self.check.note(state, command)
        if self._sent and self._sent[-1].stamp == now:
            self._sent.pop()
        self._sent.append(Sent(now, command))
        while len(self._sent) > 1 and self._sent[1].stamp + self.latency <= now:
            self._sent.pop(0)
