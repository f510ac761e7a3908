"""How near a footprint at a pose comes to space that was not observed free."""

import math

import numpy as np

from dynastar.compiled import njit


@njit(cache=True, inline="always")
def centre_clearance(field, x0, y0, resolution, x, y):
    """A lower bound of the distance (m) from a point to the nearest closed cell's centre.

    Bilinear between the field's cell centres; the distance to a point bends by at most
    resolution^2 / 4d between them, which is taken off.
    """
    rows, columns = field.shape
    per_cell = 1.0 / resolution  # the same for all calls of a loop, which the compiler sees
    fx, fy = (x - x0) * per_cell - 0.5, (y - y0) * per_cell - 0.5
    inside = (fx >= 0.0) & (fy >= 0.0) & (fx < columns - 1.0) & (fy < rows - 1.0)  # one branch
    if not inside:
        return 0.0
    c, r = int(fx), int(fy)
    a, b = fx - c, fy - r
    above, below = field[np.uint64(r)], field[np.uint64(r + 1)]
    i, j = np.uint64(c), np.uint64(c + 1)
    d = (1.0 - b) * ((1.0 - a) * above[i] + a * above[j]) + b * (
        (1.0 - a) * below[i] + a * below[j]
    )
    if d <= resolution:
        return max(0.0, d - 0.5 * resolution)
    return d - 0.25 * resolution * resolution / d


@njit(cache=True)
def path_clearance(field, x0, y0, resolution, path):
    """The smallest ``centre_clearance`` along a path's points (n, 2) that lie in the window."""
    rows, columns = field.shape
    least = np.inf
    for i in range(len(path)):
        c, r = (path[i, 0] - x0) / resolution, (path[i, 1] - y0) / resolution
        if 1.0 <= c < columns - 1.0 and 1.0 <= r < rows - 1.0:
            least = min(least, centre_clearance(field, x0, y0, resolution, path[i, 0], path[i, 1]))
    return least


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
        s = (qx * ex + qy * ey) / (ex * ex + ey * ey)
        s = min(1.0, max(0.0, s))
        dx, dy = qx - s * ex, qy - s * ey
        best = min(best, dx * dx + dy * dy)
    return 0.0 if inside else math.sqrt(best)


@njit(cache=True)
def footprint_clearance(around, body, enough, x, y, cos, sin):
    """A lower bound of the distance (m) from the footprint to the nearest closed cell's centre.

    ``around`` is a ``Surroundings``, ``body`` a ``Body``, the heading is given by its cosine and
    sine. Exact for polygons up to ``enough``
    metres: the circles decide first, then every closed cell near.
    """
    field, x0, y0, resolution, _ = around
    vertices, _, inscribed, circumscribed = body
    d = centre_clearance(field, x0, y0, resolution, x, y)
    if len(vertices) == 0 or d - circumscribed >= enough:
        return d - circumscribed
    if d <= inscribed:
        return d - inscribed
    rows, columns = field.shape
    reach = circumscribed + enough
    first = max(0, int((y - reach - y0) / resolution))
    last = min(rows - 1, int((y + reach - y0) / resolution))
    low = max(0, int((x - reach - x0) / resolution))
    high = min(columns - 1, int((x + reach - x0) / resolution))
    best = enough
    for row in range(first, last + 1):
        dy = y0 + (row + 0.5) * resolution - y
        column = low
        while column <= high:
            distance = field[row, column]
            if distance > 0.0:  # nothing is closed nearer than that
                column += max(1, int(distance / resolution))
                continue
            dx = x0 + (column + 0.5) * resolution - x
            best = min(best, polygon_distance(vertices, cos * dx + sin * dy, cos * dy - sin * dx))
            if best <= 0.0:
                return 0.0
            column += 1
    return best


@njit(cache=True)
def covered_clearance(around, body, x, y, cos, sin):
    """A lower bound of ``footprint_clearance`` from the discs that cover a polygon, -inf without any."""
    field, x0, y0, resolution, _ = around
    least = np.inf if len(body.discs) else -np.inf
    for i in range(len(body.discs)):
        dx, dy, radius = body.discs[i]
        px, py = x + cos * dx - sin * dy, y + sin * dx + cos * dy
        least = min(least, centre_clearance(field, x0, y0, resolution, px, py) - radius)
    return least
