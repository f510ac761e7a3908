"""Which commands are admissible: those with a certified stop, the general form of Eq. 7.

``around`` are the Surroundings of a scene.
"""

import math

from dynastar.compiled import inner, njit
from dynastar.dwa.clearance import ROUNDING, body_distance, clearance_slack, least_clearance
from dynastar.dwa.motion import State, driven, moved, parts_of, ramped_both, state_of, stopping_time
from dynastar.perception.hidden import APPROACH, HIDDEN_RADIUS
from dynastar.perception.prediction import TRACKING_ERROR

ADMISSIBLE, NO_STOP, MOVING, HIDDEN = range(4)
CHECK_PERIOD = 0.1  # s between two checks for moving obstacles during a stop
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
        slack = clearance_slack(closed, body, margin, start, at)
        if left <= 0.0 or not -ROUNDING <= slack < left:
            return slack >= -ROUNDING
        fraction = min(1.0, fraction + max(slack, smallest) / sweep)
        at = moved(pose, fraction * length, fraction * angle)


@inner
def refusal(around, rules, stops_from, command):
    """ADMISSIBLE, or why a command (v, omega) is not; MOVING where it does not rest in time.

    The last of ``stops_from`` is the state in which the command is expected to begin to act.
    """
    if not stops_are_certified(around, rules, stops_from, command):
        return NO_STOP
    return rests_in_time(around, rules, state_of(stops_from[-1]), command)


@inner
def stops_are_certified(around, rules, stops_from, command):
    """Whether there is a certified stop after a command from each of ``stops_from``."""
    for begin in stops_from:
        if certified_stop(around, rules, state_of(begin), command, begin.hold) != ADMISSIBLE:
            return False
    return True


@njit(cache=True)
def is_admissible(around, rules, stops_from, command):
    """Whether a command (v, omega) from outside the search is admissible."""
    return refusal(around, rules, stops_from, command) == ADMISSIBLE


@inner
def certified_stop(around, rules, state, command, hold):
    """ADMISSIBLE if the robot can come to rest in observed-free space after ``hold`` s of ``command``.

    ``state`` is that in which the command begins to act. Each speed may be off by ``drive_error`` either
    way, and a speed in the drive's dead band may drop to zero before its ramp ends.
    """
    more, less = 1.0 + rules.drive_error, 1.0 - rules.drive_error
    (v, omega), hold = command, max(hold, rules.period)
    is_arc = (state.v != 0.0 or v != 0.0) and (state.omega != 0.0 or omega != 0.0)
    has_least = rules.limits.v_least > 0.0 or rules.limits.omega_least > 0.0
    for gains in ((more, more), (more, less), (less, more)):
        if not stop_keeps_clear(around, rules, state, (v, omega, hold), gains, False):
            return NO_STOP
        if not is_arc:
            break
        if has_least and not stop_keeps_clear(around, rules, state, (v, omega, hold), gains, True):
            return NO_STOP
        if more == less:
            break
    return ADMISSIBLE


@inner
def stop_keeps_clear(around, rules, state, held, gains, ends_early):
    """Whether a command ``held`` (v, omega, for how long in s), and the stop after it, keep clear.

    While it is held each speed changes at its own limit; then both ramp to zero in proportion, along
    one arc. If the stop ``ends_early``, the speed that first falls into its dead band brakes at its own
    limit from there. ``gains`` are driven over commanded speeds (v, omega).
    """
    body, limits, pose = rules.body, rules.limits, state.pose
    closed, margin, start = around.closed, around.margin_to_closed, state.pose
    (v, omega, hold), (v_gain, omega_gain) = held, gains
    parts = parts_of(hold)
    for part in range(parts + (3 if ends_early else 1)):
        if part < parts:
            speeds, (length, angle) = ramped_both(state, v, omega, limits, hold / parts)
            state = State(start, *speeds)
        else:
            length, angle = stop_part(state, limits, ends_early, part - parts)
        length, angle = v_gain * length, omega_gain * angle
        if not keeps_clear(closed, body, margin, start, pose, (length, angle)):
            return False
        pose = moved(pose, length, angle)
    return True


@inner
def stop_part(state, limits, ends_early, part):
    """The arc (length in m, angle in rad) of one part of a stop: all of it, unless it ``ends_early``.

    Then there are three: until one speed falls into its dead band, while that brakes, and the rest.
    """
    v, omega = state.v, state.omega
    stop = stopping_time(v, omega, limits)
    if not ends_early:
        return 0.5 * stop * v, 0.5 * stop * omega
    fraction_v = least_fraction(v, limits.v_least)
    fraction_omega = least_fraction(omega, limits.omega_least)
    v_ends, fraction = fraction_v >= fraction_omega, max(fraction_v, fraction_omega)
    brakes = fraction * (abs(v) / limits.v_brake if v_ends else abs(omega) / limits.omega_brake)
    fractions = (1.0, fraction, max(0.0, fraction - brakes / max(stop, 1e-9)), 0.0)
    on_ramp = 0.5 * stop * (fractions[part] ** 2 - fractions[part + 1] ** 2)
    alone = (on_ramp, 0.5 * brakes * fraction, 0.0)[part]
    return (alone if v_ends else on_ramp) * v, (on_ramp if v_ends else alone) * omega


@inner
def least_fraction(speed, least):
    """The fraction of a ``speed`` at which its dead band begins, 1 if it lies in it."""
    return min(1.0, least / abs(speed)) if speed != 0.0 else 0.0


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
            need = hidden.speed * t - APPROACH
            gap = hidden_gap(hidden, body, pose, need)
            if gap < need:
                at_start = hidden_gap(hidden, body, start, need)
                if at_start > need or gap < at_start - NEARER:
                    return HIDDEN
        if code == ADMISSIBLE and reaches(around.moving, body, start, pose, around.latency + t):
            code = MOVING  # a later check may yet find HIDDEN, for which more is asked
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
