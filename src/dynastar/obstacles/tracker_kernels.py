"""Kernels of the tracker: clusters of a scan, and constant-velocity tracks of them."""

import math

import numpy as np

from dynastar.compiled import njit

# Columns of a cluster: centre, radius, share of points in space seen free before, first and last
# point, and how many of its ends are hidden by something nearer or lie at what the map shows.
C_X, C_Y, C_RADIUS, C_FRESH, C_FIRST, C_LAST, C_CUT = range(7)
# Columns of a track. x and y share one covariance, for the filter treats them alike. (T_X0, T_Y0) is
# where it was first seen and, once it moves, where it was lost: see ``lurk``.
T_X, T_Y, T_VX, T_VY, T_PP, T_PV, T_VV, T_RADIUS, T_HITS, T_SEEN, T_FRESH = range(11)
T_X0, T_Y0, T_MOVING, T_SLOW_SINCE, T_CLUSTER, T_TOP = range(11, 17)
COLUMNS = 17
LOST = 0.5  # s after which a mover that is seen again has its velocity measured anew
HIDING = 2.0  # m ahead of where it was last that a mover may be hidden
BEHIND = 1.5  # cells behind a point to where its space has to have been seen free before
UNSEEN = 0.35  # s without having been seen free, and something may be there
HALF_SEEN = 0.3  # m, the radius of something that one end is hidden of, unless more is seen
HIDDEN = (1.0, 1.5, 4.0)  # so much less sure is a centre with so many ends hidden
TOP_KEPT = 0.97  # of a mover's top speed from scan to scan
CRACK = 0.25  # of the gap between two things, at which what is too wide is taken apart
PART_FRESH = 0.6  # of its points in space seen free before, or a part of it is none
STEEPEST = 0.8  # radius over distance, up to which a disc is told from its width


@njit(cache=True)
def disc_in_view(r, half):
    """Distance of the centre and radius of a disc, ``half`` as wide as it looks, its points at ``r``.

    ``r`` (m) is the mean of its points' distances along the line to the centre. A disc at distance D
    shows an arc to where rays touch it, at sin(a) = radius / D either side of that line; so it is
    radius cos(a) to either side, and the arc's mean over all rays is D (1 - sin 2a / (2a)) / 2 +
    pi / 4 radius sin(a) / a nearer than the centre.
    """
    radius, distance = half, r + 0.25 * math.pi * half  # as from far away
    for _ in range(4):
        sin = min(radius / distance, STEEPEST)
        a, cos = math.asin(sin), math.sqrt(1.0 - sin * sin)
        radius = half / cos
        nearer = 0.5 * distance * (1.0 - sin * cos / a) + 0.25 * math.pi * radius * sin / a
        distance = r + nearer
    return distance, radius


@njit(cache=True)
def disc_at_end(points, start, stop, hidden, radius, half_step, sensor_x, sensor_y):
    """The centre of a disc whose one edge is the visible end of a group of points.

    ``hidden`` is 1 if the group's first end is the hidden one, -1 if its last is. However much of
    the disc comes into view, the centre that this gives moves as the disc does.
    """
    n = len(points)
    end = ((stop - 1) if hidden > 0 else start) % n
    end_x, end_y = points[end, 0] - sensor_x, points[end, 1] - sensor_y
    edge = math.atan2(end_y, end_x) + hidden * half_step  # where rays touch the disc
    distance = math.hypot(math.hypot(end_x, end_y), radius)
    ux = uy = 0.0
    for _ in range(3):
        angle = edge - hidden * math.asin(min(radius / max(distance, 1e-9), 1.0))
        ux, uy = math.cos(angle), math.sin(angle)
        distance = 0.0
        for k in range(start, stop):
            px, py = points[k % n, 0] - sensor_x, points[k % n, 1] - sensor_y
            off = ux * py - uy * px
            distance += ux * px + uy * py + math.sqrt(max(radius * radius - off * off, 0.0))
        distance /= stop - start
    return sensor_x + distance * ux, sensor_y + distance * uy


@njit(cache=True)
def end_of(breaks, start, last):
    """Where a group that begins at ``start`` ends; indices go on round the circle, up to ``last``."""
    stop = start + 1
    while stop < last and not breaks[stop % len(breaks)]:
        stop += 1
    return stop


