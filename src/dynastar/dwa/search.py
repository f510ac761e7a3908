"""The search over the window: every sample's futures are rolled out and scored, the best is taken.

A future holds the sample for a short or a long time; then the robot follows the cost-to-go, stops,
or backs off. Risk is looked for up to the horizon; progress is the mean of what the cost-to-go has
fallen by after the shorter hold and after a longer time, so that to put it off costs something.
"""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.admissible import ADMISSIBLE, certified_stop, rests_in_time
from dynastar.dwa.clearance import distance_at
from dynastar.dwa.cost_to_go import bearing_at, value_at
from dynastar.dwa.motion import driven, slew
from dynastar.dwa.objective import dist, note_risk, objective, progress, risk, vel

HEADING, DIST, VEL, SIMI, RISK = range(5)
FOLLOW, STOP, BACK = range(3)
SLACK = (
    0.02  # m that a roll-out may come nearer to an obstacle than the robot is, inside the margin
)
OVERSHOOT = 0.25  # m that the robot may stop beyond the end of its path
TURN_COST = 1.0  # of the way that would be driven in the time that turning to the descent takes
BEST_GAIN = 2.0  # decrease of the cost-to-go over a metre, at most, for what is worth looking at


@njit(cache=True)
def least_clearance(field, body, pose):
    """Metres from the footprint's probes to the nearest obstacle's centre; exact where it matters."""
    d = distance_at(field, pose[0], pose[1])
    if d - body.circumscribed > 0.3:
        return d - body.circumscribed
    least = d - body.inscribed
    for i in range(1, len(body.probes)):
        dx, dy, radius = body.probes[i]
        x, y = pose[0] + pose[2] * dx - pose[3] * dy, pose[1] + pose[3] * dx + pose[2] * dy
        least = min(least, distance_at(field, x, y) - radius)
    return least


@njit(cache=True)
def turn_to_descent(field, pose):
    """Angle (rad, -pi to pi) from the heading of a pose to where the cost-to-go falls."""
    off = bearing_at(field, pose[0], pose[1]) - math.atan2(pose[3], pose[2])
    return off - math.tau * math.floor(off / math.tau + 0.5)


@njit(cache=True)
def pose_value(field, limits, pose, v):
    """The cost-to-go (m) of a pose and speed: its place's, turning and overshooting."""
    left = value_at(field, pose[0], pose[1])
    turning = limits.v_max * abs(turn_to_descent(field, pose)) / limits.omega_max
    too_far = max(0.0, 0.5 * v * v / limits.v_brake - max(left, 0.0) - OVERSHOOT)
    return left + TURN_COST * turning + too_far


@njit(cache=True)
def follow(scene, limits, comfort, pose, clear):
    """Speeds that follow the descent of the cost-to-go from a pose with clearance ``clear`` (m)."""
    off = turn_to_descent(scene.cost_to_go, pose)
    wanted_omega = min(max(3.0 * off, -limits.omega_max), limits.omega_max)
    wanted_v = limits.v_max * max(0.0, 1.0 - 1.5 * abs(off))
    wanted_v *= min(1.0, max(0.2, clear / comfort))
    left = max(value_at(scene.cost_to_go, pose[0], pose[1]), 0.0)
    return min(wanted_v, math.sqrt(1.6 * limits.v_brake * left)), wanted_omega


