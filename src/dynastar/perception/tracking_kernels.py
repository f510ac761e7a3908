"""Kernels of the tracker: constant-velocity filters, which group is whose, and what moves."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.perception import detection as d
from dynastar.perception.detection import fit_disc
from dynastar.perception.past_scans import seen_free

# Columns of a track. x and y have one covariance: T_PP of the position, T_VV of the velocity, T_PV
# between them. T_FULL is for how long (s) both ends were in view, T_FREE the fraction of its points
# in space that was seen free, T_ENDS which ends were hidden last, T_MISFIT the mean square of its
# innovations, normalised. (T_X0, T_Y0) is where it was first seen or has stopped, T_GROUP its group
# in this scan or -1; T_BORN, T_SEEN and T_MOVED are times (s).
T_X, T_Y, T_VX, T_VY, T_PP, T_PV, T_VV, T_RADIUS, T_FULL, T_FREE, T_ENDS, T_MISFIT = range(12)
T_X0, T_Y0, T_STATE, T_GROUP, T_BORN, T_SEEN, T_MOVED, T_ID = range(12, 20)
COLUMNS = 20
TENTATIVE, CONFIRMED, STOPPED, LOST = 0.0, 1.0, 2.0, 3.0
NEW_SPEED = 1.0  # m/s, standard deviation of the velocity of a new track
ERROR = 0.01  # m, standard deviation of a centre with both ends in view, besides the beams' spacing
HIDDEN_ERROR = (1.0, 2.0, 10.0)  # times that with so many ends hidden
MARGIN = 0.1  # m round a disc where points are still its own; further from its start, it has moved
SURE = 2.0  # standard deviations
STEADY = 0.14  # s that motion has to last
FITS = 4.0  # the largest T_MISFIT of steady motion; 2 is expected
SHIFT = 0.05  # m that the centre of what moves shifts by at most when an end comes into view or out
MISSED = 0.35  # s that something in view may go undetected
ACCELERATION = 0.1  # m2/s3, spectral density of the acceleration
FREE_FRACTION = 0.4  # of the points of a moving obstacle lie in space that was seen free before
REST_SPEED = 0.12  # m/s below which a track is at rest
REST_TIME = 1.0  # s at rest after which a track has stopped
SMOOTHING = 0.3  # s over which the radius, T_FREE and T_MISFIT are averaged


@njit(cache=True)
def predict(tracks, dt):
    """Moves every track ahead by ``dt`` (s) under white acceleration noise."""
    for t in range(len(tracks)):
        row = tracks[t]
        row[T_X] += row[T_VX] * dt
        row[T_Y] += row[T_VY] * dt
        row[T_PP] += 2.0 * dt * row[T_PV] + dt * dt * row[T_VV] + ACCELERATION * dt**3 / 3.0
        row[T_PV] += dt * row[T_VV] + 0.5 * ACCELERATION * dt * dt
        row[T_VV] += ACCELERATION * dt
        row[T_GROUP] = -1.0


@njit(cache=True)
def expected_discs(tracks, now):
    """Discs (k, 5) where tracks are expected; only those that move and are in view own points."""
    discs = np.zeros((len(tracks), 5))
    for t in range(len(tracks)):
        row = tracks[t]
        discs[t, d.D_X], discs[t, d.D_Y], discs[t, d.D_RADIUS] = row[T_X], row[T_Y], row[T_RADIUS]
        owns = row[T_STATE] == CONFIRMED and now - row[T_SEEN] < MISSED
        discs[t, d.D_MARGIN] = (
            MARGIN + min(SURE * math.sqrt(row[T_PP]), MARGIN) if owns else -np.inf
        )
        discs[t, d.D_MEASURED] = row[T_FULL] > 0.0
    return discs


@njit(cache=True)
def associate(tracks, groups, now):
    """Sets T_GROUP of the tracks, nearest pairs first, within the gate; returns which are taken.

    A track that was out of sight takes only a group in space that was seen free.
    """
    taken = np.zeros(len(groups), np.bool_)
    distances = np.empty(len(tracks) * len(groups))
    pairs, n = np.empty(len(distances), np.int64), 0
    for t in range(len(tracks)):
        row = tracks[t]
        gate = MARGIN + SURE * math.sqrt(row[T_PP] + ERROR * ERROR)
        unseen = now - row[T_SEEN] > MISSED
        for c in range(len(groups)):
            owner = groups[c, d.G_TRACK]
            if (owner >= 0.0 and owner != t) or (unseen and groups[c, d.G_FREE] < FREE_FRACTION):
                continue
            distance = math.hypot(groups[c, d.G_X] - row[T_X], groups[c, d.G_Y] - row[T_Y])
            if distance < gate or (owner == t and distance < row[T_RADIUS]):
                distances[n], pairs[n] = distance, t * len(groups) + c
                n += 1
    for k in np.argsort(distances[:n]):
        t, c = pairs[k] // len(groups), pairs[k] % len(groups)
        if tracks[t, T_GROUP] < 0.0 and not taken[c]:
            tracks[t, T_GROUP] = c
            taken[c] = True
    return taken


@njit(cache=True)
def correct(tracks, groups, points, sensor, now):
    """The Kalman update of every track with the disc that fits its group.

    The centre shifts, which is no motion, where the radius is corrected and where an end comes into
    view or out of it; for what is known to move, by up to ``SHIFT``.
    """
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_GROUP] < 0.0:
            continue
        group = groups[int(row[T_GROUP])]
        dt = min(max(now - row[T_SEEN], 1e-3), 1.0)
        n_hidden = int(group[d.G_HIDDEN_FIRST] + group[d.G_HIDDEN_LAST])
        ends = group[d.G_HIDDEN_FIRST] + 2.0 * group[d.G_HIDDEN_LAST]
        x, y, seen = fit_disc(points, group, sensor, row[T_RADIUS])
        ex, ey = x - row[T_X], y - row[T_Y]
        radius = row[T_RADIUS]
        if n_hidden == 0:
            gain = 1.0 if row[T_FULL] == 0.0 else dt / (min(row[T_FULL], SMOOTHING) + dt)
            radius += gain * (seen - radius)
            row[T_FULL] += dt
        elif row[T_FULL] == 0.0:
            radius = max(radius, seen)
        if radius != row[T_RADIUS]:
            row[T_RADIUS] = radius
            x1, y1, _ = fit_disc(points, group, sensor, radius)
            row[T_X] += x1 - x
            row[T_Y] += y1 - y
            row[T_X0] += x1 - x
            row[T_Y0] += y1 - y
        spacing = 0.3 * sensor.step * math.hypot(x - sensor.x, y - sensor.y)
        error = HIDDEN_ERROR[n_hidden] ** 2 * (ERROR * ERROR + spacing * spacing)
        s = row[T_PP] + error
        k_p, k_v = row[T_PP] / s, row[T_PV] / s
        misfit = (ex * ex + ey * ey) / s
        row[T_MISFIT] += dt / (SMOOTHING + dt) * (misfit - row[T_MISFIT])
        if ends != row[T_ENDS]:
            most = SHIFT if row[T_STATE] == CONFIRMED else np.inf
            shift = min(1.0, most / max(math.hypot(ex, ey), 1e-9))
            row[T_X] += shift * ex
            row[T_Y] += shift * ey
            row[T_X0] += shift * ex
            row[T_Y0] += shift * ey
            ex, ey = (1.0 - shift) * ex, (1.0 - shift) * ey
        row[T_X] += k_p * ex
        row[T_Y] += k_p * ey
        row[T_VX] += k_v * ex
        row[T_VY] += k_v * ey
        row[T_VV] -= k_v * row[T_PV]
        row[T_PV] -= k_p * row[T_PV]
        row[T_PP] -= k_p * row[T_PP]
        row[T_ENDS] = ends
        gain = dt / (min(row[T_SEEN] - row[T_BORN], SMOOTHING) + dt)
        row[T_FREE] += gain * (group[d.G_FREE] - row[T_FREE])
        row[T_SEEN] = now


@njit(cache=True)
def hide(tracks, dt, now, space, keep):
    """Keeps tracks that are out of sight where they can be: where space was not just seen free.

    One that would come into view waits behind the edge; one whose place has come into view is lost,
    as is one that was out of sight for ``keep`` seconds.
    """
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_GROUP] >= 0.0:
            continue
        unseen = now - row[T_SEEN]
        if unseen > (MISSED if row[T_STATE] == TENTATIVE else keep):
            row[T_STATE] = LOST
        elif row[T_STATE] != TENTATIVE and seen_free(row[T_X], row[T_Y], space):
            row[T_X] -= row[T_VX] * dt
            row[T_Y] -= row[T_VY] * dt
            if unseen > MISSED and seen_free(row[T_X], row[T_Y], space):
                row[T_STATE] = LOST


@njit(cache=True)
def judge(tracks, now, space, fastest):
    """Decides which tracks move; returns those that have just been found to (bool per track).

    A track moves once its motion is steady and faster than REST_SPEED beyond doubt, and either it lies
    in space that was seen free before, or the place where it was first seen is seen free now. It
    has stopped after REST_TIME below that speed.
    """
    started = np.zeros(len(tracks), np.bool_)
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_GROUP] < 0.0:
            continue
        speed = math.hypot(row[T_VX], row[T_VY])
        if speed > fastest:  # two things taken for one
            row[T_STATE] = LOST
        elif row[T_STATE] == CONFIRMED:
            if speed > REST_SPEED:
                row[T_MOVED] = now
            elif now - row[T_MOVED] > REST_TIME:
                row[T_STATE] = STOPPED
                row[T_X0], row[T_Y0] = row[T_X], row[T_Y]
        elif speed > max(REST_SPEED, SURE * math.sqrt(row[T_VV])) and row[T_MISFIT] < FITS:
            gone = math.hypot(row[T_X] - row[T_X0], row[T_Y] - row[T_Y0])
            entered = row[T_STATE] == STOPPED or row[T_FREE] > FREE_FRACTION
            left = row[T_ENDS] == 0.0 and row[T_FULL] > STEADY
            left = left and gone > max(row[T_RADIUS], d.TYPICAL_RADIUS)
            left = left and seen_free(row[T_X0], row[T_Y0], space)
            if now - row[T_BORN] > STEADY and gone > MARGIN and (entered or left):
                row[T_STATE], row[T_MOVED] = CONFIRMED, now
                started[t] = True
    return started


@njit(cache=True)
def points_on(points, owner, tracks, groups):
    """Which points (n,) lie on a track that moves: those of its group and those near its disc."""
    moving = np.zeros(len(points), np.bool_)
    n = len(points)
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_STATE] != CONFIRMED or row[T_GROUP] < 0.0:
            continue
        group = groups[int(row[T_GROUP])]
        for k in range(int(group[d.G_START]), int(group[d.G_STOP])):
            moving[k % n] = True
        reach = row[T_RADIUS] + MARGIN
        for i in range(n):
            dx, dy = points[i, 0] - row[T_X], points[i, 1] - row[T_Y]
            if owner[i] != d.MAPPED and dx * dx + dy * dy < reach * reach:
                moving[i] = True
    return moving