@njit(cache=True)
def extent(points, start, stop):
    """The diagonal (m) of the box round a group of points."""
    n = len(points)
    low_x = low_y = np.inf
    high_x = high_y = -np.inf
    for k in range(start, stop):
        px, py = points[k % n, 0], points[k % n, 1]
        low_x, high_x = min(low_x, px), max(high_x, px)
        low_y, high_y = min(low_y, py), max(high_y, py)
    return math.hypot(high_x - low_x, high_y - low_y)


@njit(cache=True)
def clusters(
    points,
    beams,
    n_beams,
    full_circle,
    step,
    sensor_x,
    sensor_y,
    gap,
    widest,
    free_at,
    x0,
    y0,
    resolution,
    since,
    known,
    known_frame,
):
    """Groups neighbouring points into things that could move: (m, 7), see the columns above.

    A group breaks where neighbours lie further apart than ``gap`` plus twice the beams' spacing and
    where what the map shows begins or ends; that is left out. What is wider than ``widest`` is taken
    apart at smaller gaps, for somebody may walk close by something that stands, and left out but for
    parts in space that was seen free.
    ``known_frame`` is (resolution, x, y, yaw) of the map whose widened obstacles ``known`` marks.
    """
    n = len(points)
    found = np.empty((n, 7))
    m = 0
    if n == 0:
        return found[:0]
    cos, sin = math.cos(known_frame[3]), math.sin(known_frame[3])
    mapped = np.zeros(n, np.bool_)  # whether the map shows what point i lies on
    for i in range(n):
        dx, dy = points[i, 0] - known_frame[1], points[i, 1] - known_frame[2]
        column = int(math.floor((cos * dx + sin * dy) / known_frame[0]))
        row = int(math.floor((cos * dy - sin * dx) / known_frame[0]))
        if 0 <= row < known.shape[0] and 0 <= column < known.shape[1]:
            mapped[i] = known[row, column]
    breaks, cracks = np.zeros(n, np.bool_), np.zeros(n, np.bool_)  # before point i
    for i in range(n):
        j = i - 1 if i > 0 else n - 1
        dx, dy = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]
        r = math.hypot(points[i, 0] - sensor_x, points[i, 1] - sensor_y)
        skipped = (beams[i] - beams[j]) % n_beams
        apart = math.hypot(dx, dy) - 2.0 * r * step
        other = mapped[i] != mapped[j] or skipped > 3 or (i == 0 and not full_circle)
        breaks[i], cracks[i] = other or apart > gap, other or apart > CRACK * gap
    first = 0
    while first < n and not breaks[first]:
        first += 1
    if first == n:
        return found[:0]  # one group all round: walls
    start = whole = first  # of the group, and where the one ends that is taken apart
    while start < first + n:
        stop = end_of(breaks, start, first + n)
        if start >= whole and extent(points, start, stop) > widest:
            whole = stop
        part = start < whole
        if part:
            stop = end_of(cracks, start, whole)
        count = stop - start
        a, b = start % n, (stop - 1) % n
        width = math.hypot(points[b, 0] - points[a, 0], points[b, 1] - points[a, 1])
        if count >= 2 and not mapped[a] and extent(points, start, stop) <= widest:
            cx = cy = 0.0
            fresh = 0
            for k in range(start, stop):
                px, py = points[k % n, 0], points[k % n, 1]
                cx += px
                cy += py
                # A surface that stands may lie in a cell that beams pass; behind it none does.
                depth = BEHIND * resolution / max(math.hypot(px - sensor_x, py - sensor_y), 1e-9)
                row = int(math.floor((py + depth * (py - sensor_y) - y0) / resolution))
                column = int(math.floor((px + depth * (px - sensor_x) - x0) / resolution))
                if (
                    0 <= row < free_at.shape[0]
                    and 0 <= column < free_at.shape[1]
                    and free_at[row, column] > since
                ):
                    fresh += 1
            cx, cy = cx / count, cy / count
            if not part or fresh >= PART_FRESH * count:
                r = max(math.hypot(cx - sensor_x, cy - sensor_y), 1e-9)
                distance, radius = disc_in_view(r, max(0.5 * (width + r * step), 0.05))
                found[m, C_X] = sensor_x + distance / r * (cx - sensor_x)
                found[m, C_Y] = sensor_y + distance / r * (cy - sensor_y)
                found[m, C_RADIUS] = radius
                found[m, C_FRESH] = fresh / count
                found[m, C_FIRST] = start
                found[m, C_LAST] = stop - 1
                found[m, C_CUT] = 0.0
                one_end = 0  # the hidden one, if it is one: 1 the first, -1 the last
                for end, beside, side in ((a, (start - 1) % n, 1), (b, stop % n, -1)):
                    skipped = abs(beams[end] - beams[beside])
                    beside_r = math.hypot(
                        points[beside, 0] - sensor_x, points[beside, 1] - sensor_y
                    )
                    end_r = math.hypot(points[end, 0] - sensor_x, points[end, 1] - sensor_y)
                    torn = part and not breaks[a if side > 0 else stop % n]
                    nearer = beside_r < end_r + (gap if mapped[beside] or torn else -gap)
                    if min(skipped, n_beams - skipped) <= 3 and nearer:
                        found[m, C_CUT] += 1.0
                        one_end += side
                if one_end != 0:
                    radius = max(radius, HALF_SEEN)
                    found[m, C_RADIUS] = radius
                    found[m, C_X], found[m, C_Y] = disc_at_end(
                        points, start, stop, one_end, radius, 0.5 * step, sensor_x, sensor_y
                    )
                m += 1
        start = stop
    return found[:m]


