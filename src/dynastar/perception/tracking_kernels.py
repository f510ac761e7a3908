"""Kernels of the tracker: constant-velocity filters, which group is whose, and what moves."""

import math

import numpy as np

from dynastar.compiled import allocating, inner, njit, record
from dynastar.perception.detection import (
    FREE_FRACTION,
    MAPPED,
    NEITHER,
    TYPICAL_RADIUS,
    UNOWNED,
    fit_disc,
)
from dynastar.perception.past_scans import seen_free_at

TENTATIVE, CONFIRMED, STOPPED, LOST = range(4)  # states
NO_GROUP = -1
NEW_SPEED = 1.0  # m/s, standard deviation of the velocity of a new track
ERROR = 0.01  # m, standard deviation of a centre with both ends in view, besides the beams' spacing
HIDDEN_ERROR = (1.0, 2.0, 2.0, 10.0)  # times that with NEITHER, FIRST, LAST, BOTH ends hidden
LEGS_ERROR, LEG_ERROR = 0.2, 0.4  # m, the same of a person's centre by both legs, and by one
PAIR_RADIUS = 0.2  # m, half the width of two legs side by side at most
MARGIN = 0.1  # m round a disc where points are still its own; farther from its start, it has moved
SURE = 2.0  # standard deviations
STEADY = 0.14  # s that motion has to last
FITS = 4.0  # the largest misfit of steady motion; 2 is expected
SHIFT = 0.05  # m that the centre of what moves shifts by at most when an end comes into view or out
OCCLUDED = 6.0  # s for which a track out of sight is kept
MISSED = 0.35  # s that something in view may go undetected
ACCELERATION = 0.1  # m2/s3, spectral density of the acceleration
REST_SPEED = 0.12  # m/s below which a track is at rest
REST_TIME = 1.0  # s at rest after which a track has stopped
SMOOTHING = 0.3  # s over which the radius and ``misfit`` are averaged


class Fields:
    """A track: a disc with a constant-velocity filter."""

    id: int
    state: int  # TENTATIVE, CONFIRMED, STOPPED or LOST
    group: int  # index of its group in this scan, or NO_GROUP
    x: float  # m, map frame
    y: float
    vx: float  # m/s
    vy: float
    var_x: float  # m2, variance of x and of y
    cov_xv: float  # m2/s, covariance of x and vx, and of y and vy
    var_v: float  # m2/s2, variance of vx and of vy
    radius: float  # m
    margin: float  # m round the disc where points are still its own, -inf for none
    measured: float  # s with both ends in view; until then the radius is assumed
    legs: bool  # a person of whom the legs are seen; the radius is TYPICAL_RADIUS
    misfit: float  # mean square of its innovations, normalised
    start_x: float  # m, where it was first seen or has stopped
    start_y: float
    inside_x: float  # m, a place just behind the first point that was seen of it
    inside_y: float
    born: float  # s, when it was first seen, last seen, and last moved
    seen: float
    moved: float
    hidden: int  # ends of its last group: NEITHER, FIRST, LAST or BOTH
    started: bool  # found to move in this scan


TRACK = record(Fields)
PAIR = np.dtype([("distance", float), ("track", int), ("group", int)])


@njit(cache=True)
def predict(tracks, dt, now):
    """Move every track ahead by ``dt`` (s), and set the margin within which it owns points.

    Only tracks that move and are in view own points.
    """
    for track in tracks:
        track.x += track.vx * dt
        track.y += track.vy * dt
        track.var_x += 2.0 * dt * track.cov_xv + dt * dt * track.var_v + ACCELERATION * dt**3 / 3.0
        track.cov_xv += dt * track.var_v + 0.5 * ACCELERATION * dt * dt
        track.var_v += ACCELERATION * dt
        track.group, track.started, track.margin = NO_GROUP, False, -np.inf
        if track.state == CONFIRMED and now - track.seen < MISSED:
            track.margin = MARGIN + min(SURE * math.sqrt(track.var_x), MARGIN)


@njit(cache=True)
def update(tracks, groups, points, sensor, space, config, dt):
    """Update the tracks with the groups found ``dt`` s after the last ones.

    Sets ``moving`` of the points on tracks that move. ``config`` is a TrackerConfig.
    """
    now = sensor.stamp
    associate(tracks, groups, now)
    for track in tracks:
        if track.group == NO_GROUP:
            hide(track, dt, now, space)
        else:
            correct(track, groups[track.group], points, sensor)
            judge(track, groups[track.group], points, space, now, config.fastest)
            if track.state == CONFIRMED:
                mark_moving(points, track, groups[track.group])


@allocating
def associate(tracks, groups, now):
    """Give each track the group within its gate, nearest pairs first.

    A group that has an owner goes to no other track; a track that was out of sight takes only a group
    in space that was seen free.
    """
    pairs, n = np.empty(len(tracks) * len(groups), PAIR), 0
    for t, track in enumerate(tracks):
        gate = MARGIN + SURE * math.sqrt(track.var_x + ERROR * ERROR)
        unseen = now - track.seen > MISSED
        for g, group in enumerate(groups):
            distance = math.hypot(group.x - track.x, group.y - track.y)
            near = distance < (max(gate, track.radius) if group.owner == t else gate)
            entered = group.free >= FREE_FRACTION
            if near and group.owner in (UNOWNED, t) and (entered or not unseen):
                pairs[n].distance, pairs[n].track, pairs[n].group = distance, t, g
                n += 1
    for _ in range(n):
        pair = pairs[0]
        for other in pairs[1:n]:
            if other.distance < pair.distance:
                pair = other
        track, group = tracks[pair.track], groups[pair.group]
        if track.group == NO_GROUP and not group.taken:
            track.group, group.taken = pair.group, True
        pair.distance = np.inf


