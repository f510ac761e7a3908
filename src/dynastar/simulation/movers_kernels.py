"""Where scripted discs are, and how far a footprint is from them."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit

Floats = npt.NDArray[np.float64]

LOOP, BACK_AND_FORTH, STAY, VANISH = 0, 1, 2, 3


@njit(cache=True)
def positions(
    time: float,
    firsts: npt.NDArray[np.int64],
    times: Floats,
    points: Floats,
    after: npt.NDArray[np.int64],
    out: Floats,
) -> None:
    """Writes where every mover is at ``time`` (s) to ``out`` (m, 2), NaN for one that is not there.

    Mover i owns rows ``firsts[i]`` to ``firsts[i + 1]`` of ``times`` (k,) and ``points`` (k, 2).
    """
    for i in range(len(after)):
        first, last = firsts[i], firsts[i + 1] - 1
        begin, end = times[first], times[last]
        span, at = end - begin, time
        if after[i] == VANISH and not begin <= time <= end:
            out[i, 0] = out[i, 1] = math.nan
            continue
        if time > begin and span > 0.0:
            if after[i] == LOOP:
                at = begin + (time - begin) % span
            elif after[i] == BACK_AND_FORTH:
                away = (time - begin) % (2.0 * span)
                at = begin + min(away, 2.0 * span - away)
        before, beyond = first, last
        while beyond - before > 1:  # bisection: the keys before and beyond that time
            middle = (before + beyond) // 2
            if times[middle] <= at:
                before = middle
            else:
                beyond = middle
        fraction = 0.0
        if beyond > before:
            fraction = (at - times[before]) / (times[beyond] - times[before])
            fraction = min(max(fraction, 0.0), 1.0)
        for axis in range(2):
            step = points[beyond, axis] - points[before, axis]
            out[i, axis] = points[before, axis] + fraction * step


@inner
def point_gap(x: float, y: float, vertices: Floats) -> float:
    """Distance from a point to a convex polygon (k, 2), counter-clockwise; 0 inside."""
    nearest, inside = math.inf, True
    for i in range(len(vertices)):
        ax, ay = vertices[i - 1]
        ex, ey = vertices[i, 0] - ax, vertices[i, 1] - ay
        px, py = x - ax, y - ay
        if ex * py - ey * px < 0.0:
            inside = False
        along = min(max((px * ex + py * ey) / (ex * ex + ey * ey), 0.0), 1.0)
        nearest = min(nearest, math.hypot(px - along * ex, py - along * ey))
    return 0.0 if inside else nearest


@njit(cache=True)
def disc_gap(
    x: float,
    y: float,
    theta: float,
    vertices: Floats,
    radius: float,
    centres: Floats,
    radii: Floats,
) -> float:
    """Smallest gap (m) from a footprint at a pose to discs; inf without any, <= 0 at contact.

    The footprint is the polygon ``vertices`` (k, 2) or, where that is empty, a disc of ``radius``.
    """
    cos, sin = math.cos(theta), math.sin(theta)
    smallest = math.inf
    for i in range(len(radii)):
        dx, dy = centres[i, 0] - x, centres[i, 1] - y
        if math.isnan(dx):
            continue
        if len(vertices) == 0:
            gap = math.hypot(dx, dy) - radius
        else:
            gap = point_gap(cos * dx + sin * dy, cos * dy - sin * dx, vertices)
        smallest = min(smallest, gap - radii[i])
    return smallest
