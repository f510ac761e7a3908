"""The stop that is carried on when nothing better is admissible."""

import math

from dynastar.geometry import Twist
from dynastar.robot import Limits, slew, stopping_time


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
        if self.elapsed >= self.duration:
            return Twist(
                _lead(current.v, 0.0, self.limits.v_brake, period),
                _lead(current.omega, 0.0, self.limits.omega_brake, period),
            )
        left = 1.0 - middle / self.duration
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
