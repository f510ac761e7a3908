"""How the robot moves: the motion model of Eq. 4 and the ramps of its two speeds."""

import math
from typing import NamedTuple

import numpy as np

from dynastar.compiled import inner, njit

PART = 0.05  # s, of a motion whose speeds change


class Pose(NamedTuple):
    """A pose as kernels take it: position (m), cosine and sine of the heading."""

    x: float
    y: float
    cos: float
    sin: float


class State(NamedTuple):
    """A pose and the two speeds there (m/s, rad/s)."""

    pose: Pose
    v: float
    omega: float


# Where a stop begins: the state when a command begins to act, and for how long (s) it may act.
STOP_START = np.dtype([(name, np.float64) for name in (*Pose._fields, "v", "omega", "hold")])


@inner
def state_of(record):
    """The state of a STOP_START record."""
    return State(Pose(record.x, record.y, record.cos, record.sin), record.v, record.omega)


def state_at(x: float, y: float, theta: float, v: float, omega: float) -> State:
    """The state at a position (m) and heading (rad) with speeds (m/s, rad/s)."""
    return State(Pose(x, y, math.cos(theta), math.sin(theta)), v, omega)


@inner
def slew(current, wanted, accel, brake, duration):
    """``robot.slew`` for kernels: one speed after ``duration`` seconds on its way to ``wanted``."""
    if current * wanted < 0.0:
        to_zero = abs(current) / brake
        if to_zero >= duration:
            return current - math.copysign(brake * duration, current)
        return math.copysign(min(abs(wanted), accel * (duration - to_zero)), wanted)
    rate = accel if abs(wanted) > abs(current) else brake
    return current + max(-rate * duration, min(rate * duration, wanted - current))


@inner
def driveable(command, wanted, least):
    """A command towards a ``wanted`` speed that a drive follows: 0, or of ``least`` magnitude.

    It is never more than what is wanted.
    """
    if abs(command) >= least:
        return command
    return math.copysign(least, wanted) if abs(wanted) >= least else 0.0


@inner
def driveable_sample(speed, least, low, high):
    """The sample nearest to a speed that a drive follows: 0, or of ``least`` magnitude if possible."""
    if abs(speed) >= least or speed == 0.0:
        return speed
    raised = math.copysign(least, speed)
    return raised if abs(speed) >= 0.5 * least and low <= raised <= high else 0.0


@inner
def command_towards(rules, twist, wanted):
    """The command (v, omega) of one period on the way from a ``twist`` to the ``wanted`` speeds."""
    (v, omega), (now_v, now_omega) = wanted, twist
    limits, period = rules.limits, rules.period
    next_v = slew(now_v, v, limits.v_accel, limits.v_brake, period)
    next_omega = slew(now_omega, omega, limits.omega_accel, limits.omega_brake, period)
    return driveable(next_v, v, limits.v_least), driveable(next_omega, omega, limits.omega_least)


@inner
def stopping_time(v, omega, limits):
    """``robot.stopping_time`` for kernels: seconds until both speeds have ramped to zero."""
    return max(abs(v) / limits.v_brake, abs(omega) / limits.omega_brake)


@inner
def moved(pose, length, angle):
    """Eq. 4 integrated exactly: the pose after an arc of ``length`` m and ``angle`` rad.

    The chord is length sinc(angle / 2) long and points half the turn ahead.
    """
    half = 0.5 * angle
    half_cos, half_sin = math.cos(half), math.sin(half)
    chord = length * (half_sin / half if abs(half) > 1e-9 else 1.0)
    mid_cos = pose.cos * half_cos - pose.sin * half_sin
    mid_sin = pose.sin * half_cos + pose.cos * half_sin
    return Pose(
        pose.x + chord * mid_cos,
        pose.y + chord * mid_sin,
        mid_cos * half_cos - mid_sin * half_sin,
        mid_sin * half_cos + mid_cos * half_sin,
    )


@inner
def ramped(current, wanted, accel, brake, duration):
    """One speed after ``duration`` seconds on its way to ``wanted``, and the way until then."""
    after = slew(current, wanted, accel, brake, duration)
    if current * after < 0.0:
        to_zero = abs(current) / brake
        way = after * (duration - to_zero) - 0.5 * after * abs(after) / accel
        return after, 0.5 * current * to_zero + way
    change, rate = current - after, accel if abs(after) > abs(current) else brake
    return after, after * duration + 0.5 * change * abs(change) / rate


@inner
def ramped_both(state, wanted_v, wanted_omega, limits, duration):
    """Both speeds after ``duration`` s, and the arc driven meanwhile: length (m) and angle (rad)."""
    v, length = ramped(state.v, wanted_v, limits.v_accel, limits.v_brake, duration)
    omega, angle = ramped(
        state.omega, wanted_omega, limits.omega_accel, limits.omega_brake, duration
    )
    return (v, omega), (length, angle)


@inner
def driven(state, wanted_v, wanted_omega, limits, duration):
    """The state after ``duration`` seconds of ramping towards the wanted speeds, along one arc."""
    (v, omega), (length, angle) = ramped_both(state, wanted_v, wanted_omega, limits, duration)
    return State(moved(state.pose, length, angle), v, omega)


@inner
def parts_of(duration):
    """In how many parts a motion of ``duration`` s is followed, so that each is nearly an arc."""
    return int(math.ceil(duration / PART - 1e-9))


@njit(cache=True)
def coast(state, commands, durations, limits):
    """The state after commands that are already on their way, and the angle turned until then (rad).

    ``commands`` (n, 2) are followed for ``durations`` (n,) seconds each.
    """
    turned = 0.0
    for i in range(len(durations)):
        parts = max(4, parts_of(durations[i]))
        part, (v, omega) = durations[i] / parts, (commands[i, 0], commands[i, 1])
        for _ in range(parts):
            turned += ramped_both(state, v, omega, limits, part)[1][1]
            state = driven(state, v, omega, limits, part)
    return state, turned
