"""The window (Eqs. 5-7) and its evaluation in one pass over the samples."""

import math

from dynastar.compiled import njit
from dynastar.dwa.rollout_kernels import follow, normalise_and_choose, roll_out, turn
from dynastar.dwa.stop_kernels import ADMISSIBLE, certify, slew


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
    """V_m and V_d (Eqs. 5 and 6): the speeds reachable in ``reach`` seconds.

    Above ``v_cap`` only braking is left. The last sample is the full brake, both speeds towards
    zero in proportion. Samples of one turning rate come one after the other, in the same order of
    speeds. Returns how many samples there are, and how many speeds.
    """
    _, _, a_v, a_w, b_v, b_w, _ = limits
    low, high = slew(v, v_min, a_v, b_v, reach), slew(v, v_cap, a_v, b_v, reach)
    n_speeds = axis(min(low, high), max(low, high), n_v, speeds)
    low, high = slew(omega, -omega_cap, a_w, b_w, reach), slew(omega, omega_cap, a_w, b_w, reach)
    n_rates = axis(min(low, high), max(low, high), n_w, rates)
    k = 0
    for j in range(n_rates):
        for i in range(n_speeds):
            samples[k, 0], samples[k, 1] = speeds[i], rates[j]
            k += 1
    stop = max(abs(v) / b_v, abs(omega) / b_w)
    left = max(0.0, 1.0 - reach / stop) if stop > 0.0 else 0.0
    samples[k, 0], samples[k, 1] = v * left, omega * left
    return k + 1, n_speeds


@njit(cache=True)
def evaluate(
    buffers,
    n,
    n_speeds,
    state,
    span,
    around,
    body,
    margins,
    allowed,
    ahead,
    wish,
    limits,
    period,
    weights,
    by_sum,
):
    """Eqs. 7 to 9 over ``n`` samples; returns the index of the best admissible one, or -1.

    They come as ``sample_window`` orders them. The command of a sample is the next period's step
    towards it; it has to have a certified stop. The groups are the NamedTuples of ``dwa.py``;
    ``allowed`` (m) is the clearance at the start, which is ``ahead`` seconds from now.
    """
    samples, commands, terms, refused, score, arcs, tracks = buffers
    _, _, a_v, a_w, b_v, b_w, _ = limits
    x, y, theta, v, omega = state
    h = span.horizon / span.steps
    half_way = 0.5 * math.hypot(wish.target_x - x, wish.target_y - y)
    share = min(1.0, period / span.reach)
    at_rest = abs(v) < 1e-9 and abs(omega) < 1e-9
    for i in range(n):
        wanted_v, wanted_w = samples[i]
        if i == 0 or wanted_w != samples[i - 1, 1]:
            turn(theta, omega, wanted_w, span.reach, h, arcs)
        column = i % n_speeds if i < n - 1 else n_speeds
        if i < n_speeds or i == n - 1:
            tracks.followed[column], tracks.aim[column] = follow(
                v, wanted_v, h, wish, half_way, arcs, tracks.along[column]
            )
        track = (tracks.along[column], tracks.followed[column], tracks.aim[column])
        # Above the cap it brakes fully; else it takes the period's share of the way.
        share_v = 1.0 if wanted_v < v and v > wish.v_cap else share
        next_v = slew(v, v + share_v * (wanted_v - v), a_v, b_v, period)
        next_w = slew(omega, omega + share * (wanted_w - omega), a_w, b_w, period)
        commands[i, 0], commands[i, 1] = next_v, next_w
        code = roll_out(
            wanted_v,
            wanted_w,
            arcs,
            track,
            state,
            span,
            around,
            body,
            margins,
            allowed,
            ahead,
            wish,
            limits,
            terms[i],
        )
        stays = at_rest and next_v == 0.0 and next_w == 0.0
        if code == ADMISSIBLE and not stays:
            code = certify(
                around, body, margins, allowed, ahead, state, next_v, next_w, limits, period
            )
        refused[i] = code
    return normalise_and_choose(terms[:n], refused[:n], weights, by_sum, score[:n])