@njit(cache=True)
def predict(tracks, dt, acceleration):
    """Moves every track ahead by ``dt`` under white acceleration noise (m/s2)."""
    q = acceleration * acceleration
    for t in range(len(tracks)):
        row = tracks[t]
        row[T_X] += row[T_VX] * dt
        row[T_Y] += row[T_VY] * dt
        row[T_PP] += 2.0 * dt * row[T_PV] + dt * dt * row[T_VV] + 0.25 * q * dt**4
        row[T_PV] += dt * row[T_VV] + 0.5 * q * dt**3
        row[T_VV] += q * dt * dt
        row[T_CLUSTER] = -1.0


@njit(cache=True)
def associate(tracks, found, gate):
    """Gives clusters to tracks, nearest pairs first, within ``gate`` metres and three deviations.

    Sets the tracks' T_CLUSTER; returns which clusters are taken (m,).
    """
    taken = np.zeros(len(found), np.bool_)
    while True:
        best, best_t, best_c = np.inf, -1, -1
        for t in range(len(tracks)):
            if tracks[t, T_CLUSTER] >= 0.0:
                continue
            for c in range(len(found)):
                if taken[c]:
                    continue
                d = math.hypot(found[c, C_X] - tracks[t, T_X], found[c, C_Y] - tracks[t, T_Y])
                if d < best and d < gate + 3.0 * math.sqrt(tracks[t, T_PP]):
                    best, best_t, best_c = d, t, c
        if best_t < 0:
            return taken
        tracks[best_t, T_CLUSTER] = best_c
        taken[best_c] = True


@njit(cache=True)
def correct(tracks, found, error, now):
    """The Kalman update of every track with its cluster; ``error`` is a centre's deviation (m)."""
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_CLUSTER] < 0.0:
            continue
        c = found[int(row[T_CLUSTER])]
        if now - row[T_SEEN] > LOST:  # where it is now says nothing of how fast it went
            row[T_PP], row[T_PV], row[T_VV] = 1.0, 0.0, 0.25
        r = (error * HIDDEN[int(c[C_CUT])]) ** 2
        s = row[T_PP] + r
        k_p, k_v = row[T_PP] / s, row[T_PV] / s
        if c[C_CUT] > 1.0 and row[T_MOVING] > 0.0:  # what comes into view of it is no motion
            k_v = 0.0
        ex, ey = c[C_X] - row[T_X], c[C_Y] - row[T_Y]
        row[T_X] += k_p * ex
        row[T_Y] += k_p * ey
        row[T_VX] += k_v * ex
        row[T_VY] += k_v * ey
        row[T_VV] -= k_v * row[T_PV]
        row[T_PV] -= k_p * row[T_PV]
        row[T_PP] -= k_p * row[T_PP]
        row[T_RADIUS] = max(c[C_RADIUS], 0.98 * row[T_RADIUS])
        row[T_FRESH] += 0.3 * (c[C_FRESH] - row[T_FRESH])
        row[T_HITS] += 1.0
        row[T_SEEN] = now


@njit(cache=True)
def hidden(x, y, free_at, x0, y0, resolution, since):
    """Whether the cell at (x, y) was not seen free ``since``."""
    r, c = int(math.floor((y - y0) / resolution)), int(math.floor((x - x0) / resolution))
    inside = 0 <= r < free_at.shape[0] and 0 <= c < free_at.shape[1]
    return not inside or free_at[r, c] < since


