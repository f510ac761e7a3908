"""The certified stop: whether the robot, once it has a command, can come to rest without a touch."""

import math

from numba import njit

from dynastar.dwa.clearance_kernels import footprint_clearance

ADMISSIBLE, NO_STOP, CONTACT, MOVER, RUN_OVER = 0, 1, 2, 3, 4
LEAVING = 0.2  # a footprint that is too near already has to gain this much clearance per metre
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
def arc_is_clear(
    field,
    x0,
    y0,
    resolution,
    vertices,
    inscribed,
    circumscribed,
    margin,
    x,
    y,
    theta,
    length,
    angle,
    allowed,
):
    """Whether the footprint, grown by ``margin``, sweeps only open space along an arc.

    Conservative advancement: no point of the footprint moves further than |length| + R |angle|,
    so a pose that has clearance to spare vouches for the stretch after it. A footprint that is
    nearer than the margin to begin with (``allowed`` < margin) has to leave: it gains clearance.
    """
    sweep = abs(length) + circumscribed * abs(angle)
    smallest = 0.25 * resolution
    share = 0.0
    while True:
        px, py, ptheta = arc(x, y, theta, share * length, share * angle)
        need = min(margin, allowed + LEAVING * share * abs(length))
        spare = (
            footprint_clearance(
                field,
                x0,
                y0,
                resolution,
                vertices,
                inscribed,
                circumscribed,
                margin + 4.0 * resolution,
                px,
                py,
                ptheta,
            )
            - need
        )
        if spare < -1e-6:
            return False
        if share >= 1.0:
            return True
        share = min(1.0, share + max(spare, smallest) / sweep) if sweep > 1e-9 else 1.0


@njit(cache=True)
def position_on_stop(x, y, theta, v0, omega0, v, omega, ramp, stop, t):
    """(x, y) at ``t`` seconds: the speeds change to (v, omega) over ``ramp``, then to 0 over ``stop``."""
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
def movers_stay_clear(
    movers, spread, radius, x, y, theta, v0, omega0, v, omega, ramp, stop, until, ahead
):
    """Whether no mover comes into contact within ``until`` seconds of a motion.

    ``movers`` (m, 6) are x, y, vx, vy, radius, top speed as of now; the robot starts ``ahead``
    seconds from now, changes to (v, omega) over ``ramp`` seconds and comes to rest in ``stop``
    more. A mover may keep its velocity, stand or turn back, each with ``spread`` (m/s) more every
    second while the robot moves. One that is too near already may not be approached further.
    """
    moves = min(ramp + stop, until)
    n = max(2, int(math.ceil(until / 0.15)))
    for m in range(len(movers)):
        gap_now = math.hypot(movers[m, 0] - x, movers[m, 1] - y)
        need = radius + movers[m, 4]
        speed = math.hypot(movers[m, 2], movers[m, 3])
        top = max(speed, movers[m, 5])
        if gap_now > need + top * (until + ahead) + (spread + max(abs(v), abs(v0))) * (
            moves + ahead
        ):
            continue
        for way in WAYS:
            scale = way * top / speed if way != 0.0 and speed > 1e-3 else 0.0
            last = gap_now
            for k in range(n + 1):
                t = until * k / n
                px, py = position_on_stop(x, y, theta, v0, omega0, v, omega, ramp, stop, t)
                after = ahead + t
                gap = math.hypot(
                    movers[m, 0] + scale * movers[m, 2] * after - px,
                    movers[m, 1] + scale * movers[m, 3] * after - py,
                )
                grown = need + spread * min(after, moves)
                if gap < grown and gap < last - 1e-4:
                    return False
                last = min(last, gap)
    return True


@njit(cache=True)
def certify(
    field,
    x0,
    y0,
    resolution,
    vertices,
    inscribed,
    circumscribed,
    margin,
    allowed,
    movers,
    spread,
    linger,
    mover_margin,
    ahead,
    x,
    y,
    theta,
    v0,
    omega0,
    v,
    omega,
    limits,
    period,
):
    """Why (x, y, theta) with speeds (v0, omega0) may not be commanded (v, omega), or ADMISSIBLE.

    Over one period the speeds change, each at its own limit; then both ramp to zero in proportion,
    along one arc. ``allowed`` is the clearance at the start. RUN_OVER: the robot could come to rest
    in time, and a mover would arrive there within ``linger`` seconds.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    parts = 2
    px, py, ptheta = x, y, theta
    now_v, now_w = v0, omega0
    for _ in range(parts):
        next_v = slew(now_v, v, a_v, b_v, period / parts)
        next_w = slew(now_w, omega, a_w, b_w, period / parts)
        length = 0.5 * (now_v + next_v) * period / parts
        angle = 0.5 * (now_w + next_w) * period / parts
        if not arc_is_clear(
            field,
            x0,
            y0,
            resolution,
            vertices,
            inscribed,
            circumscribed,
            margin,
            px,
            py,
            ptheta,
            length,
            angle,
            allowed,
        ):
            return NO_STOP
        px, py, ptheta = arc(px, py, ptheta, length, angle)
        now_v, now_w = next_v, next_w
    stop = max(abs(now_v) / b_v, abs(now_w) / b_w)
    if stop > 0.0 and not arc_is_clear(
        field,
        x0,
        y0,
        resolution,
        vertices,
        inscribed,
        circumscribed,
        margin,
        px,
        py,
        ptheta,
        0.5 * stop * now_v,
        0.5 * stop * now_w,
        allowed,
    ):
        return NO_STOP
    if len(movers) == 0:
        return ADMISSIBLE
    radius = circumscribed + mover_margin
    if not movers_stay_clear(
        movers,
        spread,
        radius,
        x,
        y,
        theta,
        v0,
        omega0,
        now_v,
        now_w,
        period,
        stop,
        period + stop,
        ahead,
    ):
        return MOVER
    if not movers_stay_clear(
        movers,
        spread,
        radius,
        x,
        y,
        theta,
        v0,
        omega0,
        now_v,
        now_w,
        period,
        stop,
        period + stop + linger,
        ahead,
    ):
        return RUN_OVER
    return ADMISSIBLE


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
