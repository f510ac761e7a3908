"""The search over the window: every candidate's manoeuvres are rolled out, the best one is taken.

A candidate's speeds are held for a while; then the robot follows the cost-to-go, brakes to rest, or
reverses. Two candidates stand before the samples of the window: the rest of the manoeuvre chosen
last, and following the cost-to-go at once.
"""

import numpy as np

from dynastar.compiled import allocating, inner, njit
from dynastar.dwa.admissible import (
    ADMISSIBLE,
    HIDDEN,
    MOVING,
    NO_STOP,
    rests_in_time,
    stops_are_certified,
)
from dynastar.dwa.clearance import least_clearance
from dynastar.dwa.motion import command_towards, driveable_sample, state_of, stopping_time
from dynastar.dwa.rollout import Start, roll_out, tail_speeds, write
from dynastar.dwa.scene import AT_REST, BACK, FOLLOW, TAILS, Manoeuvre
from dynastar.dwa.terms import Terms, evaluate, most_progress, objective, passes_clear, state_value
from dynastar.dwa.window import possible, reachable, spaced

LAST, FOLLOW_NOW, SAMPLES = range(3)  # the first two candidates, and the first sample
SLOW = 0.1  # of v_max, up to which a speed is not held for long
SHARP = 2.0  # rad/s, from which on a turning rate is not held for long
CANDIDATE = np.dtype(
    [(name, np.float64) for name in ("v", "omega", "command_v", "command_omega", "hold", "score")]
    + [(name, np.float64) for name in Terms._fields]
    + [("tail", np.int64), ("refused", np.int64)]
)


@njit(cache=True, nogil=True)
def search(scene, rules, state, stops_from, candidates, rows):
    """Fill ``candidates`` and score them by Eq. 9; returns how many there are, and the best or -1.

    The best is the first in the order of scores with a certified stop from each of the STOP_START
    records ``stops_from``: a certificate takes longer than a score, so those below are not certified.
    Where a command does not rest in time before moving obstacles by their hard bound, a manoeuvre that
    begins with it is admissible only if it is clear of them, as they are expected to go on, for as long
    as a stop takes: from whatever comes later the robot can still be at rest. Where it does not rest in
    time before a person who steps out of unseen space, the manoeuvre has to be clear of all moving
    obstacles up to the horizon, and a stop has to end in the way of one: a person who is there counts
    for more than one who may be. ``rows`` is room for a roll-out.
    """
    gap = least_clearance(scene.distance_to_obstacle, rules.body, state.pose) - scene.margin
    write(rows[0], state, gap, True)
    here = state_value(scene.cost_to_go, rules.limits, rows[0], state.v)
    start = Start(state, gap, here, most_progress(rules, state.v, here))
    n = fill_candidates(scene, rules, start, candidates)
    in_the_way = stops_in_the_way(scene, rules, start, rows)
    at_latest, scores = state_of(stops_from[-1]), candidates[:n]["score"]
    for i in range(n):
        candidate = candidates[i]
        command = candidate.command_v, candidate.command_omega
        candidate.refused = rests_in_time(scene.around, rules, at_latest, command)
        candidate.score = -np.inf
        if candidate.refused != HIDDEN or in_the_way:
            score(scene, rules, start, i, candidate, rows)
    while True:
        best = scores.argmax()
        if scores[best] == -np.inf:
            return n, -1
        command = candidates[best].command_v, candidates[best].command_omega
        if stops_are_certified(scene.around, rules, stops_from, command):
            return n, best
        candidates[best].refused, scores[best] = NO_STOP, -np.inf


@inner
def stops_in_the_way(scene, rules, start, rows):
    """Whether a moving obstacle that goes on as expected would touch the robot if it stopped now."""
    moving = scene.around.moving
    if len(moving.obstacles) == 0:
        return False
    roll_out(scene, rules, start, AT_REST, rows)
    return not passes_clear(moving, rules, rows, np.inf)


