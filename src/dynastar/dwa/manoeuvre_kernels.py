"""Ways past movers: some seconds of driving, step by step, against where they will be."""

import math
from itertools import product

import numpy as np
from numba import njit

from dynastar.dwa.clearance_kernels import footprint_clearance
from dynastar.dwa.stop_kernels import ADMISSIBLE, arc, certify, slew

STEP = 0.2  # s
FOLLOW = -1.0  # in place of seconds: along the path at the first of two speeds
SPEEDS = (0.0, 0.25, 0.5, 1.0)  # of the largest
PATH_SPEEDS = (0.125, 0.25, 0.375, 0.5, 0.75, 1.0)  # the same, along the path
RATES = (0.0, -0.5, 0.5, -1.0, 1.0)  # of the largest
SWITCHES = (1.0, 2.0, 4.0)  # s
# v, omega, the seconds that they are asked for, and v, omega from then on; speeds as shares.
MANOEUVRES = np.array(
    [(v, 0.0, FOLLOW, v, 0.0) for v in PATH_SPEEDS]
    + list(product(SPEEDS, RATES, SWITCHES, SPEEDS, RATES[:3]))
)
PURSUED = 6  # points of the path ahead that are steered at
ROOM = 0.25  # share of the margin that a way has to keep; what is commanded keeps all of it
SURE = 3.0  # s of driving over which it gets less sure how near movers come
TOUCH = -10.0  # m, off the gap to one that is touched while the robot moves
EVEN = 0.02  # m, gaps that differ by less are even


@njit(cache=True)
def pursue(x, y, theta, path, at, speed):
    """The speeds to ask for to get onto ``path`` (n, 2) and along it; the nearest point's index.

    ``at`` is that index so far.
    """
    while at < len(path) - 1 and math.hypot(path[at + 1, 0] - x, path[at + 1, 1] - y) <= math.hypot(
        path[at, 0] - x, path[at, 1] - y
    ):
        at += 1
    aim = min(at + PURSUED, len(path) - 1)
    dx, dy = path[aim, 0] - x, path[aim, 1] - y
    if aim == len(path) - 1 and math.hypot(dx, dy) < 0.2:
        return 0.0, 0.0, at
    off = math.atan2(dy, dx) - theta
    off = math.atan2(math.sin(off), math.cos(off))
    return speed * max(0.0, math.cos(1.5 * off)) if abs(off) < 1.0 else 0.0, 2.0 * off, at


@njit(cache=True)
def nearest_mover(movers, after, x, y):
    """The gap (m) from a point to movers ``after`` seconds from now, that keep on or turn back."""
    least = np.inf
    for m in range(len(movers)):
        mx, my, vx, vy, radius, top = movers[m]
        speed = math.hypot(vx, vy)
        back = -max(speed, top) / speed if speed > 1e-3 else 0.0
        for way in (1.0, back):
            gap = math.hypot(mx + way * vx * after - x, my + way * vy * after - y)
            least = min(least, gap - radius)
    return least


@njit(cache=True)
def asked(manoeuvre, t, x, y, theta, path, at, limits):
    """The speeds that a manoeuvre asks for at ``t`` seconds, and the nearest point of the path."""
    if manoeuvre[2] == FOLLOW:
        v, omega, at = pursue(x, y, theta, path, at, manoeuvre[0] * limits.v_max)
        return v, max(-limits.omega_max, min(limits.omega_max, omega)), at
    first = 0 if t < manoeuvre[2] - 1e-9 else 3
    return manoeuvre[first] * limits.v_max, manoeuvre[first + 1] * limits.omega_max, at


@njit(cache=True)
def drive(manoeuvre, state, path, seconds, around, body, spread, need, ahead, limits):
    """Drives a manoeuvre for ``seconds`` and stops; returns (gap, x, y).

    The gap (m) is the smallest to movers within that time, less ``spread`` (m/s) for every second
    that the robot moves; ``TOUCH`` lower if one touches before the robot rests, -inf if it comes
    nearer than ``need`` (m) to what stands. (x, y) is where it is after ``seconds``.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    x, y, theta, v, omega = state
    least = np.inf
    t = moved = 0.0
    at = 0
    end_x, end_y = x, y
    while t < seconds - 1e-9 or v != 0.0 or omega != 0.0:
        want_v = want_w = 0.0
        if t < seconds - 1e-9:
            want_v, want_w, at = asked(manoeuvre, t, x, y, theta, path, at, limits)
        next_v, next_w = slew(v, want_v, a_v, b_v, STEP), slew(omega, want_w, a_w, b_w, STEP)
        rests = v == 0.0 and next_v == 0.0
        x, y, theta = arc(x, y, theta, 0.5 * (v + next_v) * STEP, 0.5 * (omega + next_w) * STEP)
        v, omega = next_v, next_w
        t += STEP
        if not rests:
            moved = min(moved + STEP, SURE)
        sweeps = not rests or len(body.vertices) > 0
        if sweeps and footprint_clearance(around, body, need + 0.05, x, y, theta) < need - 1e-6:
            return -np.inf, x, y
        if t <= seconds + 1e-9:
            end_x, end_y = x, y
            gap = nearest_mover(around.movers, ahead + t, x, y) - body.circumscribed
            gap -= spread * moved
            least = min(least, gap + TOUCH if gap <= 0.0 and not rests else gap)
    return least, end_x, end_y


@njit(cache=True)
def may_pass(state, path, seconds, around, body, margins, allowed, ahead, limits):
    """Whether movers stay clear if the robot goes on along the path, at one speed or another."""
    need = ROOM * min(margins.standing, allowed)
    for i in range(len(PATH_SPEEDS)):
        gap, _, _ = drive(
            MANOEUVRES[i], state, path, seconds, around, body, margins.spread, need, ahead, limits
        )
        if gap > 0.0:
            return True
    return False


@njit(cache=True)
def way_out(
    state, path, seconds, enough, around, body, margins, nobody, allowed, ahead, limits, period
):
    """The first command of the manoeuvre that keeps movers ``enough`` metres away, or farthest.

    Of those with as large a gap it is the one that ends nearest the path's end. Returns whether one
    is better than braking, its v and omega, and the gap (m) of braking. The command has a certified
    stop for all that stands: ``nobody`` is ``around`` without movers.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    x, y, theta, v, omega = state
    goal_x, goal_y = path[-1]
    need = ROOM * min(margins.standing, allowed)
    stand = np.zeros(5)
    spread = margins.spread
    braked, _, _ = drive(stand, state, path, seconds, around, body, spread, -1.0, ahead, limits)
    best, nearest, found = min(braked, enough), np.inf, False
    best_v = best_w = 0.0
    for i in range(len(MANOEUVRES)):
        gap, end_x, end_y = drive(
            MANOEUVRES[i], state, path, seconds, around, body, spread, need, ahead, limits
        )
        gap, left = min(gap, enough), math.hypot(goal_x - end_x, goal_y - end_y)
        if not (gap > best + EVEN or (found and gap > best - EVEN and left < nearest)):
            continue
        want_v, want_w, _ = asked(MANOEUVRES[i], 0.0, x, y, theta, path, 0, limits)
        next_v, next_w = slew(v, want_v, a_v, b_v, period), slew(omega, want_w, a_w, b_w, period)
        code = certify(nobody, body, margins, allowed, ahead, state, next_v, next_w, limits, period)
        if code == ADMISSIBLE:
            best, nearest, found = max(gap, best), left, True
            best_v, best_w = next_v, next_w
    return found, best_v, best_w, braked
