"""Kernels of the local map: what a scan frees and what it marks."""

import math

import numpy as np

from dynastar.compiled import njit

NEVER = -1e18

# arctan(q) / q for q from 0 to 1, a polynomial in q^2 (least squares at Chebyshev's points).
ARCTAN = (
    0.9999999937572817, -0.3333313797589671, 0.1999369407969238, -0.14211102809968626,
    0.10667470051931369, -0.07556856635617266, 0.04327764435842116, -0.016412774889647392,
    0.0029326465686708813,
)  # fmt: skip
ARCTAN_ERROR = 1.5e-8  # rad


@njit(cache=True)
def free_ranges(ranges, limits, increment, full_circle, errors, narrowest):
    """Range (m) up to which space is observed free between beam i and beam i + 1, (n,).

    As far as the shorter of the two, less the error of a range and half the gap (a corner may stand
    out that far between two beams), while the gap is narrower than the narrowest obstacle. A
    heading error takes the minimum over the neighbours that it could swap in. ``limits`` are range_min
    and range_max, ``errors`` those of a range (m) and of the heading (rad).
    """
    (range_min, range_max), (range_error, heading_error) = limits, errors
    n = len(ranges)
    reach = np.empty(n)
    for i in range(n):
        r = float(ranges[i])
        if r == np.inf:
            reach[i] = range_max
        elif r > 0.0 and range_min <= r <= range_max * 1.001:
            reach[i] = min(r, range_max)
        else:  # NaN, -inf, 0, blind or out of range: says nothing
            reach[i] = 0.0
    step = abs(increment)
    widest = narrowest / step if step > 0.0 else range_max
    gaps = np.zeros(n)
    for i in range(n if full_circle else n - 1):
        r = min(reach[i], reach[(i + 1) % n])
        gaps[i] = max(0.0, min(r - range_error - 0.5 * r * step, widest))
    swap = int(math.ceil(heading_error / step)) if heading_error > 0.0 else 0
    if swap == 0:
        return gaps
    low = np.zeros(n)
    for i in range(n):
        least = gaps[i]
        for k in range(-swap, swap + 1):
            j = i + k
            if full_circle:
                least = min(least, gaps[j % n])
            elif 0 <= j < n - 1:
                least = min(least, gaps[j])
        low[i] = least
    return low


@njit(cache=True, inline="always")
def bearing(dx, dy):
    """atan2(dy, dx) without branches, right to ``ARCTAN_ERROR``; 0 at the origin."""
    up, along = abs(dy), abs(dx)
    q = min(along, up) / max(max(along, up), 1e-12)
    s = q * q
    series = ARCTAN[8]
    for i in range(7, -1, -1):
        series = ARCTAN[i] + s * series
    angle = q * series
    angle = 0.5 * math.pi - angle if up > along else angle
    angle = math.pi - angle if dx < 0.0 else angle
    return -angle if dy < 0.0 else angle


@njit(cache=True, fastmath={"nnan", "nsz", "contract"}, error_model="numpy")
def beams_of(offset, resolution, first, per_step, period, last, turns):
    """The beams, in fractions, that a row of cells lies at: ``offset`` (dy, left) m from the sensor.

    ``first`` is the first beam's angle, ``period`` a whole turn in beams; what is beyond ``last`` is
    that. Without branches, so that several cells go at once; the arctangent is right to ``ARCTAN_ERROR``.
    """
    dy, left = offset
    per_period = 1.0 / period
    for k in range(turns.size):
        dx = left + np.float64(np.int32(k)) * resolution
        turn = (bearing(dx, dy) - first) * per_step
        turns[k] = min(turn - period * math.floor(turn * per_period), last)


@njit(cache=True)
def mark_free(free_at, frame, gaps, beams, full_circle, sensor, now):
    """Stamps ``now`` into ``free_at`` for every cell whose centre lies in observed-free space.

    ``frame`` is the window's (resolution, x0, y0), ``beams`` their first angle and increment,
    ``sensor`` its pose in the map frame. A cell that is on the verge of two gaps counts by the smaller.
    """
    resolution, x0, y0 = frame
    angle_min, increment = beams
    x, y, theta = sensor
    rows, columns = free_at.shape
    n, far = len(gaps), gaps.max()
    if increment == 0.0 or far <= 0.0:
        return
    squares = np.full(n + 3, -1.0)  # of the gap after each beam, from one before the first
    for i in range(n):
        if gaps[i] > 0.0:
            squares[i + 1] = gaps[i] * gaps[i]
    if full_circle:
        squares[0] = squares[n + 1] = squares[n]
    period = 2.0 * math.pi / abs(increment)
    verge = min(1e-4 + 2.0 * ARCTAN_ERROR / abs(increment), 0.5)  # beams
    turns = np.empty(columns)
    for row in range(rows):
        dy = y0 + (row + 0.5) * resolution - y
        if abs(dy) > far:
            continue
        half = math.sqrt(far * far - dy * dy)
        low = max(0, int(math.floor((x - half - x0) / resolution)))
        count = min(columns - 1, int(math.floor((x + half - x0) / resolution))) - low + 1
        if count <= 0:
            continue
        left = x0 + (low + 0.5) * resolution - x
        here = turns[:count]
        first, offset = theta + angle_min, (dy, left)
        beams_of(offset, resolution, first, 1.0 / increment, period, n + 0.5, here)
        cells = free_at[row, low : low + count]
        for k in range(count):
            dx = left + k * resolution
            one, other = np.uint64(here[k] + (1.0 - verge)), np.uint64(here[k] + (1.0 + verge))
            inside = dx * dx + dy * dy <= min(squares[one], squares[other])
            cells[k] = now if inside else cells[k]


