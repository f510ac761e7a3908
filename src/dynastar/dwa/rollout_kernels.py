"""Trajectories of the samples and the raw terms of Eqs. 8 and 9."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.clearance_kernels import centre_clearance
from dynastar.dwa.stop_kernels import ADMISSIBLE, CONTACT, MOVER, half_turn

HEADING, DIST, VEL, SIMI = range(4)


@njit(cache=True)
def roll_out(sample, state, span, around, body, margins, allowed, ahead, wish, limits, terms):
    """Rolls out one sample and writes its four raw terms, each in [0, 1]; returns a refusal code.

    The speeds go to the sample's over ``reach`` seconds and hold from there (Eq. 4, exact arcs).
    Eq. 7: along that very trajectory the first contact has to lie beyond where a stop from the
    sample's speeds would end. The other arguments are those of ``window_kernels.evaluate``.
    """
    sample_v, sample_w = sample
    x, y, theta, v0, omega0 = state
    reach, horizon, steps = span
    field, x0, y0, resolution, movers = around
    radius, margin = body.inscribed, margins.standing
    path, spacing = wish.path, wish.spacing
    h = horizon / steps
    stop = max(abs(sample_v) / limits.v_brake, abs(sample_w) / limits.omega_brake)
    must = reach + 0.5 * stop  # holding the speeds for half the stopping time covers the stop's arc
    total = max(steps, int(math.ceil(must / h)))
    target_gap = math.hypot(wish.target_x - x, wish.target_y - y)
    nearest = min(margin, allowed) - 1e-6
    moves = abs(sample_v) > 0.0 or abs(v0) > 0.0
    per_spacing = 1.0 / spacing
    px, py, ptheta = x, y, theta
    cos, sin = math.cos(theta), math.sin(theta)
    length = 0.0
    least = end_clearance = np.inf
    strayed = 0.0
    followed = 0
    aim_x, aim_y, aim_theta = x, y, theta
    for k in range(1, total + 1):
        t = (k - 0.5) * h
        share = min(1.0, t / reach) if reach > 0.0 else 1.0
        v = v0 + share * (sample_v - v0)
        w = omega0 + share * (sample_w - omega0)
        half_cos, half_sin, sinc = half_turn(0.5 * w * h)
        mid_cos, mid_sin = cos * half_cos - sin * half_sin, sin * half_cos + cos * half_sin
        cos, sin = mid_cos * half_cos - mid_sin * half_sin, mid_sin * half_cos + mid_cos * half_sin
        px, py, ptheta = px + v * h * sinc * mid_cos, py + v * h * sinc * mid_sin, ptheta + w * h
        length += abs(v) * h
        clear = centre_clearance(field, x0, y0, resolution, px, py) - radius
        if clear < nearest and k * h <= must:
            return CONTACT
        if k > steps:
            continue
        clear = max(0.0, clear - margin)
        after = ahead + k * h
        for m in range(len(movers)):
            dx = movers[m, 0] + movers[m, 2] * after - px
            dy = movers[m, 1] + movers[m, 3] * after - py
            need = radius + movers[m, 4] + margins.movers
            if dx * dx + dy * dy >= (need + clear) * (need + clear):
                continue
            gap = math.sqrt(dx * dx + dy * dy) - need
            if gap <= 0.0 and k * h <= must + 0.5 * stop and moves:
                return MOVER
            clear = min(clear, max(0.0, gap))
        least = min(least, clear)
        end_clearance = clear
        part = length * per_spacing
        i = int(part)
        if i < len(path) - 1:  # beyond its end there is nothing to follow
            part -= i
            dx = px - (1.0 - part) * path[i, 0] - part * path[i + 1, 0]
            dy = py - (1.0 - part) * path[i, 1] - part * path[i + 1, 1]
            strayed += math.sqrt(dx * dx + dy * dy)
            followed += 1
        if length <= 0.5 * target_gap:
            aim_x, aim_y, aim_theta = px, py, ptheta
    off = 0.0
    if target_gap > 1e-6:  # turning the long way round is no way to the target
        off = math.atan2(wish.target_y - aim_y, wish.target_x - aim_x) - theta
        off = abs(math.atan2(math.sin(off), math.cos(off)) - (aim_theta - theta))
    terms[HEADING] = 1.0 - min(off, math.pi) / math.pi
    terms[DIST] = (
        min(end_clearance if wish.at_end else least, wish.clearance_cap) / wish.clearance_cap
    )
    speed = abs(sample_v) if wish.turning else max(0.0, sample_v)
    terms[VEL] = max(0.0, 1.0 - abs(speed - wish.v_best) / wish.v_scale)
    terms[SIMI] = 1.0 - min(1.0, strayed / max(followed, 1) / wish.path_cap)
    return ADMISSIBLE


@njit(cache=True)
def normalise_and_choose(terms, refused, weights, by_sum, score):
    """Eq. 9 over the admissible samples: G into ``score`` (n,), the best index or -1.

    ``by_sum`` divides each term by its sum over the admissible samples, else the terms stay as they
    are, each over its fixed range. Refused samples score -inf.
    """
    n = len(refused)
    scale = np.ones(4)
    if by_sum:
        for j in range(4):
            total = 0.0
            for i in range(n):
                if refused[i] == ADMISSIBLE:
                    total += terms[i, j]
            scale[j] = 1.0 / total if total > 1e-9 else 0.0
    best = -1
    for i in range(n):
        if refused[i] != ADMISSIBLE:
            score[i] = -np.inf
            continue
        g = 0.0
        for j in range(4):
            g += weights[j] * terms[i, j] * scale[j]
        score[i] = g
        if best < 0 or g > score[best]:
            best = i
    return best
