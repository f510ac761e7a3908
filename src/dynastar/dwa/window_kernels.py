"""The window (Eqs. 5-7) and its evaluation in one pass over the samples."""

import math

import numpy as np
from numba import njit

from dynastar.dwa.rollout_kernels import normalise_and_choose, roll_out
from dynastar.dwa.stop_kernels import (
    ADMISSIBLE,
    RUN_OVER,
    arc,
    arc_is_clear,
    certify,
    movers_stay_clear,
    position_on_stop,
    slew,
)

HOLDS = (0.0, 1.0, 2.0, 4.0)  # s that a way out goes on before it brakes
HELD = 1e9  # s of a stop so slow that the speeds are held


@njit(cache=True)
def axis(low, high, count, values):
    """``count`` values from low to high, both ends among them and 0 if it lies between; how many."""
    if high - low < 1e-12:
        values[0] = high
        return 1
    for i in range(count):
        values[i] = low + (high - low) * i / (count - 1)
    values[count - 1] = high
    if low < 0.0 < high:
        values[count] = 0.0
        return count + 1
    return count


@njit(cache=True)
def sample_window(
    v, omega, v_min, v_cap, omega_cap, limits, reach, n_v, n_w, speeds, rates, samples
):
    """V_m and V_d (Eqs. 5 and 6): the speeds reachable in ``reach`` seconds; returns how many samples.

    Above ``v_cap`` only braking is left. The last sample is the full brake, both speeds towards
    zero in proportion.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    low, high = slew(v, v_min, a_v, b_v, reach), slew(v, v_cap, a_v, b_v, reach)
    n_speeds = axis(min(low, high), max(low, high), n_v, speeds)
    low, high = slew(omega, -omega_cap, a_w, b_w, reach), slew(omega, omega_cap, a_w, b_w, reach)
    n_rates = axis(min(low, high), max(low, high), n_w, rates)
    k = 0
    for i in range(n_speeds):
        for j in range(n_rates):
            samples[k, 0], samples[k, 1] = speeds[i], rates[j]
            k += 1
    stop = max(abs(v) / b_v, abs(omega) / b_w)
    left = max(0.0, 1.0 - reach / stop) if stop > 0.0 else 0.0
    samples[k, 0], samples[k, 1] = v * left, omega * left
    return k + 1


@njit(cache=True)
def evaluate(
    samples,
    n,
    commands,
    terms,
    refused,
    score,
    x,
    y,
    theta,
    v,
    omega,
    limits,
    period,
    reach,
    horizon,
    steps,
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
    target_x,
    target_y,
    path,
    spacing,
    clearance_cap,
    path_cap,
    at_end,
    v_cap,
    v_scale,
    turning,
    weights,
    by_sum,
):
    """Eqs. 7 to 9 over ``n`` samples; returns the index of the best admissible one, or -1.

    The command of a sample is the next period's step towards it; it has to have a certified stop.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    share = min(1.0, period / reach)
    at_rest = abs(v) < 1e-9 and abs(omega) < 1e-9
    for i in range(n):
        wanted_v, wanted_w = samples[i]
        # Above the cap it brakes fully; else it takes the period's share of the way.
        share_v = 1.0 if wanted_v < v and v > v_cap else share
        next_v = slew(v, v + share_v * (wanted_v - v), a_v, b_v, period)
        next_w = slew(omega, omega + share * (wanted_w - omega), a_w, b_w, period)
        commands[i, 0], commands[i, 1] = next_v, next_w
        code = roll_out(
            wanted_v,
            wanted_w,
            x,
            y,
            theta,
            v,
            omega,
            reach,
            horizon,
            steps,
            field,
            x0,
            y0,
            resolution,
            inscribed,
            margin,
            allowed,
            movers,
            mover_margin,
            ahead,
            target_x,
            target_y,
            path,
            spacing,
            clearance_cap,
            path_cap,
            at_end,
            v_cap,
            v_scale,
            turning,
            b_v,
            b_w,
            terms[i],
        )
        stays = at_rest and next_v == 0.0 and next_w == 0.0
        if code == ADMISSIBLE and not stays:
            code = certify(
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
                v,
                omega,
                next_v,
                next_w,
                limits,
                period,
            )
        if code == RUN_OVER:
            # It may not rest there; it may pass, if it gets across before any mover comes.
            until = max(abs(next_v) / b_v, abs(next_w) / b_w) + linger
            if movers_stay_clear(
                movers,
                spread,
                circumscribed + mover_margin,
                x,
                y,
                theta,
                v,
                omega,
                wanted_v,
                wanted_w,
                reach,
                HELD,
                until,
                ahead,
            ):
                code = ADMISSIBLE
        refused[i] = code
    return normalise_and_choose(terms[:n], refused[:n], weights, by_sum, score[:n])


