"""Kernels of the local map: what a scan frees and what it marks."""

import math

import numpy as np

from dynastar.compiled import inner, njit, record

NEVER = -1e18
FREE_FOR = 1.0  # s that a cell is seen free before its earlier hits are forgotten


class HitBox:
    """The box of the hits in a cell, metres from the cell's centre."""

    low_x: np.float32
    high_x: np.float32
    low_y: np.float32
    high_y: np.float32


BOX = record(HitBox)


@njit(cache=True)
def free_ranges(readings, range_max, increment, full_circle, errors, narrowest):
    """Range (m) up to which space is observed free between beam i and beam i + 1, (n,).

    As far as the shorter of the two, less the error of a range and half the gap (a corner may stand
    out that far between two beams), while the gap is narrower than the narrowest obstacle. A
    heading error takes the minimum over the neighbours that it could swap in. ``readings`` are those of
    ``LaserScan.readings``, ``errors`` those of a range (m) and of the heading (rad).
    """
    range_error, heading_error = errors
    n = len(readings)
    reach = np.empty(n)
    for i in range(n):
        r = float(readings[i])
        reach[i] = 0.0 if math.isnan(r) else min(r, range_max)
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


@inner
def crossings(gaps, first, increment, side):
    """Where beams cross a row 1 m above (side 1) or below (-1) the sensor, from left to right.

    Returns the crossings (k + 1,) in m from the sensor, the last at infinity, and the squared gaps
    (k + 1,) that end at each of them. ``first`` is the first beam's angle.
    """
    n = len(gaps)
    turn = -1 if side * increment > 0.0 else 1  # of the beams' indices, from left to right
    start, count = 0 if turn > 0 else n - 1, 0  # a side without beams is all in the last gap
    at = np.full(n, np.inf)
    for i in range(n):
        angle = first + i * increment
        height = side * math.sin(angle)
        if height > 0.0:
            count += 1
            at[i] = math.cos(angle) / height
            start = i if at[i] < at[start] else start
    ends, squares = np.full(count + 1, np.inf), np.empty(count + 1)
    for k in range(count + 1):
        i = (start + turn * k) % n
        if k < count:
            ends[k] = at[i]
        squares[k] = gaps[i - 1 if turn > 0 else i] ** 2
    return ends, squares


@njit(cache=True)
def mark_free(free_at, frame, gaps, beams, sensor, now):
    """Stamps ``now`` into ``free_at`` for every cell whose centre lies in observed-free space.

    ``frame`` is the window's (resolution, x0, y0), ``gaps`` (n,) are the ranges (m) from one beam to the
    next, the last one to the first beam. ``beams`` are their first angle and increment, ``sensor`` is
    its pose (x, y, theta).
    """
    resolution, x0, y0 = frame
    angle_min, increment = beams
    x, y, theta = sensor
    far = gaps.max()
    above = crossings(gaps, theta + angle_min, increment, 1.0)
    below = crossings(gaps, theta + angle_min, increment, -1.0)
    for row in range(free_at.shape[0]):
        dy = y0 + (row + 0.5) * resolution - y
        if abs(dy) > far:
            continue
        half = math.sqrt(far * far - dy * dy)
        low = max(0, int(math.floor((x - half - x0) / resolution)))
        high = min(free_at.shape[1] - 1, int(math.floor((x + half - x0) / resolution)))
        ends, squares = above if dy > 0.0 else below
        height = max(abs(dy), 1e-9)
        cells, k, end = free_at[row], 0, ends[0] * height
        for column in range(low, high + 1):
            dx = x0 + (column + 0.5) * resolution - x
            while dx > end:
                k += 1
                end = ends[k] * height
            if dx * dx + dy * dy < squares[k]:
                cells[column] = now


@njit(cache=True)
def mark_hits(layers, frame, points, moving, times):
    """Stamp the time where a point that does not move lies, and put it into the box of its cell.

    ``layers`` are free_at, hit_at and the boxes, ``times`` now and since when hits are remembered.
    A box begins anew with the first hit after the cell was seen free for ``FREE_FOR``.
    """
    now, horizon = times
    free_at, hit_at, boxes = layers
    resolution, x0, y0 = frame
    rows, columns = hit_at.shape
    for i in range(len(points)):
        if moving[i]:
            continue
        row = int(math.floor((points[i, 1] - y0) / resolution))
        column = int(math.floor((points[i, 0] - x0) / resolution))
        if not (0 <= row < rows and 0 <= column < columns):
            continue
        x = points[i, 0] - x0 - (column + 0.5) * resolution
        y = points[i, 1] - y0 - (row + 0.5) * resolution
        box, hit = boxes[row, column], hit_at[row, column]
        if hit < horizon or free_at[row, column] > hit + FREE_FOR:
            box.low_x, box.high_x, box.low_y, box.high_y = x, x, y, y
        box.low_x, box.high_x = min(box.low_x, x), max(box.high_x, x)
        box.low_y, box.high_y = min(box.low_y, y), max(box.high_y, y)
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
def scan_points(readings, beams, sensor):
    """Where the beams ended: points (k, 2) in the map frame and the beam each came from (k,).

    ``readings`` are those of ``LaserScan.readings``, ``beams`` their first angle and increment.
    """
    (angle_min, increment), (x, y, theta) = beams, sensor
    n = len(readings)
    points = np.empty((n, 2))
    hit_by = np.empty(n, np.int64)
    k = 0
    for i in range(n):
        r = float(readings[i])
        if math.isfinite(r):
            angle = theta + angle_min + increment * i
            points[k, 0] = x + r * math.cos(angle)
            points[k, 1] = y + r * math.sin(angle)
            hit_by[k] = i
            k += 1
    return points[:k], hit_by[:k]