@njit(cache=True)
def future(
    scene, body, limits, span, weights, state, sample, held, tail, begin, enough, terms, worst
):
    """Writes the terms of a sample that is held for ``held`` steps, and then followed by a tail.

    False at contact within the shorter arc, and once it can no longer score more than ``enough``.
    ``begin`` is the cost-to-go now, ``worst`` (m, hypotheses) room for the risk.
    """
    pose, v, omega = state
    gap = least_clearance(scene.obstacles, body, pose) - scene.margin
    need = min(0.0, gap) - SLACK
    scale = 0.5 * limits.v_max * span.step * (span.steps + span.value_steps)
    most = limits.v_max * span.step * BEST_GAIN
    people = len(scene.people.now) > 0
    worst[:] = 0.0
    clear, soon, late = gap, 0.0, 0.0
    blocked = False
    last = span.horizon_steps if people else span.value_steps
    k = 0
    while k < last:
        stride = 1 if k < span.value_steps else 2
        wanted_v, wanted_omega = 0.0, 0.0
        if k < held:
            wanted_v, wanted_omega = sample[0], sample[1]
        elif tail == FOLLOW:
            wanted_v, wanted_omega = follow(scene, limits, span.comfort, pose, gap)
        elif tail == BACK:
            wanted_v = limits.v_min
        if not blocked and (v != 0.0 or omega != 0.0 or wanted_v != 0.0 or wanted_omega != 0.0):
            duration = span.step * stride
            pose, v, omega = driven(pose, v, omega, wanted_v, wanted_omega, limits, duration)
            gap = least_clearance(scene.obstacles, body, pose) - scene.margin
            if gap < need:
                if k < span.steps:
                    return False
                blocked = True
        if k < span.steps:
            clear = min(clear, gap)
        k += stride
        if people:
            t = k * span.step
            note_risk(scene.people, k - 1, t, pose[0], pose[1], span.risk_radius, worst)
        if k == span.steps or k == held or k == span.value_steps or k % 8 == 0:
            here = pose_value(scene.cost_to_go, limits, pose, v)
            if k == span.steps:
                soon = here
            if k == span.value_steps:
                late = here
            at_best = late if k >= span.value_steps else here - most * (span.value_steps - k)
            terms[HEADING] = progress(begin, 0.5 * (soon + at_best), scale)
            terms[DIST], terms[VEL], terms[SIMI] = 1.0, vel(sample[0], limits.v_max), 0.0
            terms[RISK] = risk(scene.people, worst)
            if k >= span.steps and objective(weights, terms) < enough:
                return False
    terms[HEADING] = progress(begin, 0.5 * (soon + late), scale)
    terms[DIST] = dist(clear, span.comfort)
    terms[RISK] = risk(scene.people, worst)
    return True


@njit(cache=True)
def worth_holding(sample, limits, tail, long, people):
    """Whether a future of that kind tells anything: long holds and other tails matter among people."""
    if not people and tail != FOLLOW:
        return False
    if tail == BACK and (long or limits.v_min >= 0.0):
        return False
    return not (long and (abs(sample[0]) < 0.1 * limits.v_max or abs(sample[1]) > 2.0))


@njit(cache=True)
def search(scene, body, limits, span, weights, state, n, buffers, period):
    """Scores the admissible of ``n`` samples by Eq. 9 and returns the best, or -1.

    ``buffers`` are samples and commands (n + 1, 2), terms (n + 1, 5), refusals and scores (n + 1,).
    The last choice is looked at first, and every change from it has to be worth something.
    """
    samples, commands, terms, refused, score = buffers
    _, v, omega = state
    worst = np.zeros((len(scene.people.now), scene.people.mean.shape[1]))
    found = np.zeros(5)
    begin = pose_value(scene.cost_to_go, limits, state[0], v)
    people = len(scene.people.now) > 0
    best, best_score = -1, -np.inf
    samples[n, 0], samples[n, 1] = scene.last_v, scene.last_omega
    for j in range(n + 1):
        i = n - j
        score[i] = -np.inf
        sample = (samples[i, 0], samples[i, 1])
        commands[i, 0] = slew(v, sample[0], limits.v_accel, limits.v_brake, period)
        commands[i, 1] = slew(omega, sample[1], limits.omega_accel, limits.omega_brake, period)
        command = (commands[i, 0], commands[i, 1])
        refused[i] = certified_stop(scene, body, limits, state, command, period)
        if refused[i] == ADMISSIBLE:
            refused[i] = rests_in_time(scene, body, limits, state, command, period)
        if refused[i] != ADMISSIBLE:
            continue
        change = abs(sample[0] - scene.last_v) / limits.v_max
        change = span.hysteresis * (change + abs(sample[1] - scene.last_omega) / limits.omega_max)
        for kind in range(6):
            tail, long = kind % 3, kind >= 3
            if not worth_holding(sample, limits, tail, long, people):
                continue
            held = span.long_steps if long else span.steps
            enough = max(best_score, score[i]) + change
            if future(
                scene, body, limits, span, weights, state, sample, held, tail, begin, enough, found,
                worst,
            ):  # fmt: skip
                total = objective(weights, found) - change
                if total > score[i]:
                    score[i] = total
                    terms[i] = found
        if score[i] > best_score:
            best, best_score = i, score[i]
    return best
