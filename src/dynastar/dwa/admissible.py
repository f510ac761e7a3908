"""Which commands are admissible: those with a certified stop, the general form of Eq. 7.

``around`` are the Surroundings of a scene.
"""

import math

from dynastar.compiled import inner, njit
from dynastar.dwa.clearance import ROUNDING, body_distance, clearance_slack, least_clearance
from dynastar.dwa.motion import State, driven, moved, state_of, stopping_time
from dynastar.perception.hidden import HIDDEN_RADIUS, SLACK
from dynastar.perception.prediction import TRACKING_ERROR

ADMISSIBLE, NO_STOP, MOVING, HIDDEN = range(4)
CHECK_PERIOD = 0.1  # s between two checks for moving obstacles during a stop
FAR_ENOUGH = 0.2  # m up to which a clearance is looked at exactly
NEARER = 1e-3  # m by which a gap has to shrink to count


@inner
def keeps_clear(closed, body, margin, start, pose, arc):
    """Whether the footprint keeps the constraint of ``clearance_slack`` along an arc from ``pose``.

    ``arc`` is (length in m, angle in rad). Conservative advancement: no point of the footprint moves
    further than |length| + R |angle|, so the slack at a pose covers the stretch after it.
    """
    length, angle = arc
    sweep = abs(length) + body.circumscribed * abs(angle)
    smallest = 0.25 * closed.distance.resolution
    fraction, at = 0.0, pose
    while True:
        left = (1.0 - fraction) * sweep
        slack = clearance_slack(closed, body, margin, start, at, min(left, FAR_ENOUGH))
        if left <= 0.0 or not -ROUNDING <= slack < left:
            return slack >= -ROUNDING
        fraction = min(1.0, fraction + max(slack, smallest) / sweep)
        at = moved(pose, fraction * length, fraction * angle)


@inner
def refusal(around, rules, stops_from, command):
    """ADMISSIBLE, or why a command (v, omega) is not; MOVING where it does not rest in time.

    The last of ``stops_from`` is the state in which the command is expected to begin to act.
    """
    for begin in stops_from:
        code = certified_stop(around, rules, state_of(begin), command, begin.hold)
        if code != ADMISSIBLE:
            return code
    return rests_in_time(around, rules, state_of(stops_from[-1]), command)


@njit(cache=True)
def is_admissible(around, rules, stops_from, command):
    """Whether a command (v, omega) from outside the search is admissible."""
    return refusal(around, rules, stops_from, command) == ADMISSIBLE


@inner
def certified_stop(around, rules, state, command, hold):
    """ADMISSIBLE if the robot can come to rest in observed-free space after ``hold`` s of ``command``.

    Over a period each speed changes at its own limit; after ``hold``, if that is longer, both ramp to
    zero in proportion, along one arc. ``state`` is that in which the command begins to act. All speeds
    may be greater than said by ``drive_error``, and so are the ways.
    """
    closed, margin = around.closed, around.margin_to_closed
    body, limits, start = rules.body, rules.fast_limits, state.pose
    half, more = 0.5 * rules.period, 1.0 + rules.drive_error
    longer = max(hold - rules.period, 0.0)
    v, omega = command
    v, omega = more * v, more * omega
    state = State(start, more * state.v, more * state.omega)
    for duration in (half, half, longer):
        after = driven(state, v, omega, limits, duration)
        mean = 0.5 * duration
        arc = mean * (state.v + after.v), mean * (state.omega + after.omega)
        if not keeps_clear(closed, body, margin, start, state.pose, arc):
            return NO_STOP
        state = after
    half_stop = 0.5 * stopping_time(state.v, state.omega, limits)
    arc = half_stop * state.v, half_stop * state.omega
    if not keeps_clear(closed, body, margin, start, state.pose, arc):
        return NO_STOP
    return ADMISSIBLE


@inner
def rests_in_time(around, rules, state, command):
    """ADMISSIBLE if the robot is at rest before any moving obstacle can touch it.

    A track is somewhere in the disc round its constant-velocity prediction that its acceleration
    lets it reach; a person may step out of unseen space at ``hidden.speed``. Where rest does not keep
    clear of that, the robot may move if it comes no nearer than at rest.
    """
    (v, omega), limits, start = command, rules.limits, state.pose
    body, hidden = rules.body, around.hidden
    after = driven(state, v, omega, limits, rules.period)
    stop = stopping_time(after.v, after.omega, limits)
    if stop <= 0.0 and state.v == 0.0 and state.omega == 0.0:
        return ADMISSIBLE  # it stays at rest
    duration = rules.period + stop
    checks = max(2, int(math.ceil(duration / CHECK_PERIOD)))
    code = ADMISSIBLE
    for k in range(1, checks + 1):
        t = duration * k / checks
        if t <= rules.period:
            pose = driven(state, v, omega, limits, t).pose
        else:
            left = 1.0 - (t - rules.period) / max(stop, 1e-9)
            done = 0.5 * stop * (1.0 - left * left)
            pose = moved(after.pose, after.v * done, after.omega * done)
        if hidden.speed > 0.0:
            need = hidden.speed * t - SLACK
            gap = hidden_gap(hidden, body, pose, need)
            if gap < need:
                at_start = hidden_gap(hidden, body, start, need)
                if at_start > need or gap < at_start - NEARER:
                    return HIDDEN
        if code == ADMISSIBLE and reaches(around.moving, body, start, pose, around.latency + t):
            code = MOVING  # a later check may yet find HIDDEN, which nothing makes good
    return code


@inner
def reaches(moving, body, start, pose, t):
    """Whether a moving obstacle can touch the footprint at ``pose`` in ``t`` seconds.

    By the hard bound, and only if the footprint is nearer to its expected position than at ``start``.
    """
    bound = TRACKING_ERROR + 0.5 * moving.acceleration * t * t
    for obstacle in moving.obstacles:
        x, y = obstacle.x + obstacle.vx * t, obstacle.y + obstacle.vy * t
        far = body.circumscribed + obstacle.radius + bound
        if (x - pose.x) ** 2 + (y - pose.y) ** 2 < far * far:
            away, before = body_distance(body, pose, x, y), body_distance(body, start, x, y)
            near = away < obstacle.radius + bound
            if near and (away < obstacle.radius or away < before - NEARER):
                return True
    return False


@inner
def hidden_gap(hidden, body, pose, enough):
    """Metres from the footprint to the nearest body that unseen space may hold; exact up to ``enough``."""
    return least_clearance(hidden.distance, body, pose, enough + HIDDEN_RADIUS) - HIDDEN_RADIUS
