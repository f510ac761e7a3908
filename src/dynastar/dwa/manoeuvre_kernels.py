"""Ways past movers: some seconds of driving, step by step, against where they will be."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.clearance_kernels import footprint_clearance
from dynastar.dwa.stop_kernels import ADMISSIBLE, RUN_OVER, arc, certify, slew

STEP = 0.2  # s
GENTLE = 0.8  # share of the braking that stopping where a way leads may use
PURSUED = 3  # points of the path ahead that are steered at
SURE = 1.5  # s of driving over which it gets less sure how near movers come
LATE = 0.1  # m of gap that a second is worth by which a touch is put off
EVEN = 0.02  # m, gaps that differ by less are even


@njit(cache=True)
def steer(x, y, theta, aim_x, aim_y, speed, left, limits):
    """The speeds to ask for to get to a point, in place first if it is far aside.

    ``left`` (m) is how far it still is to where the robot should stop.
    """
    v_max, omega_max, _, _, b_v, b_w, v_min = limits
    off = math.atan2(aim_y - y, aim_x - x) - theta
    off = math.atan2(math.sin(off), math.cos(off))
    top = min(speed, v_max)
    way = 1.0
    if v_min < 0.0 and abs(off) > math.pi - 1.0:  # it lies behind, and the robot may back
        off -= math.copysign(math.pi, off)
        top, way = min(speed, -v_min), -1.0
    omega = math.copysign(min(omega_max, math.sqrt(2.0 * GENTLE * b_w * abs(off))), off)
    if abs(off) >= 1.0:
        return 0.0, omega
    return way * min(top, math.sqrt(2.0 * GENTLE * b_v * left)) * math.cos(1.5 * off), omega


@njit(cache=True)
def asked(way, t, x, y, theta, path, at, limits):
    """The speeds that a way asks for at ``t`` seconds, and the index of the path's nearest point.

    A ``way`` is (v, omega, seconds, speed, x, y): v and omega are held for so long; then it leads to
    (x, y) at the speed, straight on where they are infinite, or along ``path`` (n, 3), x, y and
    the speed that it allows there, where they are no numbers; ``at`` is the index so far. No speed
    is to stop.
    """
    v, omega, held, speed, aim_x, aim_y = way
    if t < held - 1e-9:
        return v, omega, at
    if speed == 0.0 or aim_x == np.inf:
        return speed, 0.0, at
    if aim_x == aim_x:
        left = math.hypot(aim_x - x, aim_y - y) - 0.1
    else:
        while at < len(path) - 1 and math.hypot(
            path[at + 1, 0] - x, path[at + 1, 1] - y
        ) <= math.hypot(path[at, 0] - x, path[at, 1] - y):
            at += 1
        aim = min(at + PURSUED, len(path) - 1)
        aim_x, aim_y = path[aim, 0], path[aim, 1]
        speed = min(speed, path[at, 2])
        left = math.hypot(path[-1, 0] - x, path[-1, 1] - y) - 0.1
    if left <= 0.0:
        return 0.0, 0.0, at
    v, omega = steer(x, y, theta, aim_x, aim_y, speed, left, limits)
    return v, omega, at


@njit(cache=True)
def nearest_mover(movers, after, turn, x, y):
    """The gap (m) from a point to movers ``after`` seconds from now, if they turn back at ``turn``.

    They turn back at their top speed; if they never do they go on at it, or as fast as they are now.
    """
    least = np.inf
    for m in range(len(movers)):
        mx, my, vx, vy, radius, top = movers[m]
        speed = math.hypot(vx, vy)
        faster = max(speed, top) / speed if speed > 1e-3 else 0.0
        span = after if after <= turn else turn - (after - turn) * faster
        least = min(least, math.hypot(mx + vx * span - x, my + vy * span - y) - radius)
        if turn == np.inf and faster > 1.0:
            span = after * faster
            least = min(least, math.hypot(mx + vx * span - x, my + vy * span - y) - radius)
    return least


@njit(cache=True)
def drive(way, state, path, seconds, scene, need, turns, stoppable, spread, gaps, touched):
    """Drives a way for ``seconds`` and stops; returns where it is then, and whether that can be.

    ``gaps`` (n,) get the smallest gap (m) to movers within that time if they turn back at each of
    ``turns`` (n,), less ``spread`` (m/s) for every second that it drives, and ``touched`` (n,) when
    it falls to 0, inf if it does not. With ``stoppable`` the gap counts too that there would be after a
    stop from each moment. The robot may not come nearer than ``need`` (m) to what stands.
    """
    _, _, around, body, _, _, ahead, limits, _ = scene
    _, _, a_v, a_w, b_v, b_w, _ = limits
    x, y, theta, v, omega = state
    gaps[:] = touched[:] = np.inf
    t = moved = 0.0
    at = 0
    end_x, end_y = x, y
    while t < seconds - 1e-9 or v != 0.0 or omega != 0.0:
        want_v = want_w = 0.0
        if t < seconds - 1e-9:
            want_v, want_w, at = asked(way, t, x, y, theta, path, at, limits)
        next_v, next_w = slew(v, want_v, a_v, b_v, STEP), slew(omega, want_w, a_w, b_w, STEP)
        drives = v != 0.0 or next_v != 0.0
        x, y, theta = arc(x, y, theta, 0.5 * (v + next_v) * STEP, 0.5 * (omega + next_w) * STEP)
        v, omega = next_v, next_w
        t += STEP
        if drives:
            moved = min(moved + STEP, SURE)
        if drives or len(body.vertices) > 0:
            cos, sin = math.cos(theta), math.sin(theta)
            clear = footprint_clearance(around, body, need + 0.05, x, y, cos, sin)
            if clear < need - 1e-6:
                return x, y, False
        if t > seconds + 1e-9:
            continue
        end_x, end_y = x, y
        stop = max(abs(v) / b_v, abs(omega) / b_w)
        px, py, _ = arc(x, y, theta, 0.5 * v * stop, 0.5 * omega * stop)
        for h in range(len(turns)):
            gap = nearest_mover(around.movers, ahead + t, turns[h], x, y)
            if stoppable:
                gap = min(gap, nearest_mover(around.movers, ahead + t + stop, turns[h], px, py))
            gap -= body.circumscribed + spread * moved
            gaps[h] = min(gaps[h], gap)
            if gap <= 0.0:
                touched[h] = min(touched[h], t)
    return end_x, end_y, True


@njit(cache=True)
def worth(gaps, touched, enough, seconds):
    """What a way is worth (m): the mean of its gaps up to ``enough``, less for an early touch."""
    total = 0.0
    for h in range(len(gaps)):
        total += min(gaps[h], enough) + LATE * min(touched[h] - seconds, 0.0)
    return total / len(gaps)


@njit(cache=True)
def first_command(way, state, path, scene):
    """A way's first command (v, omega), whether it can stop for what stands, and before movers."""
    around, nobody, _, body, margins, allowed, ahead, limits, period = scene
    _, _, a_v, a_w, b_v, b_w, _ = limits
    x, y, theta, v, omega = state
    want_v, want_w, _ = asked(way, 0.0, x, y, theta, path, 0, limits)
    next_v, next_w = slew(v, want_v, a_v, b_v, period), slew(omega, want_w, a_w, b_w, period)
    code = certify(nobody, body, margins, allowed, ahead, state, next_v, next_w, limits, period)
    if code != ADMISSIBLE:
        return next_v, next_w, False, False
    code = certify(around, body, margins, allowed, ahead, state, next_v, next_w, limits, period)
    return next_v, next_w, True, code in (ADMISSIBLE, RUN_OVER)


