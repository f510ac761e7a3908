"""The cost-to-go over the local map: metres left to the goal, weighted by closeness to obstacles.

A navigation function: the Eikonal equation |grad V| = cost, solved outwards from where the global
path leaves the local map (``marching``).
"""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.objective import contact_probability

NEAR_COST = 4.0  # extra cost of a metre right at the margin of an obstacle
MEETING_COST = 15.0  # of a metre where a moving obstacle is met for certain


@njit(cache=True)
def travel_cost(distance, factor, margin, comfort, cost):
    """Writes the cost of a metre in every cell to ``cost``, inf where the robot does not fit.

    ``distance`` holds metres to the nearest obstacle on a grid ``factor`` times as fine; a cell has
    the clearance of the best of its parts. 1 + 4 (1 - clearance / comfort)^2, ``comfort`` m beyond
    ``margin`` m.
    """
    for row in range(cost.shape[0]):
        for column in range(cost.shape[1]):
            best = 0.0
            for i in range(factor):
                for j in range(factor):
                    best = max(best, distance[row * factor + i, column * factor + j])
            clear = best - margin
            if clear < 0.0:
                cost[row, column] = np.inf
            else:
                short = max(0.0, 1.0 - clear / comfort)
                cost[row, column] = 1.0 + NEAR_COST * short * short


@njit(cache=True)
def add_moving(cost, frame, people, timing, robot, radius, speed):
    """Adds what moving obstacles cost where the robot would meet them.

    A cell costs ``MEETING_COST`` times the probability of a contact at the time when a robot that
    drives straight there at ``speed`` arrives, discounted with that time as risk is. ``frame`` is
    (resolution, x0, y0), ``robot`` (x, y), ``radius`` its own (m), ``timing`` (begin, step) of the
    predictions in seconds.
    """
    resolution, x0, y0 = frame
    begin, step = timing
    rows, columns = cost.shape
    count, hypotheses, steps, _ = people.mean.shape
    if count == 0:
        return
    widest = 2.0 * people.spread[steps - 1]
    first_row, last_row = np.empty((count, hypotheses)), np.empty((count, hypotheses))
    first_column, last_column = np.empty((count, hypotheses)), np.empty((count, hypotheses))
    for m in range(count):
        reach = radius + people.now[m, 4] + widest
        for h in range(hypotheses):
            xs, ys = people.mean[m, h, :, 0], people.mean[m, h, :, 1]
            first_column[m, h] = (xs.min() - reach - x0) / resolution - 1.0
            last_column[m, h] = (xs.max() + reach - x0) / resolution
            first_row[m, h] = (ys.min() - reach - y0) / resolution - 1.0
            last_row[m, h] = (ys.max() + reach - y0) / resolution
    when = np.empty(columns, np.int64)  # the step at which the robot gets to each cell of a row
    for row in range(rows):
        y = y0 + (row + 0.5) * resolution
        for column in range(columns):
            dx, dy = x0 + (column + 0.5) * resolution - robot[0], y - robot[1]
            arrives = math.sqrt(dx * dx + dy * dy) / speed
            when[column] = min(int(math.floor((arrives - begin) / step - 0.5)), steps)
        for m in range(count):
            near = radius + people.now[m, 4]
            for h in range(hypotheses):
                if not first_row[m, h] <= row <= last_row[m, h]:
                    continue
                low = max(0, int(first_column[m, h]))
                high = min(columns - 1, int(last_column[m, h]))
                for column in range(low, high + 1):
                    k = when[column]
                    if k < 0 or k >= steps:
                        continue
                    spread = people.spread[k]
                    reach = near + 2.0 * spread
                    dx = x0 + (column + 0.5) * resolution - people.mean[m, h, k, 0]
                    dy = y - people.mean[m, h, k, 1]
                    square = dx * dx + dy * dy
                    if square < reach * reach:
                        p = contact_probability(math.sqrt(square) - near, spread)
                        p *= math.exp(-(begin + (k + 1) * step) / people.memory)
                        cost[row, column] += MEETING_COST * people.weights[h] * p


@njit(cache=True)
def nearest_open(cost, row, column, reach):
    """The nearest cell where the robot fits, up to ``reach`` cells away, else the cell itself."""
    rows, columns = cost.shape
    if cost[row, column] < np.inf:
        return row, column
    best_row, best_column, nearest = row, column, 2 * reach * reach + 1
    for i in range(max(row - reach, 0), min(row + reach + 1, rows)):
        for j in range(max(column - reach, 0), min(column + reach + 1, columns)):
            square = (i - row) * (i - row) + (j - column) * (j - column)
            if cost[i, j] < np.inf and square < nearest:
                best_row, best_column, nearest = i, j, square
    return best_row, best_column


