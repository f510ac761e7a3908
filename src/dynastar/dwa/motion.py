"""How the robot moves: the motion model of Eq. 4 and the ramps of its two speeds."""

import math

from dynastar.compiled import njit


@njit(cache=True, inline="always")
def slew(current, wanted, accel, brake, duration):
    """``robot.slew`` for kernels: one speed after ``duration`` seconds on its way to ``wanted``."""
    if current * wanted < 0.0:
        to_zero = abs(current) / brake
        if to_zero >= duration:
            return current - math.copysign(brake * duration, current)
        return math.copysign(min(abs(wanted), accel * (duration - to_zero)), wanted)
    rate = accel if abs(wanted) > abs(current) else brake
    return current + max(-rate * duration, min(rate * duration, wanted - current))


@njit(cache=True, inline="always")
def stopping_time(v, omega, limits):
    """``robot.stopping_time`` for kernels: seconds until both speeds have ramped to zero."""
    return max(abs(v) / limits.v_brake, abs(omega) / limits.omega_brake)


@njit(cache=True)
def moved(pose, length, angle):
    """Eq. 4 integrated exactly: the pose (x, y, cos, sin) after an arc of ``length`` m and ``angle`` rad.

    The chord is length sinc(angle / 2) long and points half the turn ahead.
    """
    x, y, cos, sin = pose
    half = 0.5 * angle
    half_cos, half_sin = math.cos(half), math.sin(half)
    chord = length * (half_sin / half if abs(half) > 1e-9 else 1.0)
    mid_cos, mid_sin = cos * half_cos - sin * half_sin, sin * half_cos + cos * half_sin
    return (
        x + chord * mid_cos,
        y + chord * mid_sin,
        mid_cos * half_cos - mid_sin * half_sin,
        mid_sin * half_cos + mid_cos * half_sin,
    )


@njit(cache=True)
def driven(pose, v, omega, wanted_v, wanted_omega, limits, duration):
    """Pose and speeds after ``duration`` seconds of ramping towards the wanted speeds.

    The arc is driven at the mean of the speeds before and after.
    """
    next_v = slew(v, wanted_v, limits.v_accel, limits.v_brake, duration)
    next_omega = slew(omega, wanted_omega, limits.omega_accel, limits.omega_brake, duration)
    after = moved(pose, 0.5 * (v + next_v) * duration, 0.5 * (omega + next_omega) * duration)
    return after, next_v, next_omega


@njit(cache=True)
def coast(pose, twist, commands, durations, limits):
    """State after commands that are already on their way: (x, y, theta, v, omega).

    ``pose`` is (x, y, theta) and ``twist`` (v, omega) now; ``commands`` (n, 2) are followed for
    ``durations`` (n,) seconds each.
    """
    x, y, theta = pose
    v, omega = twist
    at = (x, y, math.cos(theta), math.sin(theta))
    turned = 0.0
    for i in range(len(durations)):
        part = 0.25 * durations[i]
        for _ in range(4):
            before = omega
            at, v, omega = driven(at, v, omega, commands[i, 0], commands[i, 1], limits, part)
            turned += 0.5 * (before + omega) * part
    return at[0], at[1], theta + turned, v, omega