@njit(cache=True)
def along(speeds, least_v, enough, state, path, seconds, scene, turns, gaps, touched):
    """The first command of going on along the path, at the first of ``speeds`` that keeps clear.

    Movers have to stay ``enough`` (m) away, and would if the robot stopped on the way. Returns whether
    there is such a command that is faster than ``least_v``, its v and omega.
    """
    need = min(scene.margins.standing, scene.allowed)
    for speed in speeds:
        way = np.array((0.0, 0.0, 0.0, speed, np.nan, np.nan))
        v, omega, _, safe = first_command(way, state, path, scene)
        if not safe or v <= least_v:
            continue
        spread = scene.margins.spread
        _, _, can_be = drive(
            way, state, path, seconds, scene, need, turns, True, spread, gaps, touched
        )
        if can_be and gaps.min() > enough:
            return True, v, omega
    return False, 0.0, 0.0


@njit(cache=True)
def aside(ways, enough, state, path, seconds, scene, turns, gaps, touched):
    """The way, of ``ways`` (n, 6), that keeps movers ``enough`` metres away, or farthest and latest.

    That is ``worth`` over all ``turns`` that they may take. Of those that are even it is the one that
    ends nearest the path's end. Its first command has a certified stop for all that stands, and one
    before movers too, unless none comes near on the way or, for all that can be told, it will be
    touched before it could rest. Where it would be touched at rest, as surely, backing counts as no
    less sure, and may end in a touch, too, as long as the robot can be at rest by then. Returns the
    way's index or -1 if none is better than braking, its first v and omega, and the least gap (m) of
    braking.
    """
    limits = scene.limits
    goal_x, goal_y = path[-1, 0], path[-1, 1]
    need = min(scene.margins.standing, scene.allowed)
    brake, spread = np.zeros(6), scene.margins.spread
    drive(brake, state, path, seconds, scene, -1.0, turns, False, 0.0, gaps, touched)
    depth = gaps.min()  # negative where a touch is sure, as far as that can be told
    stop = max(abs(state[3]) / limits.v_brake, abs(state[4]) / limits.omega_brake)
    doomed = touched.min() <= stop
    drive(brake, state, path, seconds, scene, -1.0, turns, False, spread, gaps, touched)
    braked = gaps.min()
    best, nearest, found = worth(gaps, touched, enough, seconds), np.inf, -1
    best_v = best_w = 0.0
    if braked >= enough:
        return found, best_v, best_w, braked
    for i in range(len(ways)):
        backs = depth < 0.0 and ways[i, 0] < 0.0
        strays = 0.0 if backs else spread
        end_x, end_y, can_be = drive(
            ways[i], state, path, seconds, scene, need, turns, False, strays, gaps, touched
        )
        gap = worth(gaps, touched, enough, seconds)
        left = math.hypot(goal_x - end_x, goal_y - end_y)
        better = gap > best + EVEN or (found >= 0 and gap > best - EVEN and left < nearest)
        if not can_be or not better:
            continue
        v, omega, standing, moving = first_command(ways[i], state, path, scene)
        rest = scene.period + max(abs(v) / limits.v_brake, abs(omega) / limits.omega_brake)
        clear = doomed or gaps.min() > 0.0 or (backs and touched.min() > rest + STEP)
        if standing and (moving or clear):
            best, nearest, found = max(gap, best), left, i
            best_v, best_w = v, omega
    return found, best_v, best_w, braked
