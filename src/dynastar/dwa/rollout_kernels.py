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
from dynastar.dwa.stop_kernels import ADMISSIBLE, CONTACT, MOVER, along_arc

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
        dx, dy, cos, sin = along_arc(0.0, 0.0, cos, sin, h, angle)
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
def follow(v0, v, h, wish, aim_after, arcs, along):
    """Where a robot on the path would be after each step: into ``along`` (2, steps).

    Returns how many steps the path lasts, and the last step that goes no further than ``aim_after``
    (m), or -1. It is the same for all samples of one speed.
    """
    path = wish.path
    length = 0.0
    followed, aim = 0, -1
    for k in range(along.shape[1]):
        length += abs(v0 + arcs.share[k] * (v - v0)) * h
        part = length / wish.spacing
        i = int(part)
        if i < len(path) - 1:  # beyond its end there is nothing to follow
            part -= i
            along[0, k] = (1.0 - part) * path[i, 0] + part * path[i + 1, 0]
            along[1, k] = (1.0 - part) * path[i, 1] + part * path[i + 1, 1]
            followed += 1
        if length <= aim_after:
            aim = k
    return followed, aim


@njit(cache=True)
def clear_of_closed(arcs, state, v, span, around, nearest, must, enough, at_end):
    """The least distance (m) to a closed cell, inf beyond ``enough``, and whether it is a contact.

    That is one nearer than ``nearest`` within ``must`` seconds. Where there is more than enough, so
    there is until that can be used up.
    """
    x, y, _, v0, _ = state
    field, x0, y0, resolution, _ = around
    h = span.horizon / span.steps
    step = max(abs(v0), abs(v), 1e-9) * h
    checked = int(must / h)
    least = np.inf
    k = 0
    while k < max(span.steps, checked):
        px, py = at(arcs, k, x, y, v0, v - v0)
        d = centre_clearance(field, x0, y0, resolution, px, py)
        if d < nearest and k < checked:
            return d, True
        if d > enough + step:
            k += max(1, int(min((d - enough) / step, 1e9)))
            continue
        if k == span.steps - 1 or (k < span.steps and not at_end):
            least = min(least, d)
        k += 1
    return least, False


@njit(cache=True)
def clear_of_movers(arcs, state, v, span, movers, reach, ahead, must, cap, at_end):
    """The least gap (m) to a mover at its predicted time, inf beyond ``cap``, and whether one is met.

    That is within ``must`` seconds; ``reach`` (m) is the robot's own. It looks again when a gap that
    is wider than the cap can be used up.
    """
    x, y, _, v0, _ = state
    h = span.horizon / span.steps
    least, met = np.inf, False
    for m in range(len(movers)):
        mx, my, vx, vy, size, _ = movers[m]
        mx, my = mx + vx * ahead - x, my + vy * ahead - y
        need = reach + size
        enough = need + cap
        step = (max(abs(v0), abs(v)) + math.sqrt(vx * vx + vy * vy)) * h + 1e-9
        k = int(min(max(0.0, math.sqrt(mx * mx + my * my) - enough) / step, 1e9))
        while k < span.steps:
            after = (k + 1) * h
            px, py = at(arcs, k, 0.0, 0.0, v0, v - v0)
            dx, dy = mx + vx * after - px, my + vy * after - py
            square = dx * dx + dy * dy
            if square > (enough + step) * (enough + step):
                k += max(1, int(min((math.sqrt(square) - enough) / step, 1e9)))
                continue
            if square <= need * need and after <= must:
                met = True
            if k == span.steps - 1 or not at_end:
                least = min(least, math.sqrt(square) - need)
            k += 1
    return least, met


@njit(cache=True, fastmath={"reassoc", "nsz"})  # a sum in any order
def stray(arcs, x, y, v0, rise, along, followed):
    """The sum of the distances (m) to where the path would be, over the first ``followed`` steps."""
    total = 0.0
    for k in range(followed):
        px, py = at(arcs, k, x, y, v0, rise)
        dx, dy = px - along[0, k], py - along[1, k]
        total += math.sqrt(dx * dx + dy * dy)
    return total


@njit(cache=True)
def roll_out(
    v, omega, arcs, track, state, span, around, body, margins, allowed, ahead, wish, limits, terms
):
    """Rolls out one sample and writes its four raw terms, each in [0, 1]; returns a refusal code.

    Eq. 7: along that very trajectory the first contact has to lie beyond where a stop from the
    sample's speeds would end. ``arcs`` are those of the sample's turning rate, ``track`` (along,
    followed, aim) is what ``follow`` found for its speed; the other arguments are those of
    ``window_kernels.evaluate``.
    """
    x, y, theta, v0, _ = state
    stop = max(abs(v) / limits.v_brake, abs(omega) / limits.omega_brake)
    must = span.reach + 0.5 * stop  # holding the speeds for half the stop covers the stop's arc
    closer = body.inscribed + min(margins.standing, allowed) - 1e-6
    apart = body.inscribed + margins.standing
    cap = wish.clearance_cap
    clear, contact = clear_of_closed(
        arcs, state, v, span, around, closer, must, apart + cap, wish.at_end
    )
    if contact:
        return CONTACT
    reach = body.inscribed + margins.movers
    gap, met = clear_of_movers(
        arcs, state, v, span, around.movers, reach, ahead, must + 0.5 * stop, cap, wish.at_end
    )
    if met and (v != 0.0 or v0 != 0.0):
        return MOVER
    along, followed, aim = track
    strayed = stray(arcs, x, y, v0, v - v0, along, followed)
    off, turned = 0.0, 0.0
    if aim >= 0:
        x, y = at(arcs, aim, x, y, v0, v - v0)
        turned = arcs.turned[aim]
    if math.hypot(wish.target_x - state[0], wish.target_y - state[1]) > 1e-6:
        off = math.atan2(wish.target_y - y, wish.target_x - x) - theta
        off -= math.tau * math.floor(off / math.tau + 0.5)
        off = abs(off - turned)  # turning the long way round is no way to the target
    terms[HEADING] = 1.0 - min(off, math.pi) / math.pi
    terms[DIST] = min(max(0.0, min(clear - apart, gap)), cap) / cap
    speed = abs(v) if wish.turning else max(0.0, v)
    terms[VEL] = max(0.0, 1.0 - abs(speed - wish.v_best) / wish.v_scale)
    terms[SIMI] = 1.0 - min(1.0, strayed / max(followed, 1) / wish.path_cap)
    return ADMISSIBLE


@njit(cache=True)
def per_sum(terms, refused, j):
    """One over the sum of term ``j`` over the admissible samples, 0 if that is 0."""
    total = 0.0
    for i in range(len(refused)):
        if refused[i] == ADMISSIBLE:
            total += terms[i, j]
    return 1.0 / total if total > 1e-9 else 0.0


@njit(cache=True)
def normalise_and_choose(terms, refused, weights, by_sum, score):
    """Eq. 9 over the admissible samples: G into ``score`` (n,), the best index or -1.

    ``by_sum`` divides each term by its sum over the admissible samples, else the terms stay as they
    are, each over its fixed range. Refused samples score -inf.
    """
    scale = (1.0, 1.0, 1.0, 1.0)
    if by_sum:
        scale = (
            per_sum(terms, refused, HEADING),
            per_sum(terms, refused, DIST),
            per_sum(terms, refused, VEL),
            per_sum(terms, refused, SIMI),
        )
    best = -1
    for i in range(len(refused)):
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