@inner
def correct(track, group, points, sensor):
    """Kalman update of a track with the disc that fits its group.

    The centre shifts, which is no motion, where the radius is corrected and where an end comes into
    view or out of it; that of a track known to move by SHIFT at most. By legs the centre is that of the
    group, and the radius is not measured.
    """
    dt = min(max(sensor.stamp - track.seen, 1e-3), 1.0)
    too_wide = group.hidden == NEITHER and group.radius > PAIR_RADIUS
    track.legs = group.legs or (track.legs and not too_wide)
    if track.legs:
        x, y, track.radius = group.x, group.y, TYPICAL_RADIUS
        error = LEGS_ERROR if group.paired else LEG_ERROR
    else:
        x, y, seen = fit_disc(points, group, sensor, track.radius)
        spacing = 0.3 * abs(sensor.step) * math.hypot(x - sensor.x, y - sensor.y)
        error = HIDDEN_ERROR[group.hidden] * math.hypot(ERROR, spacing)
    ex, ey = x - track.x, y - track.y
    if not track.legs:
        correct_radius(track, group, points, sensor, (x, y, seen), dt)
    s = track.var_x + error * error
    k_p, k_v = track.var_x / s, track.cov_xv / s
    track.misfit += dt / (SMOOTHING + dt) * ((ex * ex + ey * ey) / s - track.misfit)
    if track.hidden != group.hidden and not track.legs:
        most = SHIFT if track.state == CONFIRMED else np.inf
        part = min(1.0, most / max(math.hypot(ex, ey), 1e-9))
        shift(track, part * ex, part * ey)
        ex, ey = (1.0 - part) * ex, (1.0 - part) * ey
    track.x += k_p * ex
    track.y += k_p * ey
    track.vx += k_v * ex
    track.vy += k_v * ey
    track.var_v -= k_v * track.cov_xv
    track.cov_xv -= k_p * track.cov_xv
    track.var_x -= k_p * track.var_x
    track.hidden = group.hidden
    track.seen = sensor.stamp


@inner
def correct_radius(track, group, points, sensor, disc, dt):
    """Average the radius with that of ``disc`` (x, y, seen), which fits with the present radius."""
    x, y, seen = disc
    radius = track.radius
    if group.hidden == NEITHER:
        radius += dt / (min(track.measured, SMOOTHING) + dt) * (seen - radius)
        track.measured += dt
    elif track.measured == 0.0:
        radius = max(radius, seen)
    if radius != track.radius:
        track.radius = radius
        x1, y1, _ = fit_disc(points, group, sensor, radius)
        shift(track, x1 - x, y1 - y)


@inner
def shift(track, dx, dy):
    """Shift a track and its start."""
    track.x += dx
    track.y += dy
    track.start_x += dx
    track.start_y += dy


@inner
def hide(track, dt, now, space):
    """Keep a track without a group where space was not just seen free; drop it after ``OCCLUDED`` s.

    Where it would come into view it waits behind the edge; where its place is in view it is lost.
    """
    unseen = now - track.seen
    if unseen > (MISSED if track.state == TENTATIVE else OCCLUDED):
        track.state = LOST
    elif track.state != TENTATIVE and seen_free_at(track.x, track.y, space) > now - MISSED:
        track.x -= track.vx * dt
        track.y -= track.vy * dt
        if unseen > MISSED and seen_free_at(track.x, track.y, space) > now - MISSED:
            track.state = LOST


@inner
def judge(track, group, points, space, now, fastest):
    """Decide whether a track moves; sets its state, and ``started`` if it begins to.

    A track moves once its motion is steady and faster than REST_SPEED beyond doubt, and either it lies
    where space was seen free since the track began, or the place where it was seen first is seen free now.
    Without either, another side of an obstacle at rest has come into view. It has stopped after
    REST_TIME below that speed.
    """
    speed = math.hypot(track.vx, track.vy)
    if speed > fastest:  # two obstacles taken for one
        track.state = LOST
    elif track.state == CONFIRMED:
        if speed > REST_SPEED:
            track.moved = now
        elif now - track.moved > REST_TIME:
            track.state, track.start_x, track.start_y = STOPPED, track.x, track.y
    elif speed > max(REST_SPEED, SURE * math.sqrt(track.var_v)) and track.misfit < FITS:
        gone = math.hypot(track.x - track.start_x, track.y - track.start_y)
        entered = track.state == STOPPED or has_entered(track, group, points)
        free_at = seen_free_at(track.inside_x, track.inside_y, space)
        left = free_at > max(track.born, now - MISSED)
        if now - track.born > STEADY and gone > MARGIN and (entered or left):
            track.state, track.moved, track.started = CONFIRMED, now, True


@inner
def has_entered(track, group, points):
    """Whether enough of a track's points lie in space that was seen free since the track began."""
    entered = 0
    for point in points[group.start : group.stop]:
        entered += point.free_at >= track.born
    return entered >= FREE_FRACTION * (group.stop - group.start)


@inner
def mark_moving(points, track, group):
    """Mark the points of a track's group and those near its disc."""
    for i, point in enumerate(points):
        square = (point.x - track.x) ** 2 + (point.y - track.y) ** 2
        near = square < (track.radius + MARGIN) ** 2 and point.owner != MAPPED
        point.moving |= near or group.start <= i < group.stop