@allocating
def fill_candidates(scene, rules, start, candidates):
    """Write speeds, holds and the commands of one period; returns the number of candidates."""
    limits, config, last, state = rules.limits, rules.config, scene.last, start.state
    speeds = possible(limits, min(scene.v_cap, limits.v_max))
    window = reachable(state, limits, speeds, max(rules.period, config.reach))
    rates, n = spaced(window.low_omega, window.high_omega, config.omega_samples), SAMPLES
    for v in spaced(window.low_v, window.high_v, config.v_samples):
        for omega in rates:
            candidates[n].v, candidates[n].omega = v, omega
            candidates[n].hold = rules.schedule.held * rules.schedule.period
            n += 1
    v, omega = last.v, last.omega
    if last.hold < 0.5 * rules.schedule.period:
        v, omega = tail_speeds(scene.cost_to_go, rules, state, start.gap, last.tail)
    candidates[LAST].v, candidates[LAST].omega, candidates[LAST].hold = v, omega, last.hold
    v, omega = tail_speeds(scene.cost_to_go, rules, state, start.gap, FOLLOW)
    candidates[FOLLOW_NOW].v, candidates[FOLLOW_NOW].omega = v, omega
    candidates[FOLLOW_NOW].hold = rules.schedule.period
    for candidate in candidates[:n]:
        v, omega = min(max(candidate.v, window.low_v), window.high_v), candidate.omega
        v = driveable_sample(v, limits.v_least, speeds.low_v, speeds.high_v)
        omega = driveable_sample(omega, limits.omega_least, speeds.low_omega, speeds.high_omega)
        candidate.v, candidate.omega = v, omega
        command = command_towards(rules, (state.v, state.omega), (v, omega))
        candidate.command_v, candidate.command_omega = command
    return n


@inner
def is_considered(i, candidate, tail, long, scene, limits):
    """Whether a candidate is rolled out with a tail, and held for the ``long`` time.

    A long hold is considered only from a tenth of v_max on, and up to 2 rad/s.
    """
    if i == LAST:
        return tail == scene.last.tail and not long
    if i == FOLLOW_NOW:
        return tail == FOLLOW and not long
    if tail == BACK and (long or limits.v_min >= 0.0):
        return False
    return not long or (abs(candidate.v) >= SLOW * limits.v_max and abs(candidate.omega) <= SHARP)


@inner
def score(scene, rules, start, i, candidate, rows):
    """Write the terms, the tail and the score of the candidate's best manoeuvre.

    Every change from the manoeuvre chosen last has to be worth ``hysteresis``. Where following the
    cost-to-go after the sample risks nothing, no other tail is rolled out.
    """
    clear_for = 0.0
    if candidate.refused == MOVING:
        clear_for = scene.around.latency + rules.period
        clear_for += stopping_time(candidate.command_v, candidate.command_omega, rules.limits)
    elif candidate.refused == HIDDEN:
        clear_for = np.inf
    change = 0.0 if i == LAST else rules.config.hysteresis
    short_hold, risked = candidate.hold, True
    for kind in range(2 * len(TAILS)):
        tail, long = kind % len(TAILS), kind >= len(TAILS)
        if tail == FOLLOW:
            risked = True
        elif not risked:
            continue
        if not is_considered(i, candidate, tail, long, scene, rules.limits):
            continue
        hold = rules.long_hold if long else short_hold
        manoeuvre = Manoeuvre(candidate.v, candidate.omega, hold, tail)
        roll_out(scene, rules, start, manoeuvre, rows)
        if clear_for > 0.0 and not passes_clear(scene.around.moving, rules, rows, clear_for):
            continue
        candidate.refused = ADMISSIBLE
        terms = evaluate(scene, rules, start, manoeuvre, rows)
        total = objective(scene, rules, terms) - change
        if tail == FOLLOW:
            risked = terms.risk > 0.0
        if total > candidate.score:
            candidate.score, candidate.tail, candidate.hold = total, tail, hold
            candidate.heading, candidate.dist, candidate.vel = terms.heading, terms.dist, terms.vel
            candidate.simi, candidate.risk, candidate.nearness = (
                terms.simi,
                terms.risk,
                terms.nearness,
            )
