"""What a manoeuvre would lead to: rolled out, with its terms of Eq. 9.

It holds a sample for a while; then the robot follows the cost-to-go, stops, or backs off. Progress
is the mean of what the cost-to-go has fallen by at times along it, so that to put it off costs
something; risk is looked for up to the horizon.
"""

import math

from dynastar.compiled import njit
from dynastar.dwa.clearance import distance_at
from dynastar.dwa.cost_to_go import direction_at, value_at
from dynastar.dwa.motion import driven
from dynastar.dwa.objective import (
    dist,
    note_risk,
    objective,
    progress,
    risk,
    simi,
    vel,
)
from dynastar.dwa.scene import BACK, FOLLOW

HEADING, DIST, VEL, SIMI, RISK = range(5)
SCORED, DROPPED, TOUCHED = range(3)
SLACK = (
    0.02  # m that a roll-out may come nearer to an obstacle than the robot is, inside the margin
)
OVERSHOOT = 0.25  # m that the robot may stop beyond the end of its path
STRAY = 1.0  # m from the path that make it no path any more
LOOKS = 8  # times at which the cost-to-go is looked up along a roll-out
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
def turn_to_descent(field, pose, ahead):
    """Angle (rad, -pi to pi) from a pose's heading to where the cost-to-go falls ``ahead`` m of it."""
    ux, uy = direction_at(field, pose[0] + ahead * pose[2], pose[1] + ahead * pose[3])
    return math.atan2(pose[2] * uy - pose[3] * ux, pose[2] * ux + pose[3] * uy)


@njit(cache=True)
def pose_value(field, limits, pose, v):
    """The cost-to-go (m) of a pose and speed: its place's, the curve to its descent, overshooting.

    A curve of radius r that turns by an angle a gets r sin a ahead on a way of r a. It doubles what
    is left at most: near its goal the robot backs or turns on the spot.
    """
    left = value_at(field, pose[0], pose[1])
    off = abs(turn_to_descent(field, pose, 0.0))
    curve = (off - math.sin(off)) * limits.v_max / limits.omega_max
    too_far = max(0.0, 0.5 * v * v / limits.v_brake - max(left, 0.0) - OVERSHOOT)
    return left + min(curve, max(left, 0.0)) + too_far


@njit(cache=True)
def farthest(v, limits, t):
    """Metres that can be driven in ``t`` seconds from a speed ``v``."""
    to_full = max(0.0, limits.v_max - v) / limits.v_accel
    speeding = min(t, to_full)
    return (v + 0.5 * limits.v_accel * speeding) * speeding + limits.v_max * (t - speeding)


@njit(cache=True)
def follow(field, limits, comfort, pose, v, clear):
    """Speeds that follow the descent of the cost-to-go from a pose with clearance ``clear`` (m).

    The robot steers by the descent where it will be once its turning rate has changed, and slows
    down for the bend where it could stop.
    """
    off = turn_to_descent(field, pose, 0.5 * v * limits.omega_max / limits.omega_accel)
    bend = turn_to_descent(field, pose, 0.5 * v * abs(v) / limits.v_brake)
    rate = min(limits.omega_max, 3.0 * abs(off), math.sqrt(1.6 * limits.omega_brake * abs(off)))
    wanted_v = limits.v_max * max(0.0, 1.0 - 1.5 * max(abs(off), abs(bend)))
    wanted_v *= min(1.0, max(0.2, clear / comfort))
    left = max(value_at(field, pose[0], pose[1]), 0.0)
    return min(wanted_v, math.sqrt(1.6 * limits.v_brake * left)), math.copysign(rate, off)


@njit(cache=True)
def tail_speeds(field, limits, comfort, pose, v, clear, tail):
    """The speeds that a tail asks for at a pose."""
    if tail == FOLLOW:
        return follow(field, limits, comfort, pose, v, clear)
    if tail == BACK:
        return limits.v_min, 0.0
    return 0.0, 0.0


@njit(cache=True)
def touches(people, k, x, y, radius):
    """Whether a disc of ``radius`` (m) at (x, y) may touch an unaccelerated obstacle at step ``k``."""
    for m in range(len(people.now)):
        dx, dy = people.mean[m, 0, k, 0] - x, people.mean[m, 0, k, 1] - y
        near = radius + people.now[m, 4] + people.now[m, 5]
        if dx * dx + dy * dy < near * near:
            return True
    return False


