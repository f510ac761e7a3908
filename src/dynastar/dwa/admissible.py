"""Which commands are admissible: those with a certified stop, the general form of Eq. 7."""

import math

import numpy as np

from dynastar.compiled import inner
from dynastar.dwa.clearance import clearance_slack
from dynastar.dwa.motion import driven, moved, stopping_time

ADMISSIBLE, NO_STOP, MOVING, HIDDEN = range(4)
CHECK_PERIOD = 0.1  # s between two checks for moving obstacles during a stop
ROUNDING = 1e-6  # m of clearance that rounding may take


@inner
def keeps_clear(field, body, margin, start, pose, arc):
    """Whether the footprint keeps the constraint of ``clearance_slack`` along an arc from ``pose``.

    ``arc`` is (length in m, angle in rad). Conservative advancement: no point of the footprint moves
    further than |length| + R |angle|, so the slack at a pose covers the stretch after it.
    """
    length, angle = arc
    sweep = abs(length) + body.circumscribed * abs(angle)
    smallest = 0.25 * field.resolution
    fraction = 0.0
    slack = clearance_slack(field, body, margin, start, pose)
    while -ROUNDING <= slack < (1.0 - fraction) * sweep and sweep > 0.0 and fraction < 1.0:
        fraction = min(1.0, fraction + max(slack, smallest) / sweep)
        at = moved(pose, fraction * length, fraction * angle)
        slack = clearance_slack(field, body, margin, start, at)
    return slack >= -ROUNDING


@inner
def certified_stop(scene, rules, state, command):
    """ADMISSIBLE if the robot can come to rest in observed-free space after a period of ``command``.

    Over the period each speed changes at its own limit; then both ramp to zero in proportion, along
    one arc. ``state`` is that in which the command begins to act.
    """
    field, margin = scene.distance_to_unknown, scene.margin_to_unknown
    body, limits, start = rules.body, rules.limits, state.pose
    (v, omega), half = command, 0.5 * rules.period
    for _ in range(2):
        after = driven(state, v, omega, limits, half)
        arc = 0.5 * half * (state.v + after.v), 0.5 * half * (state.omega + after.omega)
        if not keeps_clear(field, body, margin, start, state.pose, arc):
            return NO_STOP
        state = after
    half_stop = 0.5 * stopping_time(state.v, state.omega, limits)
    arc = half_stop * state.v, half_stop * state.omega
    if not keeps_clear(field, body, margin, start, state.pose, arc):
        return NO_STOP
    return ADMISSIBLE


@inner
def rests_in_time(scene, rules, state, command):
    """ADMISSIBLE if the robot is at rest before any moving obstacle can touch it.

    A track is somewhere in the disc round its constant-velocity prediction that its acceleration
    lets it reach; a person may step out of unseen space at ``hidden.speed``. Where rest does not keep
    clear of that, the robot may move if it comes no nearer than at rest.
    """
    (v, omega), limits, start, hidden = command, rules.limits, state.pose, scene.hidden
    gap_at_start = hidden_gap(hidden, start.x, start.y) - rules.body.circumscribed
    after = driven(state, v, omega, limits, rules.period)
    stop = stopping_time(after.v, after.omega, limits)
    if stop <= 0.0 and state.v == 0.0 and state.omega == 0.0:
        return ADMISSIBLE  # it stays at rest
    duration = rules.period + stop
    checks = max(2, int(math.ceil(duration / CHECK_PERIOD)))
    for k in range(1, checks + 1):
        t = duration * k / checks
        if t <= rules.period:
            pose = driven(state, v, omega, limits, t).pose
        else:
            left = 1.0 - (t - rules.period) / max(stop, 1e-9)
            done = 0.5 * stop * (1.0 - left * left)
            pose = moved(after.pose, after.v * done, after.omega * done)
        if hidden.speed > 0.0:
            gap = hidden_gap(hidden, pose.x, pose.y) - rules.body.circumscribed
            need = hidden.speed * t - hidden.slack
            if gap < need and (gap < gap_at_start - 1e-3 or gap_at_start > need):
                return HIDDEN
        if reaches(scene.moving, start, pose, scene.latency + t, rules.body.circumscribed):
            return MOVING
    return ADMISSIBLE


@inner
def reaches(moving, start, pose, t, radius):
    """Whether a moving obstacle can touch a disc of ``radius`` (m) at ``pose`` in ``t`` seconds.

    By the hard bound, and only if the disc is nearer to its expected position than at ``start``.
    """
    bound = moving.error + 0.5 * moving.acceleration * t * t
    for m in range(len(moving.obstacles)):
        obstacle = moving.obstacles[m]
        x, y = obstacle.x + obstacle.vx * t, obstacle.y + obstacle.vy * t
        near = radius + obstacle.radius
        square = (x - pose.x) ** 2 + (y - pose.y) ** 2
        if square < (near + bound) ** 2:
            at_rest = (x - start.x) ** 2 + (y - start.y) ** 2
            if square < near * near or square < at_rest - 1e-3:
                return True
    return False


@inner
def hidden_gap(hidden, x, y):
    """Metres from a point to the nearest body that unseen space may hold, 0 off the field."""
    field = hidden.distance
    rows, columns = field.values.shape
    column, row = int((x - field.x0) / field.resolution), int((y - field.y0) / field.resolution)
    if x < field.x0 or y < field.y0 or row >= rows or column >= columns:
        return 0.0
    return field.values[np.uint64(row), np.uint64(column)] - hidden.radius