@njit(cache=True)
def lurk(tracks, dt, free_at, x0, y0, resolution, since):
    """Keeps movers that are out of sight where they can be: not where space was seen free ``since``.

    One that would come into view stays behind the edge; where its hiding place has come into view,
    it has gone on to the next along its way, up to ``HIDING`` metres, or is lost (T_SEEN -inf).
    (T_X0, T_Y0) is the nearest to where it was seen last that is hidden: it may come back any time.
    """
    where = (free_at, x0, y0, resolution, since)
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_MOVING] == 0.0:
            continue
        if row[T_CLUSTER] >= 0.0:
            row[T_X0], row[T_Y0] = row[T_X], row[T_Y]
            continue
        row[T_PP] = min(row[T_PP], 0.09)
        row[T_VV] = min(row[T_VV], 0.25)
        speed = max(math.hypot(row[T_VX], row[T_VY]), 1e-6)
        ux, uy = row[T_VX] / speed, row[T_VY] / speed
        if not hidden(row[T_X], row[T_Y], *where):
            row[T_X] -= row[T_VX] * dt
            row[T_Y] -= row[T_VY] * dt
        for column in (T_X, T_X0):
            gone = 0.0
            while gone <= HIDING and not hidden(
                row[column] + gone * ux, row[column + 1] + gone * uy, *where
            ):
                gone += resolution
            if gone > HIDING:
                row[T_SEEN] = -np.inf
            row[column] += gone * ux
            row[column + 1] += gone * uy


@njit(cache=True)
def judge(tracks, now, scans, slowest, fastest, fresh_share, rest_time):
    """Decides which tracks move; returns those confirmed just now (bool per track).

    A track moves once ``scans`` scans agree, it is significantly faster than ``slowest``, has left
    where it was first seen, and mostly lies in space that was seen free before. It rests again
    after ``rest_time`` seconds below the speed.
    """
    confirmed = np.zeros(len(tracks), np.bool_)
    for t in range(len(tracks)):
        row = tracks[t]
        speed = math.hypot(row[T_VX], row[T_VY])
        if speed > fastest:  # two things taken for one
            row[T_MOVING], row[T_HITS], row[T_VX], row[T_VY] = 0.0, 1.0, 0.0, 0.0
            row[T_X0], row[T_Y0], row[T_PV], row[T_VV] = row[T_X], row[T_Y], 0.0, 1.0
            speed = 0.0
        row[T_TOP] = max(speed, TOP_KEPT * row[T_TOP]) if row[T_MOVING] > 0.0 else 0.0
        if row[T_MOVING] > 0.0:
            if speed > 0.5 * slowest:
                row[T_SLOW_SINCE] = now
            elif now - row[T_SLOW_SINCE] > rest_time:
                row[T_MOVING] = 0.0
                row[T_X0], row[T_Y0] = row[T_X], row[T_Y]
        elif row[T_CLUSTER] >= 0.0 and row[T_HITS] >= scans:
            gone = math.hypot(row[T_X] - row[T_X0], row[T_Y] - row[T_Y0])
            sure = speed > slowest and speed > 2.0 * math.sqrt(row[T_VV])
            if sure and gone > 0.1 and row[T_FRESH] > fresh_share:
                row[T_MOVING] = 1.0
                row[T_SLOW_SINCE] = now
                confirmed[t] = True
    return confirmed


@njit(cache=True)
def on_tracks(points, tracks, found, margin):
    """Which points belong to something that moves: of its cluster, or within its disc and a margin."""
    moving = np.zeros(len(points), np.bool_)
    n = len(points)
    for t in range(len(tracks)):
        row = tracks[t]
        if row[T_MOVING] == 0.0 or row[T_CLUSTER] < 0.0:
            continue
        if row[T_CLUSTER] >= 0.0:
            c = found[int(row[T_CLUSTER])]
            for k in range(int(c[C_FIRST]), int(c[C_LAST]) + 1):
                moving[k % n] = True
        reach = row[T_RADIUS] + margin
        for i in range(n):
            dx, dy = points[i, 0] - row[T_X], points[i, 1] - row[T_Y]
            if dx * dx + dy * dy < reach * reach:
                moving[i] = True
    return moving
