"""The cost-to-go over the local map: metres left to the goal, weighted by closeness to obstacles.

A navigation function: the Eikonal equation |grad V| = cost, solved outwards from where the global
path leaves the local map, by fast marching [Sethian1996].
"""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.dwa.objective import contact_probability

NEAR_COST = 4.0  # extra cost of a metre right at the margin of an obstacle
MEETING_COST = 15.0  # of a metre where a moving obstacle is met for certain
WALL_COST = 40.0  # of a metre through what cannot be driven: values there only lead out of it


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
    drives straight there at ``speed`` arrives. ``frame`` is (resolution, x0, y0), ``robot`` (x, y),
    ``radius`` its own (m), ``timing`` (begin, step) of the predictions in seconds.
    """
    resolution, x0, y0 = frame
    begin, step = timing
    rows, columns = cost.shape
    for m in range(people.mean.shape[0]):
        near = radius + people.now[m, 4]
        for h in range(people.mean.shape[1]):
            for k in range(people.mean.shape[2]):
                spread = people.spread[k]
                reach = near + 2.0 * spread
                x, y = people.mean[m, h, k, 0], people.mean[m, h, k, 1]
                t = begin + (k + 1) * step
                far = math.hypot(x - robot[0], y - robot[1])
                if abs(far - speed * t) > reach + speed * step:
                    continue
                first = max(0, int((y - reach - y0) / resolution))
                last = min(rows - 1, int((y + reach - y0) / resolution))
                low = max(0, int((x - reach - x0) / resolution))
                high = min(columns - 1, int((x + reach - x0) / resolution))
                for row in range(first, last + 1):
                    cy = y0 + (row + 0.5) * resolution
                    for column in range(low, high + 1):
                        cx = x0 + (column + 0.5) * resolution
                        arrives = math.hypot(cx - robot[0], cy - robot[1]) / speed
                        if abs(arrives - t) > 0.5 * step:
                            continue
                        gap = math.hypot(cx - x, cy - y) - near
                        if gap < 2.0 * spread:
                            p = people.weights[h] * contact_probability(gap, spread)
                            cost[row, column] += MEETING_COST * p


@njit(cache=True, inline="always")
def push(keys, nodes, n, key, node):
    """Adds to a binary heap of ``n`` entries."""
    i = n
    while i > 0 and keys[(i - 1) >> 1] > key:
        keys[i], nodes[i] = keys[(i - 1) >> 1], nodes[(i - 1) >> 1]
        i = (i - 1) >> 1
    keys[i], nodes[i] = key, node
    return n + 1


@njit(cache=True, inline="always")
def pop(keys, nodes, n):
    """Takes the least from a binary heap of ``n`` entries: its key, its node, how many are left."""
    key, node = keys[0], nodes[0]
    n -= 1
    last_key, last_node, i = keys[n], nodes[n], 0
    while 2 * i + 1 < n:
        j = 2 * i + 1
        if j + 1 < n and keys[j + 1] < keys[j]:
            j += 1
        if keys[j] >= last_key:
            break
        keys[i], nodes[i] = keys[j], nodes[j]
        i = j
    keys[i], nodes[i] = last_key, last_node
    return key, node, n


@njit(cache=True)
def march(cost, resolution, seed, stop, beyond, value, keys, nodes):  # arrays are made once
    """Fast marching from ``seed`` (row, column, value); fills ``value``, inf where not reached.

    Ends ``beyond`` metres after the value at ``stop`` (row, column) is known. ``keys`` and ``nodes``
    are room for a heap, four entries a cell.
    """
    row, column, begin = seed
    rows, columns = cost.shape
    value[:] = np.inf
    settled = np.zeros((rows, columns), np.bool_)
    value[row, column] = begin
    n = push(keys, nodes, 0, begin, row * columns + column)
    limit = np.inf
    while n > 0:
        key, node, n = pop(keys, nodes, n)
        r, c = node // columns, node % columns
        if settled[r, c]:
            continue
        if key > limit:
            break
        settled[r, c] = True
        if r == stop[0] and c == stop[1]:
            limit = key + beyond
        for k in range(4):
            a, b = r + (k == 0) - (k == 1), c + (k == 2) - (k == 3)
            if a < 0 or b < 0 or a >= rows or b >= columns or settled[a, b]:
                continue
            if cost[a, b] == np.inf:
                continue
            across, along = np.inf, np.inf
            if b > 0 and settled[a, b - 1]:
                across = value[a, b - 1]
            if b < columns - 1 and settled[a, b + 1]:
                across = min(across, value[a, b + 1])
            if a > 0 and settled[a - 1, b]:
                along = value[a - 1, b]
            if a < rows - 1 and settled[a + 1, b]:
                along = min(along, value[a + 1, b])
            step = cost[a, b] * resolution
            apart = across - along
            if abs(apart) < step:
                new = 0.5 * (across + along + math.sqrt(2.0 * step * step - apart * apart))
            else:
                new = min(across, along) + step
            if new < value[a, b]:
                value[a, b] = new
                n = push(keys, nodes, n, new, a * columns + b)
    for r in range(rows):
        for c in range(columns):
            if not settled[r, c]:
                value[r, c] = np.inf


@njit(cache=True)
def extend(cost, value, resolution, filled):
    """Writes ``value`` to ``filled`` and, where it is not known, values that lead to where it is."""
    rows, columns = value.shape
    step = WALL_COST * resolution
    for r in range(rows):
        for c in range(columns):
            filled[r, c] = value[r, c]
            if value[r, c] == np.inf:
                if r > 0:
                    filled[r, c] = min(filled[r, c], filled[r - 1, c] + step)
                if c > 0:
                    filled[r, c] = min(filled[r, c], filled[r, c - 1] + step)
    for r in range(rows - 1, -1, -1):
        for c in range(columns - 1, -1, -1):
            if value[r, c] == np.inf:
                if r < rows - 1:
                    filled[r, c] = min(filled[r, c], filled[r + 1, c] + step)
                if c < columns - 1:
                    filled[r, c] = min(filled[r, c], filled[r, c + 1] + step)


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
def descent(ahead, r, c):
    """Unit vector in which the cost-to-go falls most steeply at a cell, (0, 0) where it is least.

    Differences are taken to the lower neighbour of each axis, as the marching did, so that walls
    have no part in them.
    """
    values = ahead.value if ahead.value[r, c] < np.inf else ahead.filled
    rows, columns = values.shape
    here = values[r, c]
    west = values[r, c - 1] if c > 0 else np.inf
    east = values[r, c + 1] if c < columns - 1 else np.inf
    south = values[r - 1, c] if r > 0 else np.inf
    north = values[r + 1, c] if r < rows - 1 else np.inf
    gx = max(0.0, here - min(west, east)) * (1.0 if east < west else -1.0)
    gy = max(0.0, here - min(south, north)) * (1.0 if north < south else -1.0)
    steep = math.hypot(gx, gy)
    if not 0.0 < steep < np.inf:
        return 0.0, 0.0
    return gx / steep, gy / steep


@njit(cache=True)
def direction_at(ahead, x, y):
    """``descent`` at a point, bilinear between cells where it is known; each is worked out once."""
    rows, columns = ahead.value.shape
    fx = (x - ahead.x0) / ahead.resolution - 0.5
    fy = (y - ahead.y0) / ahead.resolution - 0.5
    fx, fy = min(max(fx, 0.0), columns - 1.001), min(max(fy, 0.0), rows - 1.001)
    c, r = int(fx), int(fy)
    a, b = fx - c, fy - r
    ux = uy = weight = 0.0
    for i in range(2):
        for j in range(2):
            if ahead.value[r + i, c + j] < np.inf:
                cell = ahead.slope[r + i, c + j]
                if math.isnan(cell[0]):
                    cell[0], cell[1] = descent(ahead, r + i, c + j)
                w = (b if i else 1.0 - b) * (a if j else 1.0 - a)
                ux += w * cell[0]
                uy += w * cell[1]
                weight += w
    if weight > 0.05:
        return ux, uy
    return descent(ahead, r + (b > 0.5), c + (a > 0.5))


@njit(cache=True)
def trace(ahead, x, y, line):
    """Writes points along the steepest descent from (x, y) to ``line`` (n, 2); returns how many."""
    h = ahead.resolution
    for k in range(len(line)):
        line[k, 0], line[k, 1] = x, y
        ux, uy = direction_at(ahead, x, y)
        steep = math.hypot(ux, uy)
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
