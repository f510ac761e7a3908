"""The terms of Eq. 9, each a function of a rolled-out trajectory, and their sum.

To add a term: write it here, name it in ``Terms``, ``evaluate`` and ``objective``, give it a weight in
``Weights``, and copy it in ``search.score``; see docs/architecture.md.
"""

import math
from typing import NamedTuple

from dynastar.compiled import inner
from dynastar.dwa.clearance import distance_at
from dynastar.guidance.cost_to_go import turn_to_descent, value_at
from dynastar.perception.prediction import CONTINUES, TRACKING_ERROR, WEIGHTS, contact_probability

LOOKUPS = 8  # times at which the cost-to-go is looked up along a roll-out
OVERSHOOT = 0.25  # m that the robot may stop beyond the end of its path
FAR_OFF = 1.0  # m from the path at which simi is 0
LEAST_PROGRESS = 0.1  # m of progress that counts in full, at least
DEVIATIONS = 3.0  # standard deviations from which on a contact is not possible


class Terms(NamedTuple):
    """The terms of Eq. 9 of one trajectory; ``risk`` and ``nearness`` count against it."""

    heading: float
    dist: float
    vel: float
    simi: float
    risk: float
    nearness: float


@inner
def evaluate(scene, rules, start, manoeuvre, rows):
    """Eq. 8, risk and nearness: the terms of a manoeuvre from its roll-out ``rows``."""
    return Terms(
        progress(scene.cost_to_go, rules, start, rows),
        dist(rules, start, rows),
        vel(rules, manoeuvre),
        simi(scene.distance_to_path, rules, rows) if sigma(scene, rules) > 0.0 else 1.0,
        risk(scene.around.moving, rules, rows),
        nearness(scene.around.moving, rules, rows),
    )


@inner
def objective(scene, rules, terms):
    """Eq. 9: G = alpha heading + beta dist + gamma vel + sigma simi - rho risk - nu nearness."""
    weights = rules.config.weights
    return (
        weights.heading * terms.heading
        + weights.dist * terms.dist
        + weights.vel * terms.vel
        + sigma(scene, rules) * terms.simi
        - weights.risk * terms.risk
        - weights.nearness * terms.nearness
    )


@inner
def sigma(scene, rules):
    """The weight of simi: that of the settings, and at least that of a path given by the user."""
    return max(rules.config.weights.simi, scene.path_weight)


@inner
def progress(cost_to_go, rules, start, rows):
    """Heading term: mean decrease of the cost-to-go at eight times, over what is possible at most.

    A mean penalises progress that is postponed. It is at least -1, so that being driven off near the
    goal is no worse than anywhere else. It has no upper bound: near obstacles the cost-to-go falls by
    more than a metre a metre, and bounded, all manoeuvres would score alike there. Beyond the local map
    the cost-to-go goes on falling as it fell last.
    """
    gained, here, fell = 0.0, start.cost_to_go, 0.0
    for i in rules.schedule.lookups:
        row = rows[i]
        if row.on_map:
            before, here = here, state_value(cost_to_go, rules.limits, row, row.v)
            fell = before - here
        else:
            here -= fell
        gained += start.cost_to_go - here
    return max(gained / (LOOKUPS * start.most), -1.0)


@inner
def dist(rules, start, rows):
    """Dist term: the least clearance (m) while the sample is held, up to ``comfort``, over that."""
    gap = start.gap
    for i in range(rules.schedule.held):
        gap = min(gap, rows[i].gap)
    return min(gap, rules.config.comfort) / rules.config.comfort


@inner
def vel(rules, manoeuvre):
    """Vel term: the speed that is held over the highest one."""
    return manoeuvre.v / rules.limits.v_max


@inner
def simi(distance_to_path, rules, rows):
    """Similarity to the global path: 1 - mean distance from it at eight times, up to 1 m."""
    off = 0.0
    for i in rules.schedule.lookups:
        off += min(distance_at(distance_to_path, rows[i].x, rows[i].y), FAR_OFF) / LOOKUPS
    return 1.0 - min(1.0, off / FAR_OFF)


