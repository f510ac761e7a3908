"""Kernels of the local map: what a scan frees and what it marks."""

import math

import numpy as np

from dynastar.compiled import allocating, njit, record

NEVER = -1e18
FREE_FOR = 1.0  # s that a cell is seen free before its earlier hits are forgotten


class HitBox:
    """The box of the hits in a cell, metres from the cell's centre."""

    low_x: np.float32
    high_x: np.float32
    low_y: np.float32
    high_y: np.float32


BOX = record(HitBox)


@allocating
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
def mark_free(layers, frame, gaps, sensor, lidar):
    """Stamp the scan's time into every cell whose centre lies in observed-free space.

    A newer stamp stays. ``layers`` are free_at and hit_by, of which the hits by this ``lidar`` (a bit) are
    cleared. ``frame`` is the window's (resolution, x0, y0), ``gaps`` (n,) are the ranges (m) from one beam
    to the next, the last one to the first beam. ``sensor`` is a Sensor.
    """
    free_at, hit_by = layers
    resolution, x0, y0 = frame
    x, y, first = sensor.x, sensor.y, sensor.theta + sensor.angle_min
    far = gaps.max()
    above = crossings(gaps, first, sensor.step, 1.0)
    below = crossings(gaps, first, sensor.step, -1.0)
    for row in range(free_at.shape[0]):
        dy = y0 + (row + 0.5) * resolution - y
        if abs(dy) > far:
            continue
        half = math.sqrt(far * far - dy * dy)
        low = max(0, int(math.floor((x - half - x0) / resolution)))
        high = min(free_at.shape[1] - 1, int(math.floor((x + half - x0) / resolution)))
        ends, squares = above if dy > 0.0 else below
        height = max(abs(dy), 1e-9)
        cells, hits, k, end = free_at[row], hit_by[row], 0, ends[0] * height
        for column in range(low, high + 1):
            dx = x0 + (column + 0.5) * resolution - x
            while dx > end:
                k += 1
                end = ends[k] * height
            if dx * dx + dy * dy < squares[k]:
                cells[column] = max(cells[column], sensor.stamp)
                hits[column] &= ~lidar


@njit(cache=True)
def mark_hits(layers, frame, points, moving, times, lidar):
    """Stamp the time where a point that does not move lies, and put it into the box of its cell.

    ``layers`` are free_at, hit_at, hit_by and the boxes, ``times`` now and since when hits are remembered,
    ``lidar`` is a bit. A box begins anew with the first hit after the cell was seen free for ``FREE_FOR``.
    """
    now, horizon = times
    free_at, hit_at, hit_by, boxes = layers
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
        forgotten = hit < horizon
        if forgotten:
            hit_by[row, column] = 0
        if forgotten or (hit_by[row, column] == 0 and free_at[row, column] > hit + FREE_FOR):
            box.low_x, box.high_x, box.low_y, box.high_y = x, x, y, y
        box.low_x, box.high_x = min(box.low_x, x), max(box.high_x, x)
        box.low_y, box.high_y = min(box.low_y, y), max(box.high_y, y)
        hit_at[row, column] = max(hit, now)
        hit_by[row, column] |= lidar


@njit(cache=True)
def scan_points(readings, sensor):
    """Where the beams ended: points (k, 2) in the map frame and the beam each came from (k,).

    ``readings`` are those of ``LaserScan.readings``, ``sensor`` is a Sensor.
    """
    n = len(readings)
    points = np.empty((n, 2))
    hit_by = np.empty(n, np.int64)
    k = 0
    for i in range(n):
        r = float(readings[i])
        if math.isfinite(r):
            angle = sensor.theta + sensor.angle_min + sensor.step * i
            points[k, 0] = sensor.x + r * math.cos(angle)
            points[k, 1] = sensor.y + r * math.sin(angle)
            hit_by[k] = i
            k += 1
    return points[:k], hit_by[:k]
