"""The simulated drive: how its speeds follow the commands (Eq. 4)."""

import math
from collections import deque

import numpy as np

from dynastar.geometry import Twist
from dynastar.robot import Limits, slew
from dynastar.simulation.imperfections import Drivetrain

REST = 1e-4  # m/s and rad/s under which the robot stands
AT_REST = Twist(0.0, 0.0)


class DriveSimulator:
    """Ramps both speeds, each on its own, towards the command that acts.

    A command acts ``latency + late`` (s) after it was given, or sooner by ``latency_jitter``; one that
    acts sooner than an earlier one replaces it. ``wheels`` is the twist of the wheels, ``twist`` that
    over ground. The limits hold for commands and for ramps, so a gain above 1 exceeds the top speed.
    """

    def __init__(
        self, limits: Limits, drivetrain: Drivetrain, latency: float, random: np.random.Generator
    ) -> None:
        self.limits, self.late = limits, 0.0
        self._drivetrain, self._latency, self._random = drivetrain, latency, random
        self._pending: deque[tuple[float, Twist]] = deque()
        self._wanted = self.wheels = self.twist = AT_REST
        self._grip = Twist(1.0, 1.0)

    @property
    def resting(self) -> bool:
        """Whether the robot stands and no command that it was given will move it."""
        told = (self.wheels, self._wanted, *(command for _, command in self._pending))
        return all(abs(speed) < REST for twist in told for speed in twist)

    def take(self, command: Twist, now: float) -> None:
        """Takes a command at a time (s)."""
        made = self._drivetrain
        acts = now + self._latency + self.late
        if made.latency_jitter > 0.0:
            acts = max(now, acts - self._random.uniform(0.0, made.latency_jitter))
        while self._pending and self._pending[-1][0] >= acts:
            self._pending.pop()
        self._pending.append((acts, self._followed(command)))
        if made.slip > 0.0:
            self._grip = Twist(*(1.0 - self._random.uniform(0.0, made.slip, 2)))

    def act(self, now: float) -> float:
        """Lets all commands act that are due; returns when the next one is (s)."""
        while self._pending and self._pending[0][0] <= now:
            self._wanted = self._pending.popleft()[1]
        return self._pending[0][0] if self._pending else math.inf

    def advance(self, duration: float) -> Twist:
        """Lets ``duration`` seconds pass; returns the mean twist over ground."""
        limits, before, aim = self.limits, self.wheels, self._wanted
        if self._drivetrain.lag > 0.0:
            left = math.exp(-duration / self._drivetrain.lag)
            aim = Twist(*(w + left * (b - w) for b, w in zip(before, aim, strict=True)))
        self.wheels = Twist(
            slew(before.v, aim.v, limits.v_accel, limits.v_brake, duration),
            slew(before.omega, aim.omega, limits.omega_accel, limits.omega_brake, duration),
        )
        grip = self._grip
        self.twist = Twist(self.wheels.v * grip.v, self.wheels.omega * grip.omega)
        return Twist(
            0.5 * (before.v + self.wheels.v) * grip.v,
            0.5 * (before.omega + self.wheels.omega) * grip.omega,
        )

    def _followed(self, command: Twist) -> Twist:
        """The speeds that the drive makes of a command."""
        limits, made = self.limits, self._drivetrain
        v = min(max(command.v, limits.v_min), limits.v_max)
        omega = min(max(command.omega, -limits.omega_max), limits.omega_max)
        return Twist(
            made.gain_v * v if abs(v) >= made.deadband_v else 0.0,
            made.gain_omega * omega if abs(omega) >= made.deadband_omega else 0.0,
        )
