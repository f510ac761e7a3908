"""The cost-to-go over the local map: metres left to the goal, weighted by closeness to obstacles.

A navigation function: the Eikonal equation |grad V| = cost, solved outwards from where the global
path leaves the local map (``marching``). Here is how it is read: its value, its descent.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit
from dynastar.field import Field, locate

Floats = npt.NDArray[np.float64]
KNOWN = 0.05  # of the weights of the four cells round a point, to read those that are known


class End(NamedTuple):
    """The point (m) from which the values grow, the ``value`` there, and what a metre adds to it."""

    x: float
    y: float
    value: float
    per_metre: float


class CostToGo(NamedTuple):
    """The cost-to-go (m): ``value`` is inf where it is not known, ``filled`` finite everywhere.

    (``descent_x``, ``descent_y``) is the unit vector in which it falls at each cell's centre. Within a
    cell of its ``end`` it is a cone.
    """

    value: Field
    filled: Floats
    descent_x: Floats
    descent_y: Floats
    end: End


@inner
def read(cost_to_go, x, y):
    """The value (m) and the descent (x, y) at a point: bilinear between the cells where it is known.

    The descent is nearly a unit vector, (0, 0) at the end.
    """
    row, column, up, right = locate(cost_to_go.value, x, y)
    total = ux = uy = weight = 0.0
    for i in range(2):
        for j in range(2):
            r, c = np.uint64(row + i), np.uint64(column + j)
            value = cost_to_go.value.values[r, c]
            if value < np.inf:
                w = (up if i else 1.0 - up) * (right if j else 1.0 - right)
                total += w * value
                ux += w * cost_to_go.descent_x[r, c]
                uy += w * cost_to_go.descent_y[r, c]
                weight += w
    end = cost_to_go.end
    ahead_x, ahead_y = end.x - x, end.y - y
    away = math.sqrt(ahead_x * ahead_x + ahead_y * ahead_y)
    if away < cost_to_go.value.resolution and weight > KNOWN:
        unit = 1.0 / max(away, 1e-12)
        return end.value + away * end.per_metre, ahead_x * unit, ahead_y * unit
    if weight > KNOWN:
        return total / weight, ux, uy
    cell = row + (up > 0.5), column + (right > 0.5)
    return cost_to_go.filled[cell], cost_to_go.descent_x[cell], cost_to_go.descent_y[cell]


@njit(cache=True)
def value_at(cost_to_go, x, y):
    """The cost-to-go (m) at a point."""
    return read(cost_to_go, x, y)[0]


@inner
def turn_to_descent(cost_to_go, pose, ahead):
    """Angle (rad, -pi to pi) from a pose's heading to the descent ``ahead`` m in front of it."""
    _, ux, uy = read(cost_to_go, pose.x + ahead * pose.cos, pose.y + ahead * pose.sin)
    return math.atan2(pose.cos * uy - pose.sin * ux, pose.cos * ux + pose.sin * uy)


@njit(cache=True)
def with_descent(value, filled, end):
    """The CostToGo of a Field of values, with the unit vector in which they fall at each cell.

    Differences are taken to the lower neighbour of each axis, as the marching did, so that walls
    have no part in them. (0, 0) where the value is least, and in the outermost cells.
    """
    rows, columns = filled.shape
    descent_x, descent_y = np.zeros(filled.shape), np.zeros(filled.shape)
    for r in range(1, rows - 1):
        for c in range(1, columns - 1):
            values = value.values if value.values[r, c] < np.inf else filled
            here, west, east = values[r, c], values[r, c - 1], values[r, c + 1]
            south, north = values[r - 1, c], values[r + 1, c]
            gx = max(0.0, here - min(west, east)) * (1.0 if east < west else -1.0)
            gy = max(0.0, here - min(south, north)) * (1.0 if north < south else -1.0)
            steep = math.sqrt(gx * gx + gy * gy)
            if 0.0 < steep < np.inf:
                descent_x[r, c], descent_y[r, c] = gx / steep, gy / steep
    return CostToGo(value, filled, descent_x, descent_y, end)


@njit(cache=True)
def trace(cost_to_go, x, y, most):
    """Points (n, 2) along the steepest descent from (x, y), ``most`` at the most."""
    line, step = np.empty((most, 2)), cost_to_go.value.resolution
    for k in range(most):
        line[k, 0], line[k, 1] = x, y
        left, ux, uy = read(cost_to_go, x, y)
        steep = math.sqrt(ux * ux + uy * uy)
        if steep < 1e-9 or left < 2.0 * step:
            return line[: k + 1]
        x, y = x + step * ux / steep, y + step * uy / steep
    return line
