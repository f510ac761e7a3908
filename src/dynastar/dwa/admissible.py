"""Which commands are admissible: those behind which a stop is certified, which is more than Eq. 7."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.clearance import spare
from dynastar.dwa.motion import driven, moved, stopping_time

ADMISSIBLE, NO_STOP, MOVER, HIDDEN = range(4)
LOOK = 0.1  # s between the looks at moving obstacles during a stop


@njit(cache=True)
def clear_along(field, body, margin, start, pose, length, angle):
    """Whether the footprint keeps the rule of ``spare`` along an arc from ``pose``.

    Conservative advancement: no point of the footprint moves further than |length| + R |angle|, so
    what a pose has to spare vouches for the stretch after it.
    """
    sweep = abs(length) + body.circumscribed * abs(angle)
    smallest = 0.25 * field.resolution
    fraction = 0.0
    left = spare(field, body, margin, start, pose)
    if left < -1e-6:
        return False
    if sweep <= 0.0:
        return True
    while left < (1.0 - fraction) * sweep:
        fraction = min(1.0, fraction + max(left, smallest) / sweep)
        left = spare(field, body, margin, start, moved(pose, fraction * length, fraction * angle))
        if left < -1e-6:
            return False
        if fraction >= 1.0:
            break
    return True


@njit(cache=True)
def certified_stop(scene, body, limits, state, command, period):
    """ADMISSIBLE if the robot can come to rest in observed-free space after a period of ``command``.

    Over the period each speed changes at its own limit; then both ramp to zero in proportion, along
    one arc. ``state`` is (pose, v, omega) when the command begins to act.
    """
    start, v, omega = state
    pose = start
    for _ in range(2):
        before_v, before_w, before = v, omega, pose
        pose, v, omega = driven(pose, v, omega, command[0], command[1], limits, 0.5 * period)
        length = 0.25 * (before_v + v) * period
        angle = 0.25 * (before_w + omega) * period
        if not clear_along(scene.closed, body, scene.kept, start, before, length, angle):
            return NO_STOP
    stop = stopping_time(v, omega, limits)
    if not clear_along(
        scene.closed, body, scene.kept, start, pose, 0.5 * stop * v, 0.5 * stop * omega
    ):
        return NO_STOP
    return ADMISSIBLE


@njit(cache=True)
def rests_in_time(scene, body, limits, state, command, period):
    """ADMISSIBLE if the robot is at rest before any moving obstacle can touch it.

    A track is somewhere in the disc round its constant-velocity prediction that its acceleration
    lets it reach; a person may step out of unseen space at ``hidden_speed``. Where rest does
    not keep clear of that disc, the robot may move if it comes no nearer than at rest.
    """
    pose, v, omega = state
    people, hidden = scene.people, scene.hidden
    at_start = np.inf
    if hidden.speed > 0.0:
        at_start = hidden_gap(hidden, pose[0], pose[1]) - body.circumscribed
    before = pose
    pose, v, omega = driven(pose, v, omega, command[0], command[1], limits, period)
    stop = stopping_time(v, omega, limits)
    moves = period + stop
    if moves <= period and state[1] == 0.0 and state[2] == 0.0:
        return ADMISSIBLE  # it stays at rest
    looks = max(2, int(math.ceil(moves / LOOK)))
    for k in range(1, looks + 1):
        t = moves * k / looks
        if t <= period:
            at, _, _ = driven(before, state[1], state[2], command[0], command[1], limits, t)
        else:
            left = 1.0 - (t - period) / max(stop, 1e-9)
            done = 0.5 * stop * (1.0 - left * left)
            at = moved(pose, v * done, omega * done)
        if hidden.speed > 0.0:
            gap = hidden_gap(hidden, at[0], at[1]) - body.circumscribed
            need = hidden.speed * t - hidden.slack
            if gap < need and gap < at_start - 1e-3:
                return HIDDEN
            if gap < need and at_start > need:
                return HIDDEN
        for m in range(len(people.now)):
            x, y, vx, vy, radius, error = people.now[m]
            after = scene.ahead + t
            near = body.circumscribed + radius
            dx, dy = x + vx * after - at[0], y + vy * after - at[1]
            grown = near + error + 0.5 * people.acceleration * after * after
            square = dx * dx + dy * dy
            if square < grown * grown:
                x0, y0 = x + vx * after - before[0], y + vy * after - before[1]
                if square < near * near or square < x0 * x0 + y0 * y0 - 1e-3:
                    return MOVER
    return ADMISSIBLE


@njit(cache=True)
def hidden_gap(hidden, x, y):
    """Metres from a point to the nearest body that unseen space may hold."""
    rows, columns = hidden.distance.shape
    c, r = int((x - hidden.x0) / hidden.resolution), int((y - hidden.y0) / hidden.resolution)
    if x < hidden.x0 or y < hidden.y0 or r >= rows or c >= columns:
        return 0.0
    return hidden.distance[r, c] - hidden.radius