@njit(cache=True)
def least_gap(movers, radius, ahead, seconds, x, y, theta, v0, omega0, v, omega, ramp, stop):
    """The smallest gap (m) to movers that keep their velocity, from now to ``seconds`` from now."""
    least = np.inf
    n = max(2, int(math.ceil(seconds / 0.15)))
    for k in range(n + 1):
        t = seconds * k / n
        px, py = position_on_stop(x, y, theta, v0, omega0, v, omega, ramp, stop, t)
        for m in range(len(movers)):
            gap = math.hypot(
                movers[m, 0] + movers[m, 2] * (ahead + t) - px,
                movers[m, 1] + movers[m, 3] * (ahead + t) - py,
            )
            least = min(least, gap - radius - movers[m, 4])
    return least


@njit(cache=True)
def evade(
    samples,
    n,
    commands,
    x,
    y,
    theta,
    v,
    omega,
    limits,
    period,
    reach,
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
    ahead,
    seconds,
):
    """The sample that keeps movers farthest away among those that could stop for what stands.

    Returns its index (-1 if there is none), its smallest gap (m), that of a full brake, and that of
    a full brake until it rests. Once reached, a sample is held for one of ``HOLDS``, then braked.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    nobody = movers[:0]
    share = min(1.0, period / reach)
    stop = max(abs(v) / b_v, abs(omega) / b_w)
    braked = least_gap(
        movers, circumscribed, ahead, seconds, x, y, theta, v, omega, v, omega, 0.0, stop
    )
    braking = least_gap(
        movers, circumscribed, ahead, stop, x, y, theta, v, omega, v, omega, 0.0, stop
    )
    best, best_gap = -1, -np.inf
    for i in range(n):
        wanted_v, wanted_w = samples[i]
        next_v = slew(v, v + share * (wanted_v - v), a_v, b_v, period)
        next_w = slew(omega, omega + share * (wanted_w - omega), a_w, b_w, period)
        commands[i, 0], commands[i, 1] = next_v, next_w
        length, angle = 0.5 * (v + wanted_v) * reach, 0.5 * (omega + wanted_w) * reach
        stop = max(abs(wanted_v) / b_v, abs(wanted_w) / b_w)
        qx, qy, qtheta = arc(x, y, theta, length, angle)
        for hold in HOLDS:
            # Held for a while, then braked: the arc of a stop that lasts longer.
            after = stop + 2.0 * hold
            gap = least_gap(
                movers,
                circumscribed,
                ahead,
                seconds,
                x,
                y,
                theta,
                v,
                omega,
                wanted_v,
                wanted_w,
                reach,
                after,
            )
            if gap <= best_gap:
                continue
            if not arc_is_clear(
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
                break
            if not arc_is_clear(
                field,
                x0,
                y0,
                resolution,
                vertices,
                inscribed,
                circumscribed,
                margin,
                qx,
                qy,
                qtheta,
                0.5 * after * wanted_v,
                0.5 * after * wanted_w,
                allowed,
            ):
                break
            code = certify(
                field,
                x0,
                y0,
                resolution,
                vertices,
                inscribed,
                circumscribed,
                margin,
                allowed,
                nobody,
                0.0,
                0.0,
                0.0,
                ahead,
                x,
                y,
                theta,
                v,
                omega,
                next_v,
                next_w,
                limits,
                period,
            )
            if code != ADMISSIBLE:
                break
            best, best_gap = i, gap
    return best, best_gap, braked, braking
