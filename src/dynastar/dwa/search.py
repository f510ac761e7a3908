"""The search over the window: every sample's manoeuvres are rolled out, the best is taken.

A manoeuvre holds the sample for a short or a long time; then the robot follows the cost-to-go,
stops, or backs off.
"""

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.admissible import (
    ADMISSIBLE,
    HIDDEN,
    NO_STOP,
    certified_stop,
    rests_in_time,
)
from dynastar.dwa.motion import slew, stopping_time
from dynastar.dwa.objective import objective
from dynastar.dwa.rollout import (
    LOOKS,
    SCORED,
    TOUCHED,
    farthest,
    future,
    least_clearance,
    pose_value,
    tail_speeds,
    weights_of,
)
from dynastar.dwa.scene import BACK, FOLLOW, STOP

LEAST = 0.1  # m of progress that is worth all of it, at least


@njit(cache=True)
def worth_holding(sample, limits, tail, long, people):
    """Whether a future of that kind tells anything: long holds and other tails matter among people."""
    if not people and tail != FOLLOW:
        return False
    if tail == BACK and (long or limits.v_min >= 0.0):
        return False
    return not (long and (abs(sample[0]) < 0.1 * limits.v_max or abs(sample[1]) > 2.0))


@njit(cache=True)
def refusal(scene, rules, state, command):
    """ADMISSIBLE, or why a command is not; MOVER where it does not rest in time."""
    body, limits, period = rules.body, rules.limits, rules.period
    code = certified_stop(scene, body, limits, state, command, period)
    if code != ADMISSIBLE:
        return code
    return rests_in_time(scene, body, limits, state, command, period)


@njit(cache=True)
def prepare(scene, rules, state, stop_from, n, buffers):
    """Writes the last two candidates, the commands of all n + 2, and why they are refused.

    ``stop_from`` (v, omega) are the speeds from which stops are certified.
    """
    limits, comfort, period = rules.limits, rules.span.comfort, rules.period
    samples, commands, refused = buffers[0], buffers[1], buffers[5]
    pose, v, omega = state
    field, last = scene.cost_to_go, scene.last
    gap = least_clearance(scene.obstacles, rules.body, pose) - scene.margin
    samples[n] = last.v, last.omega
    if last.hold < 0.5 * rules.span.step:
        samples[n] = tail_speeds(field, limits, comfort, pose, v, gap, last.tail)
    samples[n + 1] = tail_speeds(field, limits, comfort, pose, v, gap, FOLLOW)
    slowest, fastest = samples[:n, 0].min(), samples[:n, 0].max()
    for i in range(n + 2):
        samples[i, 0] = min(max(samples[i, 0], slowest), fastest)
        commands[i, 0] = slew(v, samples[i, 0], limits.v_accel, limits.v_brake, period)
        commands[i, 1] = slew(omega, samples[i, 1], limits.omega_accel, limits.omega_brake, period)
        refused[i] = refusal(
            scene, rules, (pose, stop_from[0], stop_from[1]), (commands[i, 0], commands[i, 1])
        )


@njit(cache=True)
def best_of(scene, rules, state, asked, buffers, scale, unseen):
    """The best of the candidates by Eq. 9, or -1. ``asked`` is (n, whether it is ``bounded``).

    Considers the candidates that are admissible or would have to pass moving obstacles; with
    ``unseen`` those that were refused for unseen space. ``scale`` is (the cost-to-go now, the most
    progress), both in metres.
    """
    limits, span = rules.limits, rules.span
    samples, commands, holds, tails, terms, refused, score = buffers
    n, bounded = asked
    worst = np.zeros((len(scene.people.now), scene.people.mean.shape[1]))
    found = np.zeros(5)
    people = len(scene.people.now) > 0
    best, best_score = -1, -np.inf
    for j in range(n + 2):
        i = j - 2 if j > 1 else n + j
        score[i] = -np.inf
        if refused[i] == NO_STOP or (refused[i] == HIDDEN) != unseen:
            continue
        sample, clear_for = (samples[i, 0], samples[i, 1]), 0.0
        if refused[i] != ADMISSIBLE:
            clear_for = scene.ahead + rules.period
            clear_for += stopping_time(commands[i, 0], commands[i, 1], limits)
        change = 0.0 if i == n else span.hysteresis
        for kind in range(6):
            tail, long = kind % 3, kind >= 3
            held = span.long_steps if long else span.steps
            if i == n:
                held = max(1, round(scene.last.hold / span.step))
                if kind != scene.last.tail:
                    continue
            elif i == n + 1:
                held = 1
                if kind != FOLLOW:
                    continue
            elif not worth_holding(sample, limits, tail, long, people):
                continue
            manoeuvre = (*sample, held, tail, clear_for)
            enough = max(best_score, score[i]) + change if bounded else -np.inf
            gauge = (scale[0], scale[1], enough)
            outcome = future(scene, rules, state, manoeuvre, gauge, found, worst)
            if outcome != TOUCHED:
                refused[i] = ADMISSIBLE
            if outcome == SCORED:
                total = objective(weights_of(rules, scene), found) - change
                if total > score[i]:
                    score[i] = total
                    terms[i] = found
                    holds[i] = scene.last.hold if i == n else held * span.step
                    tails[i] = tail
        if score[i] > best_score:
            best, best_score = i, score[i]
    return best


@njit(cache=True)
def stops_in_the_way(scene, rules, state, scale):
    """Whether a moving obstacle, as it is expected to go on, would touch a robot that stops now."""
    worst = np.zeros((len(scene.people.now), scene.people.mean.shape[1]))
    stop = (0.0, 0.0, 1, STOP, np.inf)
    gauge = (scale[0], scale[1], -np.inf)
    return future(scene, rules, state, stop, gauge, np.zeros(5), worst) == TOUCHED


@njit(cache=True, nogil=True)
def search(scene, rules, state, stop_from, n, buffers, bounded):
    """Scores the admissible of ``n`` samples by Eq. 9 and returns the best, or -1.

    Where a command does not rest in time before moving obstacles by their hard bound, a manoeuvre
    that begins with it is admissible only if it is clear of them, as they are expected to go on, for
    as long as a stop takes: from whatever comes later the robot can still be at rest. Where nothing
    is admissible and a stop would end in the way of a moving obstacle, unseen space refuses nothing.

    Two more candidates are written behind the samples: what the manoeuvre chosen last would do now
    (n), looked at first, and following the cost-to-go at once (n + 1). Every change from the former
    has to be worth something. ``buffers`` are samples, commands (n + 2, 2), holds in seconds and tails
    (n + 2,), terms (n + 2, 5), refusals and scores (n + 2,). Where it is not ``bounded``, candidates
    that cannot be the best are rolled out to their end, too. Stops are certified from the speeds
    ``stop_from`` (v, omega).
    """
    limits, span = rules.limits, rules.span
    pose, v, _ = state
    begin = pose_value(scene.cost_to_go, limits, pose, v)
    between = span.step * (span.horizon_steps // LOOKS)
    most = 0.0
    for look in range(1, LOOKS + 1):
        most += min(farthest(max(v, 0.0), limits, look * between), begin) / LOOKS
    scale = (begin, max(most, LEAST))
    prepare(scene, rules, state, stop_from, n, buffers)
    best = best_of(scene, rules, state, (n, bounded), buffers, scale, False)
    if best < 0 and stops_in_the_way(scene, rules, state, scale):
        best = best_of(scene, rules, state, (n, bounded), buffers, scale, True)
    return best
