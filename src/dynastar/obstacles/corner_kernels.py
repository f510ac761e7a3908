"""Blind corners: where a scan jumps from something near to something far, there is room to hide."""

import math

import numpy as np
from numba import njit

JUMP = 0.6  # m between neighbouring readings that something can hide behind


@njit(cache=True)
def blind_corners(ranges, range_min, range_max, angle_min, increment, x, y, theta):
    """The near ends (k, 2) of the jumps in a scan taken from (x, y, theta), in the map frame."""
    n = len(ranges)
    corners = np.empty((n, 2))
    k = 0
    full = n * abs(increment) > math.tau - 0.5 * abs(increment)
    for i in range(n if full else n - 1):
        a, b = float(ranges[i]), float(ranges[(i + 1) % n])
        if a == np.inf:
            a = range_max
        if b == np.inf:
            b = range_max
        if not (range_min <= a <= range_max and range_min <= b <= range_max) or min(a, b) <= 0.0:
            continue
        if abs(a - b) < JUMP:
            continue
        near, beam = (a, i) if a < b else (b, (i + 1) % n)
        angle = theta + angle_min + increment * beam
        corners[k, 0], corners[k, 1] = x + near * math.cos(angle), y + near * math.sin(angle)
        k += 1
    return corners[:k]


@njit(cache=True)
def nearest_corner(corners, x, y, theta, within):
    """Distance (m) to the nearest corner up to ``within`` rad off the heading, inf if there is none."""
    best = np.inf
    for i in range(len(corners)):
        dx, dy = corners[i, 0] - x, corners[i, 1] - y
        off = math.atan2(dy, dx) - theta
        if abs(math.atan2(math.sin(off), math.cos(off))) <= within:
            best = min(best, math.hypot(dx, dy))
    return best
