"""The classic dynamic window: a sample is held on one arc to the end (Eqs. 4 and 6 to 9).

``ArcsConfig`` says what is read as in print: the motion, the admissible speeds, dist, normalisation.
"""

import math
from typing import NamedTuple

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.admissible import ADMISSIBLE, NO_STOP, admissible_speed
from dynastar.dwa.clearance import distance_at
from dynastar.dwa.motion import moved, moved_straight, slew, stopping_time
from dynastar.dwa.objective import dist, note_risk, objective, progress, risk, simi, vel
from dynastar.dwa.rollout import (
    DIST,
    HEADING,
    RISK,
    SIMI,
    STRAY,
    VEL,
    bearing_term,
    farthest,
    least_clearance,
    pose_value,
    weights_of,
    within,
)
from dynastar.dwa.search import refusal


class Arcs(NamedTuple):
    """``ArcsConfig`` as the kernels take it; arcs are ``steps`` of ``Span.step`` long."""

    steps: int
    printed_motion: bool
    printed_stop: bool
    end_dist: bool
    by_sums: bool


@njit(cache=True)
def first_contact(scene, rules, arcs, pose, sample, terms, worst):
    """Metres and radians along an arc to first contact, inf if there is none; writes its terms.

    The terms are those of ``arcs.steps`` or up to a contact, which is looked for as far as the robot
    takes to stop. In print a robot touches what its footprint touches; else ``margin`` is kept.
    """
    span, body, people, field = rules.span, rules.body, scene.people, scene.cost_to_go
    v, omega = sample
    half_diagonal = scene.obstacles.resolution / math.sqrt(2.0)
    margin = half_diagonal if arcs.printed_stop else scene.margin
    begin = pose_value(field, rules.limits, pose, v)
    gap = least = least_clearance(scene.obstacles, body, pose) - margin
    strayed = 0.0
    length = angle = np.inf
    worst[:] = 0.0
    end, at_end = pose, gap
    stop = stopping_time(v, omega, rules.limits)
    for k in range(max(arcs.steps, int(math.ceil(0.5 * stop / span.step)))):
        if arcs.printed_motion:
            pose = moved_straight(pose, v * span.step, omega * span.step)
        else:
            pose = moved(pose, v * span.step, omega * span.step)
        if not within(field, pose[0], pose[1]):
            break
        gap = least_clearance(scene.obstacles, body, pose) - margin
        if k < arcs.steps:
            end, at_end, least = pose, gap, min(least, gap)
            strayed += min(distance_at(scene.path, pose[0], pose[1]), STRAY) / arcs.steps
            t = (k + 1) * span.step
            note_risk(people, k, t, pose[0], pose[1], span.risk_radius, worst)
        if gap < 0.0:
            length, angle = abs(v) * k * span.step, abs(omega) * k * span.step
            break
    if rules.by_bearing:
        terms[HEADING] = bearing_term(scene.target, end)
    else:
        most = min(farthest(max(v, 0.0), rules.limits, arcs.steps * span.step), begin)
        gained = begin - pose_value(field, rules.limits, end, v)
        terms[HEADING] = progress(gained, max(most, span.step * rules.limits.v_max))
    terms[DIST] = dist(max(at_end, 0.0) if arcs.end_dist else least, span.comfort)
    terms[VEL] = vel(v, rules.limits.v_max)
    terms[SIMI] = simi(strayed, STRAY)
    terms[RISK] = risk(people, worst)
    return length, angle


@njit(cache=True)
def search_arcs(scene, rules, arcs, state, stop_from, n, buffers):
    """Scores the admissible of ``n`` samples by Eq. 9 and returns the best, or -1.

    ``buffers`` as in ``search``.
    """
    limits, weights = rules.limits, weights_of(rules, scene)
    samples, commands, holds, tails, terms, refused, score = buffers
    pose, v, omega = state
    worst = np.zeros((len(scene.people.now), scene.people.mean.shape[1]))
    holds[:n] = arcs.steps * rules.span.step
    tails[:n] = 0
    score[:n] = -np.inf
    sums = np.zeros(5)
    for i in range(n):
        sample = (samples[i, 0], samples[i, 1])
        commands[i, 0] = slew(v, sample[0], limits.v_accel, limits.v_brake, rules.period)
        commands[i, 1] = slew(
            omega, sample[1], limits.omega_accel, limits.omega_brake, rules.period
        )
        refused[i] = ADMISSIBLE
        if not arcs.printed_stop:
            refused[i] = refusal(
                scene, rules, (pose, stop_from[0], stop_from[1]), (commands[i, 0], commands[i, 1])
            )
            if refused[i] != ADMISSIBLE:
                continue
        length, angle = first_contact(scene, rules, arcs, pose, sample, terms[i], worst)
        if arcs.printed_stop and (
            abs(sample[0]) > admissible_speed(length, limits.v_brake)
            or abs(sample[1]) > admissible_speed(angle, limits.omega_brake)
        ):
            refused[i] = NO_STOP
            continue
        score[i] = objective(weights, terms[i])
        sums += terms[i]
    if arcs.by_sums:
        for i in range(n):
            if refused[i] == ADMISSIBLE:
                for term in range(RISK):
                    if sums[term] > 0.0:
                        terms[i, term] /= sums[term]
                score[i] = objective(weights, terms[i])
    best = int(np.argmax(score[:n]))
    return best if score[best] > -np.inf else -1