@inner
def risk(moving, rules, rows):
    """Risk term: the highest discounted probability of contact of each hypothesis, weighted, summed."""
    total = 0.0
    for m, obstacle in enumerate(moving.obstacles):
        near = rules.risk_radius + obstacle.radius
        for h in range(len(WEIGHTS)):
            highest = 0.0
            for i in range(len(rows)):
                k = rules.schedule.step[i] - 1
                travel, deviation = moving.travel[h, k], moving.deviation[m, k]
                dx = obstacle.x + travel * obstacle.vx - rows[i].x
                dy = obstacle.y + travel * obstacle.vy - rows[i].y
                square, reach = dx * dx + dy * dy, near + DEVIATIONS * deviation
                if square < reach * reach:
                    p = contact_probability(math.sqrt(square) - near, deviation)
                    highest = max(highest, moving.discount[k] * p)
            total += WEIGHTS[h] * highest
    return total


@inner
def nearness(moving, rules, rows):
    """Nearness term: how far each moving obstacle comes into ``personal_space``, over that, summed.

    That is where it is expected, if it keeps its velocity, at its nearest, and discounted as risk is.
    """
    total, space = 0.0, rules.config.personal_space
    for obstacle in moving.obstacles:
        nearest, near = 0.0, rules.risk_radius + obstacle.radius
        for i in range(len(rows)):
            k = rules.schedule.step[i] - 1
            travel = moving.travel[CONTINUES, k]
            dx = obstacle.x + travel * obstacle.vx - rows[i].x
            dy = obstacle.y + travel * obstacle.vy - rows[i].y
            square, within = dx * dx + dy * dy, near + space
            if square < within * within:
                inside = min(1.0, (within - math.sqrt(square)) / space)
                nearest = max(nearest, moving.discount[k] * inside)
        total += nearest
    return total


@inner
def passes_clear(moving, rules, rows, duration):
    """Whether no moving obstacle that keeps its velocity may touch the robot for so long (s), or longer.

    That is until the first row at or after ``duration``.
    """
    for i in range(len(rows)):
        k = rules.schedule.step[i]
        travel = moving.travel[CONTINUES, k - 1]
        for obstacle in moving.obstacles:
            dx = obstacle.x + travel * obstacle.vx - rows[i].x
            dy = obstacle.y + travel * obstacle.vy - rows[i].y
            near = rules.body.circumscribed + obstacle.radius + TRACKING_ERROR
            if dx * dx + dy * dy < near * near:
                return False
        if k * rules.schedule.period >= duration:
            break
    return True


@inner
def state_value(cost_to_go, limits, at, v):
    """The cost-to-go (m) of a pose and speed: its place's, the curve to the descent, overshooting.

    A curve of radius r that turns by an angle a gets r sin a ahead on a way of r a. Near its goal, where
    the curve is longer than what is left, the robot backs or turns on the spot: the curve counts for at
    most twice what is left, and for more the longer it is. ``at`` has x, y, cos, sin.
    """
    value = value_at(cost_to_go, at.x, at.y)
    left = max(value, 0.0)
    off = abs(turn_to_descent(cost_to_go, at, 0.0))
    curve = (off - math.sin(off)) * limits.v_max / limits.omega_max
    turn = curve if curve <= left else left * (2.0 - left / curve)
    too_far = max(0.0, 0.5 * v * v / limits.v_brake - left - OVERSHOOT)
    return value + turn + too_far


@inner
def most_progress(rules, v, cost_to_go):
    """The most that a ``cost_to_go`` (m) can fall by on average over the look-ups, from speed ``v``."""
    most = 0.0
    between = rules.schedule.period * (rules.schedule.step[-1] // LOOKUPS)
    for look in range(1, LOOKUPS + 1):
        most += min(farthest(max(v, 0.0), rules.limits, look * between), cost_to_go) / LOOKUPS
    return max(most, LEAST_PROGRESS)


@inner
def farthest(v, limits, t):
    """Metres that can be driven in ``t`` seconds from a speed ``v``."""
    to_full = max(0.0, limits.v_max - v) / limits.v_accel
    speeding = min(t, to_full)
    return (v + 0.5 * limits.v_accel * speeding) * speeding + limits.v_max * (t - speeding)
