"""The certified stop: whether the robot, once it has a command, can come to rest without a touch."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.clearance_kernels import footprint_clearance

ADMISSIBLE, NO_STOP, CONTACT, MOVER, RUN_OVER = 0, 1, 2, 3, 4
TICK = 0.15  # s between the looks at where movers are
WAYS = (1.0, 0.0, -1.0)  # a mover keeps its velocity, stands, or turns back


@njit(cache=True, inline="always")
def slew(current, wanted, accel, brake, duration):
    """``robot.slew`` for kernels."""
    if current * wanted < 0.0:
        to_zero = abs(current) / brake
        if to_zero >= duration:
            return current - math.copysign(brake * duration, current)
        return math.copysign(min(abs(wanted), accel * (duration - to_zero)), wanted)
    rate = accel if abs(wanted) > abs(current) else brake
    return current + max(-rate * duration, min(rate * duration, wanted - current))


@njit(cache=True, inline="always")
def arc(x, y, theta, length, angle):
    """``robot.arc`` for kernels: the pose after ``length`` metres and ``angle`` radians of an arc."""
    half = 0.5 * angle
    chord = length * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    return x + chord * math.cos(theta + half), y + chord * math.sin(theta + half), theta + angle


@njit(cache=True)
def arc_is_clear(around, body, margin, allowed, x, y, theta, length, angle):
    """Whether the footprint, grown by ``margin``, sweeps only open space along an arc.

    Conservative advancement: no point of the footprint moves further than |length| + R |angle|,
    so a pose that has clearance to spare vouches for the stretch after it. A footprint that is
    nearer than the margin to begin with (``allowed`` < margin) may not come nearer.
    """
    sweep = abs(length) + body.circumscribed * abs(angle)
    smallest = 0.25 * around.resolution
    enough = margin + 4.0 * around.resolution
    need = min(margin, allowed)
    share = 0.0
    while True:
        px, py, ptheta = arc(x, y, theta, share * length, share * angle)
        spare = footprint_clearance(around, body, enough, px, py, ptheta) - need
        if spare < -1e-6:
            return False
        if share >= 1.0:
            return True
        share = min(1.0, share + max(spare, smallest) / sweep) if sweep > 1e-9 else 1.0


@njit(cache=True)
def position_on_stop(state, v, omega, ramp, stop, t):
    """(x, y) at ``t`` seconds: the speeds change to (v, omega) over ``ramp``, then to 0 over ``stop``."""
    x, y, theta, v0, omega0 = state
    if t <= ramp:
        share = t / ramp if ramp > 0.0 else 1.0
        length = t * (v0 + 0.5 * share * (v - v0))
        angle = t * (omega0 + 0.5 * share * (omega - omega0))
        px, py, _ = arc(x, y, theta, length, angle)
        return px, py
    x, y, theta = arc(x, y, theta, ramp * 0.5 * (v0 + v), ramp * 0.5 * (omega0 + omega))
    left = max(0.0, 1.0 - (t - ramp) / stop) if stop > 0.0 else 0.0
    done = 0.5 * stop * (1.0 - left * left)
    px, py, _ = arc(x, y, theta, v * done, omega * done)
    return px, py


@njit(cache=True)
def first_touch(movers, spread, radius, state, v, omega, ramp, stop, until, ahead):
    """Seconds until a mover may come into contact with a motion, inf if none does before ``until``.

    ``movers`` (m, 6) are x, y, vx, vy, radius, top speed as of now; the robot starts at ``state``
    (x, y, theta, v, omega) ``ahead`` seconds from now, changes to (v, omega) over ``ramp`` seconds
    and comes to rest in ``stop`` more. A mover may keep its velocity, stand or turn back, each with
    ``spread`` (m/s) more every second while the robot moves; one that is nearer than ``radius``
    and its own already may not come nearer.
    """
    x, y = state[0], state[1]
    moves = min(ramp + stop, until)
    n = max(2, int(math.ceil(until / TICK)))
    for k in range(n + 1):
        t = until * k / n
        px, py = position_on_stop(state, v, omega, ramp, stop, t)
        after = ahead + t
        for m in range(len(movers)):
            mx, my, vx, vy, size, top = movers[m]
            need = radius + size
            now = math.hypot(mx - x, my - y)
            grown = need + spread * min(after, moves) if now >= need else now - 1e-4
            speed = math.sqrt(vx * vx + vy * vy)
            faster = max(top, speed) / speed if speed > 1e-3 else 0.0
            for way in WAYS:
                dx = mx + way * faster * vx * after - px
                dy = my + way * faster * vy * after - py
                if dx * dx + dy * dy < grown * grown:
                    return t
    return np.inf


@njit(cache=True)
def certify(around, body, margins, allowed, ahead, state, v, omega, limits, period):
    """Why a ``state`` (x, y, theta, v, omega) may not be commanded (v, omega), or ADMISSIBLE.

    Over one period the speeds change, each at its own limit; then both ramp to zero in proportion,
    along one arc. ``allowed`` (m) is the clearance at the start, which is ``ahead`` seconds from
    now. RUN_OVER: the robot could come to rest in time, and a mover would arrive there within the
    margins' ``linger`` seconds.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    parts = 2
    px, py, ptheta, now_v, now_w = state
    for _ in range(parts):
        next_v = slew(now_v, v, a_v, b_v, period / parts)
        next_w = slew(now_w, omega, a_w, b_w, period / parts)
        length = 0.5 * (now_v + next_v) * period / parts
        angle = 0.5 * (now_w + next_w) * period / parts
        if not arc_is_clear(around, body, margins.standing, allowed, px, py, ptheta, length, angle):
            return NO_STOP
        px, py, ptheta = arc(px, py, ptheta, length, angle)
        now_v, now_w = next_v, next_w
    stop = max(abs(now_v) / b_v, abs(now_w) / b_w)
    length, angle = 0.5 * stop * now_v, 0.5 * stop * now_w
    if stop > 0.0 and not arc_is_clear(
        around, body, margins.standing, allowed, px, py, ptheta, length, angle
    ):
        return NO_STOP
    if len(around.movers) == 0:
        return ADMISSIBLE
    moves = period + stop
    touch = first_touch(
        around.movers,
        margins.spread,
        body.circumscribed + margins.movers,
        state,
        now_v,
        now_w,
        period,
        stop,
        moves + margins.linger,
        ahead,
    )
    if touch <= moves + 1e-9:
        return MOVER
    return RUN_OVER if touch < np.inf else ADMISSIBLE


@njit(cache=True)
def coast(x, y, theta, v, omega, commands, durations, limits):
    """Where the robot is after the commands already on their way: (x, y, theta, v, omega)."""
    _, _, a_v, a_w, b_v, b_w, _ = limits
    for i in range(len(durations)):
        parts = 4
        h = durations[i] / parts
        for _ in range(parts):
            next_v = slew(v, commands[i, 0], a_v, b_v, h)
            next_w = slew(omega, commands[i, 1], a_w, b_w, h)
            x, y, theta = arc(x, y, theta, 0.5 * (v + next_v) * h, 0.5 * (omega + next_w) * h)
            v, omega = next_v, next_w
    return x, y, theta, v, omega
