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
KNOWN = (
    0.05  # of the weights of the four cells round a point, to interpolate between the known ones
)


class CostToGo(NamedTuple):
    """The cost-to-go (m): ``value`` is inf where it is not known, ``filled`` finite everywhere.

    (``descent_x``, ``descent_y``) is the unit vector in which it falls at each cell's centre.
    """

    value: Field
    filled: Floats
    descent_x: Floats
    descent_y: Floats


@njit(cache=True)
def value_at(cost_to_go, x, y):
    """The cost-to-go (m) at a point: bilinear between the cells where it is known."""
    row, column, up, right = locate(cost_to_go.value, x, y)
    values = cost_to_go.value.values
    total = weight = 0.0
    for i in range(2):
        for j in range(2):
            value = values[np.uint64(row + i), np.uint64(column + j)]
            if value < np.inf:
                w = (up if i else 1.0 - up) * (right if j else 1.0 - right)
                total += w * value
                weight += w
    if weight > KNOWN:
        return total / weight
    return cost_to_go.filled[row + (up > 0.5), column + (right > 0.5)]


@inner
def direction_at(cost_to_go, x, y):
    """Direction of the descent at a point, nearly a unit vector: bilinear where it is known."""
    row, column, up, right = locate(cost_to_go.value, x, y)
    values = cost_to_go.value.values
    ux = uy = weight = 0.0
    for i in range(2):
        for j in range(2):
            r, c = np.uint64(row + i), np.uint64(column + j)
            if values[r, c] < np.inf:
                w = (up if i else 1.0 - up) * (right if j else 1.0 - right)
                ux += w * cost_to_go.descent_x[r, c]
                uy += w * cost_to_go.descent_y[r, c]
                weight += w
    if weight > KNOWN:
        return ux, uy
    row, column = row + (up > 0.5), column + (right > 0.5)
    return cost_to_go.descent_x[row, column], cost_to_go.descent_y[row, column]


@inner
def turn_to_descent(cost_to_go, pose, ahead):
    """Angle (rad, -pi to pi) from a pose's heading to the descent ``ahead`` m in front of it."""
    ux, uy = direction_at(cost_to_go, pose.x + ahead * pose.cos, pose.y + ahead * pose.sin)
    return math.atan2(pose.cos * uy - pose.sin * ux, pose.cos * ux + pose.sin * uy)


@njit(cache=True)
def find_descent(cost_to_go):
    """Write the unit vector in which the cost-to-go falls at each cell.

    Differences are taken to the lower neighbour of each axis, as the marching did, so that walls
    have no part in them. (0, 0) where the value is least, and in the outermost cells.
    """
    descent_x, descent_y = cost_to_go.descent_x, cost_to_go.descent_y
    rows, columns = cost_to_go.filled.shape
    descent_x[:] = 0.0
    descent_y[:] = 0.0
    for r in range(1, rows - 1):
        for c in range(1, columns - 1):
            values = cost_to_go.value.values
            if values[r, c] == np.inf:
                values = cost_to_go.filled
            here, west, east = values[r, c], values[r, c - 1], values[r, c + 1]
            south, north = values[r - 1, c], values[r + 1, c]
            gx = max(0.0, here - min(west, east)) * (1.0 if east < west else -1.0)
            gy = max(0.0, here - min(south, north)) * (1.0 if north < south else -1.0)
            steep = math.sqrt(gx * gx + gy * gy)
            if 0.0 < steep < np.inf:
                descent_x[r, c], descent_y[r, c] = gx / steep, gy / steep


@njit(cache=True)
def trace(cost_to_go, x, y, line):
    """Write points along the steepest descent from (x, y) to ``line`` (n, 2); returns how many."""
    step = cost_to_go.value.resolution
    for k in range(len(line)):
        line[k, 0], line[k, 1] = x, y
        ux, uy = direction_at(cost_to_go, x, y)
        steep = math.sqrt(ux * ux + uy * uy)
        if steep < 1e-9 or value_at(cost_to_go, x, y) < 2.0 * step:
            return k + 1
        x, y = x + step * ux / steep, y + step * uy / steep
    return len(line)
