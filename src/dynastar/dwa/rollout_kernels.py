"""Trajectories of the samples and the raw terms of Eqs. 8 and 9.

While a sample is reached, v(t) = v0 + share(t) (v - v0), and the heading depends on the turning rate
alone. So the positions are linear in the speeds: what a speed of 1 held from the start drives, times
v0, and what one that rises with the share drives, times v - v0. All samples of one turning rate
share these two (``turn``), and no step of a trajectory waits for the one before.
"""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.clearance_kernels import centre_clearance
from dynastar.dwa.stop_kernels import ADMISSIBLE, CONTACT, MOVER, half_turn

HEADING, DIST, VEL, SIMI = range(4)


@njit(cache=True)
def turn(theta, omega0, rate, reach, h, arcs):
    """``arcs`` (see ``dwa.Arcs``) of one turning rate: exact arcs of ``h`` seconds (Eq. 4).

    The speeds go to the sample's over ``reach`` seconds and hold from there.
    """
    cos, sin = math.cos(theta), math.sin(theta)
    held_x = held_y = rise_x = rise_y = turned = 0.0
    for k in range(len(arcs.share)):
        share = min(1.0, (k + 0.5) * h / reach) if reach > 0.0 else 1.0
        angle = (omega0 + share * (rate - omega0)) * h
        half_cos, half_sin, sinc = half_turn(0.5 * angle)
        mid_cos, mid_sin = cos * half_cos - sin * half_sin, sin * half_cos + cos * half_sin
        cos, sin = mid_cos * half_cos - mid_sin * half_sin, mid_sin * half_cos + mid_cos * half_sin
        dx, dy = h * sinc * mid_cos, h * sinc * mid_sin
        held_x, held_y, turned = held_x + dx, held_y + dy, turned + angle
        rise_x, rise_y = rise_x + share * dx, rise_y + share * dy
        arcs.held_x[k], arcs.held_y[k] = held_x, held_y
        arcs.rise_x[k], arcs.rise_y[k] = rise_x, rise_y
        arcs.turned[k], arcs.share[k] = turned, share


@njit(cache=True, inline="always")
def at(arcs, k, x, y, v0, rise):
    """Where the robot is after step ``k``."""
    return (
        x + v0 * arcs.held_x[k] + rise * arcs.rise_x[k],
        y + v0 * arcs.held_y[k] + rise * arcs.rise_y[k],
    )


@njit(cache=True)
def clear_of_movers(movers, arcs, x, y, v0, v, h, steps, must, reach, ahead, cap, at_end):
    """The least gap (m) to a mover at its predicted time, and whether one is met within ``must`` s.

    Movers that cannot come nearer than ``cap`` are passed over; ``reach`` (m) is the robot's own.
    """
    least, met = np.inf, False
    fastest = max(abs(v0), abs(v))
    for m in range(len(movers)):
        mx, my, vx, vy, size, _ = movers[m]
        need = reach + size
        mx, my = mx - x + vx * ahead, my - y + vy * ahead
        far = need + cap + h * steps * (fastest + math.sqrt(vx * vx + vy * vy))
        if mx * mx + my * my >= far * far:
            continue
        nearest = end = np.inf
        for k in range(steps):
            after = (k + 1) * h
            px, py = at(arcs, k, 0.0, 0.0, v0, v - v0)
            dx, dy = mx + vx * after - px, my + vy * after - py
            end = dx * dx + dy * dy
            nearest = min(nearest, end)
            if end <= need * need and after <= must:
                met = True
        least = min(least, math.sqrt(end if at_end else nearest) - need)
    return least, met