@njit(cache=True, inline="always")
def weights_of(rules, scene):
    """The weights of Eq. 9; a path that was given is kept to by at least ``scene.sigma``."""
    alpha, beta, gamma, sigma, rho = rules.weights
    return alpha, beta, gamma, max(sigma, scene.sigma), rho


@njit(cache=True)
def within(field, x, y):
    """Whether a point lies where the cost-to-go is known: inside the local map but for its rim."""
    rows, columns = field.value.shape
    c, r = (x - field.x0) / field.resolution, (y - field.y0) / field.resolution
    return 2.0 <= c <= columns - 2.0 and 2.0 <= r <= rows - 2.0


@njit(cache=True)
def future(scene, rules, state, manoeuvre, gauge, terms, worst):
    """Writes the terms of a manoeuvre, and returns SCORED, DROPPED or TOUCHED.

    ``manoeuvre`` is (v, omega, held steps, tail, how long it has to be clear of everybody (s));
    ``gauge`` is (the cost-to-go now, the most progress that could be made (m), the least score that
    is of interest); ``worst`` (m, hypotheses) is room for the risk. DROPPED at contact while the
    sample is held, and where it can no longer score enough. Beyond the local map the cost-to-go is
    taken to go on falling as it fell last.
    """
    body, limits, span = rules.body, rules.limits, rules.span
    weights = weights_of(rules, scene)
    asked_v, asked_omega, held, tail, clear_for = manoeuvre
    begin, scale, enough = gauge
    field, obstacles, margin, people = scene.cost_to_go, scene.obstacles, scene.margin, scene.people
    pose, v, omega = state
    gap = least_clearance(obstacles, body, pose) - margin
    need = min(0.0, gap) - SLACK
    between = span.horizon_steps // LOOKS
    most = BEST_GAIN * limits.v_max * span.step * between
    among_people = len(people.now) > 0
    worst[:] = 0.0
    clear, gained, here, fell, looks = gap, 0.0, begin, 0.0, 0
    terms[DIST], terms[VEL], terms[SIMI] = 1.0, vel(asked_v, limits.v_max), 1.0
    strayed = 0.0
    blocked = gone = False
    last = span.horizon_steps
    k = 0
    while k < last:
        stride = 1 if k < span.steps else min(2, last - k)
        wanted_v, wanted_omega = asked_v, asked_omega
        if k >= held:
            wanted_v, wanted_omega = tail_speeds(field, limits, span.comfort, pose, v, gap, tail)
        moves = v != 0.0 or omega != 0.0 or wanted_v != 0.0 or wanted_omega != 0.0
        if moves and not blocked and not gone:
            duration = span.step * stride
            pose, v, omega = driven(pose, v, omega, wanted_v, wanted_omega, limits, duration)
            gone = not within(field, pose[0], pose[1])
            gap = least_clearance(obstacles, body, pose) - margin
            if gap < need and not gone:
                if k < span.steps:
                    return DROPPED
                blocked = True
        if k < span.steps:
            clear = min(clear, gap)
        k += stride
        if among_people:
            t = k * span.step
            if t <= clear_for and touches(people, k - 1, pose[0], pose[1], body.circumscribed):
                return TOUCHED
            note_risk(people, k - 1, t, pose[0], pose[1], span.risk_radius, worst)
        if k == span.steps:
            terms[DIST] = dist(clear, span.comfort)
        if looks < LOOKS and k >= (looks + 1) * between:
            looks += 1
            if not gone:
                before, here = here, pose_value(field, limits, pose, v)
                fell = before - here
            else:
                here -= fell
            gained += begin - here
            if weights[SIMI] > 0.0:
                strayed += min(distance_at(scene.path, pose[0], pose[1]), STRAY) / LOOKS
                terms[SIMI] = simi(strayed, STRAY)
            left = LOOKS - looks
            at_best = gained + left * (begin - here) + 0.5 * left * (left + 1) * most
            terms[HEADING] = progress(at_best, LOOKS * scale)
            terms[RISK] = risk(people, worst)
            if objective(weights, terms) < enough:
                return DROPPED
        elif among_people and k % 8 == 0:
            terms[RISK] = risk(people, worst)
            if objective(weights, terms) < enough:
                return DROPPED
    terms[HEADING] = progress(gained, LOOKS * scale)
    terms[RISK] = risk(people, worst)
    return SCORED
