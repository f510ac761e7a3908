"""How near a footprint at a pose comes to space that was not observed free."""

import math

import numpy as np

from dynastar.compiled import njit


@njit(cache=True, inline="always")
def distance_at(field, x, y):
    """A lower bound of the distance (m) from a point to the nearest closed cell's centre, 0 outside.

    Bilinear between the field's cell centres; between them the distance to a point bends by at most
    resolution^2 / 4d, which is taken off.
    """
    rows, columns = field.distance.shape
    per_cell = 1.0 / field.resolution
    fx, fy = (x - field.x0) * per_cell - 0.5, (y - field.y0) * per_cell - 0.5
    if not ((fx >= 0.0) & (fy >= 0.0) & (fx < columns - 1.0) & (fy < rows - 1.0)):
        return 0.0
    c, r = int(fx), int(fy)
    a, b = fx - c, fy - r
    above, below = field.distance[np.uint64(r)], field.distance[np.uint64(r + 1)]
    i, j = np.uint64(c), np.uint64(c + 1)
    d = (1.0 - b) * ((1.0 - a) * above[i] + a * above[j]) + b * (
        (1.0 - a) * below[i] + a * below[j]
    )
    if d <= field.resolution:
        return max(0.0, d - 0.5 * field.resolution)
    return d - 0.25 * field.resolution * field.resolution / d


@njit(cache=True)
def polygon_distance(vertices, px, py):
    """Distance (m) from a point to a convex polygon in the same frame, 0 inside."""
    n = len(vertices)
    best = np.inf
    inside = True
    for i in range(n):
        ax, ay = vertices[i, 0], vertices[i, 1]
        bx, by = vertices[(i + 1) % n, 0], vertices[(i + 1) % n, 1]
        ex, ey = bx - ax, by - ay
        qx, qy = px - ax, py - ay
        if ex * qy - ey * qx < 0.0:
            inside = False
        s = min(1.0, max(0.0, (qx * ex + qy * ey) / (ex * ex + ey * ey)))
        dx, dy = qx - s * ex, qy - s * ey
        best = min(best, dx * dx + dy * dy)
    return 0.0 if inside else math.sqrt(best)


@njit(cache=True)
def body_distance(body, pose, x, y):
    """Distance (m) from a point to the footprint at ``pose`` (x, y, cos, sin), 0 inside."""
    dx, dy = x - pose[0], y - pose[1]
    if len(body.vertices) == 0:
        return max(0.0, math.hypot(dx, dy) - body.circumscribed)
    return polygon_distance(body.vertices, pose[2] * dx + pose[3] * dy, pose[2] * dy - pose[3] * dx)


@njit(cache=True)
def spare(field, body, margin, start, pose):
    """Metres left until a rule is broken for some closed cell; negative once it is, exact near 0.

    The rule: the footprint keeps ``margin`` from the centre of every closed cell; from one that was
    nearer when the footprint stood at ``start`` it keeps at least that distance.
    """
    d = distance_at(field, pose[0], pose[1])
    if d - body.circumscribed >= margin:
        return d - body.circumscribed - margin
    rows, columns = field.distance.shape
    reach = body.circumscribed + margin + field.resolution
    first = max(0, int((pose[1] - reach - field.y0) / field.resolution))
    last = min(rows - 1, int((pose[1] + reach - field.y0) / field.resolution))
    low = max(0, int((pose[0] - reach - field.x0) / field.resolution))
    high = min(columns - 1, int((pose[0] + reach - field.x0) / field.resolution))
    least = field.resolution
    for row in range(first, last + 1):
        y = field.y0 + (row + 0.5) * field.resolution
        column = low
        while column <= high:
            distance = field.distance[row, column]
            if distance > 0.0:  # no cell is closed nearer than that
                column += max(1, int(distance / field.resolution))
                continue
            x = field.x0 + (column + 0.5) * field.resolution
            column += 1
            near = body_distance(body, pose, x, y)
            if near - margin >= least:
                continue
            allowed = min(margin, body_distance(body, start, x, y))
            least = min(least, near - allowed)
            if least < -1e-6:
                return least
    return least


@njit(cache=True)
def kept_margin(field, body, margin, pose):
    """The margin (m) that a robot at ``pose`` keeps from every closed cell.

    Noise may set a cell nearer to the robot than its margin. Beside a wall it could then move
    neither along it nor away, so it keeps what it has, but at least half of the margin, and half
    a cell's diagonal: the obstacle may stand anywhere in the cell.
    """
    nowhere = (1e9, 1e9, 1.0, 0.0)
    least = min(margin, max(0.5 * margin, field.resolution / math.sqrt(2.0)))
    return min(margin, max(least, spare(field, body, 0.0, nowhere, pose)))