@njit(cache=True)
def along_path(arcs, x, y, v0, v, h, steps, path, spacing, aim_after):
    """The mean distance (m) to the path over the same arc length; the last step within ``aim_after``."""
    length = strayed = 0.0
    followed = 0
    aim = -1
    last = len(path) - 1  # beyond its end there is nothing to follow
    per_spacing = 1.0 / spacing
    for k in range(steps):
        length += abs(v0 + arcs.share[k] * (v - v0)) * h
        part = length * per_spacing
        i = int(part)
        if i < last:
            px, py = at(arcs, k, x, y, v0, v - v0)
            part -= i
            dx = px - (1.0 - part) * path[i, 0] - part * path[i + 1, 0]
            dy = py - (1.0 - part) * path[i, 1] - part * path[i + 1, 1]
            strayed += math.sqrt(dx * dx + dy * dy)
            followed += 1
        if length <= aim_after:
            aim = k
    return strayed / max(followed, 1), aim


@njit(cache=True)
def roll_out(sample, arcs, state, span, around, body, margins, allowed, ahead, wish, limits, terms):
    """Rolls out one sample and writes its four raw terms, each in [0, 1]; returns a refusal code.

    Eq. 7: along that very trajectory the first contact has to lie beyond where a stop from the
    sample's speeds would end. ``arcs`` are those of the sample's turning rate, the other arguments
    those of ``window_kernels.evaluate``.
    """
    sample_v, sample_w = sample
    x, y, theta, v0, _ = state
    reach, horizon, steps = span
    h = horizon / steps
    stop = max(abs(sample_v) / limits.v_brake, abs(sample_w) / limits.omega_brake)
    must = reach + 0.5 * stop  # holding the speeds for half the stopping time covers the stop's arc
    field, x0, y0, resolution, movers = around
    nearest = body.inscribed + min(margins.standing, allowed) - 1e-6
    enough = body.inscribed + margins.standing + wish.clearance_cap
    step = max(abs(v0), abs(sample_v)) * h
    checked = int(must / h)
    clear = np.inf
    k = 0
    while k < max(steps, checked):
        px, py = at(arcs, k, x, y, v0, sample_v - v0)
        d = centre_clearance(field, x0, y0, resolution, px, py)
        if d < nearest and k < checked:
            return CONTACT
        if k < steps and (k == steps - 1 or not wish.at_end):
            clear = min(clear, d)
        if d > enough + step and not wish.at_end:  # so is the way until it can be used up
            k += int((d - enough) / step) if step > 1e-9 else steps
        else:
            k += 1
    clear = max(0.0, clear - body.inscribed - margins.standing)
    gap, met = clear_of_movers(
        movers,
        arcs,
        x,
        y,
        v0,
        sample_v,
        h,
        steps,
        must + 0.5 * stop,
        body.inscribed + margins.movers,
        ahead,
        wish.clearance_cap,
        wish.at_end,
    )
    if met and (sample_v != 0.0 or v0 != 0.0):
        return MOVER
    target_gap = math.hypot(wish.target_x - x, wish.target_y - y)
    strayed, aim = along_path(
        arcs, x, y, v0, sample_v, h, steps, wish.path, wish.spacing, 0.5 * target_gap
    )
    off = 0.0
    if target_gap > 1e-6:  # turning the long way round is no way to the target
        aim_x, aim_y, turned = x, y, 0.0
        if aim >= 0:
            aim_x, aim_y = at(arcs, aim, x, y, v0, sample_v - v0)
            turned = arcs.turned[aim]
        off = math.atan2(wish.target_y - aim_y, wish.target_x - aim_x) - theta
        off = abs(math.atan2(math.sin(off), math.cos(off)) - turned)
    terms[HEADING] = 1.0 - min(off, math.pi) / math.pi
    terms[DIST] = min(clear, max(0.0, gap), wish.clearance_cap) / wish.clearance_cap
    speed = abs(sample_v) if wish.turning else max(0.0, sample_v)
    terms[VEL] = max(0.0, 1.0 - abs(speed - wish.v_best) / wish.v_scale)
    terms[SIMI] = 1.0 - min(1.0, strayed / wish.path_cap)
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