@njit(cache=True)
def leave(points, arc, span, cost, frame, reach):
    """The cell (row, column) where a path leaves the field, or ends, and how far along it that is (m).

    Looked at are places half a cell apart from ``span[0]`` to ``span[1]`` m along the path (n, 2); the
    last before it leaves for the first time counts, or the next one back with a cell where the robot
    fits within ``reach`` cells.
    """
    resolution, x0, y0 = frame
    rows, columns = cost.shape
    begin, end = span
    count = max(2, int(math.ceil((end - begin) / (0.5 * resolution))) + 1)
    cells = np.empty((count, 2), np.int64)
    last, segment = count - 1, 0
    for k in range(count):
        s = begin + (end - begin) * k / (count - 1)
        while segment < len(arc) - 2 and arc[segment + 1] < s:
            segment += 1
        x, y = points[segment, 0], points[segment, 1]
        if len(arc) > 1:
            length = max(arc[segment + 1] - arc[segment], 1e-12)
            share = min(max((s - arc[segment]) / length, 0.0), 1.0)
            x += share * (points[segment + 1, 0] - x)
            y += share * (points[segment + 1, 1] - y)
        row, column = int(math.floor((y - y0) / resolution)), int(math.floor((x - x0) / resolution))
        cells[k, 0], cells[k, 1] = min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)
        if not (2 <= row < rows - 2 and 2 <= column < columns - 2):
            last = max(k - 1, 0)
            break
    for k in range(last, -1, -1):
        row, column = nearest_open(cost, cells[k, 0], cells[k, 1], reach)
        if cost[row, column] < np.inf:
            return row, column, begin + (end - begin) * k / (count - 1)
    return cells[last, 0], cells[last, 1], begin + (end - begin) * last / (count - 1)


@njit(cache=True)
def value_at(ahead, x, y):
    """The cost-to-go (m) at a point: bilinear between the cells where it is known."""
    rows, columns = ahead.value.shape
    fx = (x - ahead.x0) / ahead.resolution - 0.5
    fy = (y - ahead.y0) / ahead.resolution - 0.5
    fx, fy = min(max(fx, 0.0), columns - 1.001), min(max(fy, 0.0), rows - 1.001)
    c, r = int(fx), int(fy)
    a, b = fx - c, fy - r
    total = weight = 0.0
    for i in range(2):
        for j in range(2):
            v = ahead.value[r + i, c + j]
            if v < np.inf:
                w = (b if i else 1.0 - b) * (a if j else 1.0 - a)
                total += w * v
                weight += w
    if weight > 0.05:
        return total / weight
    return ahead.filled[r + (b > 0.5), c + (a > 0.5)]


@njit(cache=True)
def descend(value, filled, slope):
    """Writes the unit vector in which the cost-to-go falls at each cell to ``slope`` (n, n, 2).

    Differences are taken to the lower neighbour of each axis, as the marching did, so that walls
    have no part in them. (0, 0) where it is least, and in the outermost cells.
    """
    rows, columns = value.shape
    slope[:] = 0.0
    for r in range(1, rows - 1):
        for c in range(1, columns - 1):
            here, west, east, south, north = (
                value[r, c], value[r, c - 1], value[r, c + 1], value[r - 1, c], value[r + 1, c],
            )  # fmt: skip
            if here == np.inf:
                here, west, east, south, north = (
                    filled[r, c], filled[r, c - 1], filled[r, c + 1], filled[r - 1, c],
                    filled[r + 1, c],
                )  # fmt: skip
            gx = max(0.0, here - min(west, east)) * (1.0 if east < west else -1.0)
            gy = max(0.0, here - min(south, north)) * (1.0 if north < south else -1.0)
            steep = math.sqrt(gx * gx + gy * gy)
            if 0.0 < steep < np.inf:
                slope[r, c, 0], slope[r, c, 1] = gx / steep, gy / steep


@njit(cache=True)
def direction_at(ahead, x, y):
    """Where the cost-to-go falls at a point, about a unit vector: bilinear where it is known."""
    value, slope = ahead.value, ahead.slope
    rows, columns = value.shape
    fx = (x - ahead.x0) / ahead.resolution - 0.5
    fy = (y - ahead.y0) / ahead.resolution - 0.5
    fx, fy = min(max(fx, 0.0), columns - 1.001), min(max(fy, 0.0), rows - 1.001)
    c, r = int(fx), int(fy)
    a, b = fx - c, fy - r
    ux = uy = weight = 0.0
    for i in range(2):
        for j in range(2):
            row, column = np.uint64(r + i), np.uint64(c + j)
            if value[row, column] < np.inf:
                w = (b if i else 1.0 - b) * (a if j else 1.0 - a)
                ux += w * slope[row, column, 0]
                uy += w * slope[row, column, 1]
                weight += w
    if weight > 0.05:
        return ux, uy
    row, column = r + (b > 0.5), c + (a > 0.5)
    return slope[row, column, 0], slope[row, column, 1]


@njit(cache=True)
def trace(ahead, x, y, line):
    """Writes points along the steepest descent from (x, y) to ``line`` (n, 2); returns how many."""
    h = ahead.resolution
    for k in range(len(line)):
        line[k, 0], line[k, 1] = x, y
        ux, uy = direction_at(ahead, x, y)
        steep = math.sqrt(ux * ux + uy * uy)
        if steep < 1e-9 or value_at(ahead, x, y) < 2.0 * h:
            return k + 1
        x, y = x + h * ux / steep, y + h * uy / steep
    return len(line)


@njit(cache=True)
def favour(cost, frame, line, factor):
    """Scales the cost of the cells along a ``line`` (n, 2) and beside it, each once."""
    resolution, x0, y0 = frame
    rows, columns = cost.shape
    done = np.zeros((rows, columns), np.bool_)
    for k in range(len(line)):
        c, r = int((line[k, 0] - x0) / resolution), int((line[k, 1] - y0) / resolution)
        for i in range(max(r - 1, 0), min(r + 2, rows)):
            for j in range(max(c - 1, 0), min(c + 2, columns)):
                if not done[i, j]:
                    done[i, j] = True
                    cost[i, j] *= factor
