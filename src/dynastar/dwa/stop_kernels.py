"""The certified stop: whether the robot, once it has a command, can come to rest without a touch."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.clearance_kernels import covered_clearance, footprint_clearance

ADMISSIBLE, NO_STOP, CONTACT, MOVER, RUN_OVER = 0, 1, 2, 3, 4
TICK = 0.15  # s between the looks at where movers are
SIN = (-1 / 6, 1 / 120, -1 / 5040, 1 / 362880)  # of the series of sin(q) / q and of cos(q), in q^2
COS = (-1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800)
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


@njit(cache=True, inline="always")
def half_turn(half):
    """cos(half), sin(half) and sin(half) / half; a series of 1e-13 for the small turns of one step."""
    if abs(half) > 0.3:
        return math.cos(half), math.sin(half), math.sin(half) / half
    q = half * half
    sinc = 1.0 + q * (SIN[0] + q * (SIN[1] + q * (SIN[2] + q * SIN[3])))
    cos = 1.0 + q * (COS[0] + q * (COS[1] + q * (COS[2] + q * (COS[3] + q * COS[4]))))
    return cos, half * sinc, sinc


@njit(cache=True)
def along_arc(x, y, cos, sin, length, angle):
    """``arc`` for a heading that is given, and returned, by its cosine and sine."""
    half_cos, half_sin, sinc = half_turn(0.5 * angle)
    mid_cos, mid_sin = cos * half_cos - sin * half_sin, sin * half_cos + cos * half_sin
    cos, sin = mid_cos * half_cos - mid_sin * half_sin, mid_sin * half_cos + mid_cos * half_sin
    return x + length * sinc * mid_cos, y + length * sinc * mid_sin, cos, sin


@njit(cache=True)
def spare_after(spare, around, body, need, x, y, cos, sin, length, angle):
    """What an arc leaves of ``spare`` (m, clearance beyond ``need``), negative if it is not clear.

    Conservative advancement: no point of the footprint moves further than |length| + R |angle|,
    so a pose that has clearance to spare vouches for the stretch after it, over the arc's end, too.
    """
    sweep = abs(length) + body.circumscribed * abs(angle)
    smallest = 0.25 * around.resolution
    enough = need + 4.0 * around.resolution
    share = 0.0
    while spare < (1.0 - share) * sweep:
        share = min(1.0, share + max(spare, smallest) / sweep)
        px, py, pcos, psin = along_arc(x, y, cos, sin, share * length, share * angle)
        spare = covered_clearance(around, body, px, py, pcos, psin) - need
        if spare < smallest:
            spare = footprint_clearance(around, body, enough, px, py, pcos, psin) - need
        if spare < -1e-6:
            return spare
        spare = max(0.0, spare)
    return spare - (1.0 - share) * sweep


@njit(cache=True)
def stop_from(state, v, omega, ramp):
    """The robot's pose, and that where its speeds have changed to (v, omega) over ``ramp`` seconds.

    Both as (x, y, cos, sin).
    """
    x, y, theta, v0, omega0 = state
    begin = (x, y, math.cos(theta), math.sin(theta))
    return begin, along_arc(*begin, ramp * 0.5 * (v0 + v), ramp * 0.5 * (omega0 + omega))


@njit(cache=True)
def position_on_stop(poses, state, v, omega, ramp, stop, t):
    """(x, y) at ``t`` seconds: the speeds change to (v, omega) over ``ramp``, then to 0 over ``stop``.

    ``poses`` are those of ``stop_from``.
    """
    v0, omega0 = state[3], state[4]
    if t <= ramp:
        share = t / ramp if ramp > 0.0 else 1.0
        length = t * (v0 + 0.5 * share * (v - v0))
        angle = t * (omega0 + 0.5 * share * (omega - omega0))
        px, py, _, _ = along_arc(*poses[0], length, angle)
        return px, py
    left = max(0.0, 1.0 - (t - ramp) / stop) if stop > 0.0 else 0.0
    done = 0.5 * stop * (1.0 - left * left)
    px, py, _, _ = along_arc(*poses[1], v * done, omega * done)
    return px, py


@njit(cache=True)
def enters(x, y, vx, vy, reach, begin, end):
    """When a point that is at (x, y) at 0 seconds comes within ``reach`` of the origin, from begin on.

    inf if it does not before ``end``.
    """
    there_x, there_y = x + vx * begin, y + vy * begin
    inside = there_x * there_x + there_y * there_y - reach * reach
    if inside < 0.0:
        return begin
    square = vx * vx + vy * vy
    nearing = there_x * vx + there_y * vy
    if nearing >= 0.0 or nearing * nearing <= square * inside:
        return np.inf
    at = begin - (nearing + math.sqrt(nearing * nearing - square * inside)) / square
    return at if at <= end else np.inf


@njit(cache=True)
def first_touch(movers, spread, radius, state, v, omega, ramp, stop, until, ahead):
    """Seconds until a mover may come into contact with a motion, inf if none does before ``until``.

    ``movers`` (m, 6) are x, y, vx, vy, radius, top speed as of now; the robot starts at ``state``
    (x, y, theta, v, omega) ``ahead`` seconds from now, changes to (v, omega) over ``ramp`` seconds
    and comes to rest in ``stop`` more. A mover may keep its velocity, stand or turn back, each with
    ``spread`` (m/s) more every second while the robot moves; one that is nearer than ``radius``
    and its own already may not come nearer. While the robot moves it looks every ``TICK``; once it
    rests the touch is where the mover's way enters the disc.
    """
    poses = stop_from(state, v, omega, ramp)
    moves = min(ramp + stop, until)
    looks = max(2, int(math.ceil(moves / TICK)))
    fastest = max(abs(state[3]), abs(v))
    travels = ramp * fastest + 0.5 * stop * abs(v)
    rest_x, rest_y = position_on_stop(poses, state, v, omega, ramp, stop, moves)
    touch = np.inf
    for m in range(len(movers)):
        mx, my, vx, vy, size, top = movers[m]
        now = math.sqrt((mx - state[0]) * (mx - state[0]) + (my - state[1]) * (my - state[1]))
        speed = math.sqrt(vx * vx + vy * vy)
        comes = max(top, speed)
        if now >= radius + size + spread * moves + travels + comes * (ahead + until):
            continue
        faster = comes / speed if speed > 1e-3 else 0.0
        near, grows = (radius + size, spread) if now >= radius + size else (now - 1e-4, 0.0)
        nearing = (fastest + comes + spread + 1e-6) * moves / looks  # from look to look
        spare = now - near - grows * moves - travels - comes * (ahead + moves)
        k = 0 if spare < 0.0 else looks + 1
        while k <= looks:
            t = moves * k / looks
            if t >= touch:
                break
            px, py = position_on_stop(poses, state, v, omega, ramp, stop, t)
            after = ahead + t
            grown = near + grows * min(after, moves)
            square = np.inf
            for way in WAYS:
                dx = mx + way * faster * vx * after - px
                dy = my + way * faster * vy * after - py
                square = min(square, dx * dx + dy * dy)
            spare = math.sqrt(square) - grown
            if spare < 0.0:
                touch = t
            k += max(1, int(spare / nearing))  # until then it cannot be used up
        if until <= moves or touch <= moves:
            continue
        grown = near + grows * moves
        for way in WAYS:
            ux, uy = way * faster * vx, way * faster * vy
            at = enters(mx - rest_x, my - rest_y, ux, uy, grown, ahead + moves, ahead + until)
            touch = min(touch, at - ahead)
    return touch


@njit(cache=True)
def certify(around, body, margins, allowed, ahead, state, v, omega, limits, period):
    """Why a ``state`` (x, y, theta, v, omega) may not be commanded (v, omega), or ADMISSIBLE.

    Over one period the speeds change, each at its own limit; then both ramp to zero in proportion,
    along one arc. ``allowed`` (m) is the clearance at the start, which is ``ahead`` seconds from
    now; a footprint that is nearer than the margin to begin with may not come nearer. RUN_OVER: the
    robot could come to rest in time, and a mover would arrive there within the margins' ``linger``
    seconds.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    parts = 2
    x, y, theta, now_v, now_w = state
    cos, sin = math.cos(theta), math.sin(theta)
    need = min(margins.standing, allowed)
    spare = allowed - need
    for _ in range(parts):
        next_v = slew(now_v, v, a_v, b_v, period / parts)
        next_w = slew(now_w, omega, a_w, b_w, period / parts)
        length = 0.5 * (now_v + next_v) * period / parts
        angle = 0.5 * (now_w + next_w) * period / parts
        spare = spare_after(spare, around, body, need, x, y, cos, sin, length, angle)
        if spare < 0.0:
            return NO_STOP
        x, y, cos, sin = along_arc(x, y, cos, sin, length, angle)
        now_v, now_w = next_v, next_w
    stop = max(abs(now_v) / b_v, abs(now_w) / b_w)
    length, angle = 0.5 * stop * now_v, 0.5 * stop * now_w
    if spare_after(spare, around, body, need, x, y, cos, sin, length, angle) < 0.0:
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
