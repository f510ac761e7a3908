"""The dynamic window: which speeds can be reached (Eqs. 5 and 6), and its samples."""

from typing import NamedTuple

import numpy as np

from dynastar.compiled import allocating, inner
from dynastar.dwa.motion import slew


class Window(NamedTuple):
    """A rectangle of speeds: lowest and highest v (m/s) and omega (rad/s)."""

    low_v: float
    high_v: float
    low_omega: float
    high_omega: float


@inner
def possible(limits, v_cap):
    """Eq. 5: the speeds within the robot's limits; |v| is capped at ``v_cap`` (m/s)."""
    return Window(
        max(limits.v_min, -v_cap), max(v_cap, limits.v_min), -limits.omega_max, limits.omega_max
    )


@inner
def reachable(state, limits, possible, duration):
    """Eq. 6: the part of the ``possible`` speeds that is reached in ``duration`` seconds."""
    v, omega = state.v, state.omega
    slower = slew(v, possible.low_v, limits.v_accel, limits.v_brake, duration)
    faster = slew(v, possible.high_v, limits.v_accel, limits.v_brake, duration)
    right = slew(omega, possible.low_omega, limits.omega_accel, limits.omega_brake, duration)
    left = slew(omega, possible.high_omega, limits.omega_accel, limits.omega_brake, duration)
    return Window(min(slower, faster), max(slower, faster), min(right, left), max(right, left))


@allocating
def spaced(low, high, count):
    """About ``count`` values from low to high, both among them.

    They are denser round 0, so that slow and nearly straight motions can be told apart: away from
    zero they grow with the square. 0 is one of them where it lies between.
    """
    if high - low < 1e-9:
        return np.array([high])
    largest, half = max(abs(low), abs(high)), count // 2
    values = [low]
    for i in range(-half, half + 1):
        value = largest * i * abs(i) / (half * half)
        if low < value < high:
            values.append(value)
    values.append(high)
    return np.array(values)