@njit(cache=True)
def mark_hits(hit_at, frame, points, moving, now):
    """Stamps ``now`` into ``hit_at`` where a point that does not move lies."""
    resolution, x0, y0 = frame
    rows, columns = hit_at.shape
    for i in range(len(points)):
        if moving[i]:
            continue
        row = int(math.floor((points[i, 1] - y0) / resolution))
        column = int(math.floor((points[i, 0] - x0) / resolution))
        if 0 <= row < rows and 0 <= column < columns:
            hit_at[row, column] = now


@njit(cache=True)
def box_of_disc(shape, frame, disc):
    """The first and last row and column of a window of that shape that a disc may reach into."""
    (resolution, x0, y0), (x, y, radius) = frame, disc
    rows, columns = shape
    first = max(0, int(math.floor((y - radius - y0) / resolution)))
    last = min(rows - 1, int(math.floor((y + radius - y0) / resolution)))
    low = max(0, int(math.floor((x - radius - x0) / resolution)))
    high = min(columns - 1, int(math.floor((x + radius - x0) / resolution)))
    return first, last, low, high


@njit(cache=True)
def mark_disc(stamps, frame, disc, value):
    """Writes ``value`` into the cells with their centre in a disc."""
    (resolution, x0, y0), (x, y, radius) = frame, disc
    first, last, low, high = box_of_disc(stamps.shape, frame, disc)
    for row in range(first, last + 1):
        dy = y0 + (row + 0.5) * resolution - y
        for column in range(low, high + 1):
            dx = x0 + (column + 0.5) * resolution - x
            if dx * dx + dy * dy <= radius * radius:
                stamps[row, column] = value


@njit(cache=True)
def keep_free(free_at, hit_at, frame, disc, now):
    """Stamps ``now`` into the cells of a disc that were seen free since they were hit."""
    (resolution, x0, y0), (x, y, radius) = frame, disc
    first, last, low, high = box_of_disc(free_at.shape, frame, disc)
    for row in range(first, last + 1):
        dy = y0 + (row + 0.5) * resolution - y
        for column in range(low, high + 1):
            dx = x0 + (column + 0.5) * resolution - x
            inside = dx * dx + dy * dy <= radius * radius
            if inside and hit_at[row, column] < free_at[row, column] < now:
                free_at[row, column] = now


@njit(cache=True)
def compose_states(free_at, hit_at, barred, horizon, states, open_):
    """States from stamps: 0 unseen, 1 free, 2 occupied; what is older than ``horizon`` is unseen.

    ``open_`` (uint8) is 1 where the robot may be: observed free and not barred; the rim is closed.
    Without branches, so that several cells go at once.
    """
    rows, columns = states.shape
    for row in range(rows):
        frees, hits, bars = free_at[row], hit_at[row], barred[row]
        row_states, row_open = states[row], open_[row]
        for column in range(columns):
            free, hit = frees[column], hits[column]
            is_occupied = (hit >= free) & (hit >= horizon)
            is_free = (free > hit) & (free >= horizon)
            row_states[column] = 2 * is_occupied + is_free
            row_open[column] = is_free & (not bars[column])
    open_[0], open_[rows - 1] = 0, 0
    open_[:, 0], open_[:, columns - 1] = 0, 0


@njit(cache=True)
def shift(source, target, rows, columns, fill):
    """Moves a window by (rows, columns) cells: target[r, c] = source[r + rows, c + columns]."""
    height, width = source.shape
    for row in range(height):
        for column in range(width):
            r, c = row + rows, column + columns
            if 0 <= r < height and 0 <= c < width:
                target[row, column] = source[r, c]
            else:
                target[row, column] = fill


@njit(cache=True)
def scan_points(ranges, limits, beams, sensor):
    """Where the beams ended: points (k, 2) in the map frame and the beam each came from (k,).

    ``limits`` are range_min and range_max, ``beams`` their first angle and increment.
    """
    (range_min, range_max), (angle_min, increment), (x, y, theta) = limits, beams, sensor
    n = len(ranges)
    points = np.empty((n, 2))
    hit_by = np.empty(n, np.int64)
    k = 0
    for i in range(n):
        r = float(ranges[i])
        if r > 0.0 and range_min <= r < range_max:
            angle = theta + angle_min + increment * i
            points[k, 0] = x + r * math.cos(angle)
            points[k, 1] = y + r * math.sin(angle)
            hit_by[k] = i
            k += 1
    return points[:k], hit_by[:k]
