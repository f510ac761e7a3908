"""How near a footprint at a pose comes to space that was not observed free."""

import math

import numpy as np

from dynastar.compiled import inner, njit
from dynastar.dwa.motion import Pose
from dynastar.field import bilinear, is_inside

EXACT_WITHIN = 0.3  # m between obstacle and footprint, beyond which its circle stands for it


@inner
def distance_at(field, x, y):
    """A lower bound of the distance (m) from a point to the nearest marked cell's centre, 0 outside.

    Between the cells' centres the distance to a point bends by at most resolution^2 / 4d, which is
    taken off.
    """
    if not is_inside(field, x, y):
        return 0.0
    distance, a = bilinear(field, x, y), field.resolution
    if distance <= a:
        return max(0.0, distance - 0.5 * a)
    return distance - 0.25 * a * a / distance


@inner
def least_clearance(field, body, pose):
    """Metres from the footprint to the nearest marked cell's centre; exact where it matters."""
    distance = distance_at(field, pose.x, pose.y)
    if distance - body.circumscribed > EXACT_WITHIN:
        return distance - body.circumscribed
    least = distance - body.inscribed
    for i in range(len(body.probes)):
        ahead, left = body.probes[i, 0], body.probes[i, 1]
        x = pose.x + pose.cos * ahead - pose.sin * left
        y = pose.y + pose.sin * ahead + pose.cos * left
        least = min(least, distance_at(field, x, y))
    return least


@inner
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


@inner
def body_distance(body, pose, x, y):
    """Distance (m) from a point to the footprint at ``pose``, 0 inside."""
    dx, dy = x - pose.x, y - pose.y
    if len(body.vertices) == 0:
        return max(0.0, math.hypot(dx, dy) - body.circumscribed)
    ahead, left = pose.cos * dx + pose.sin * dy, pose.cos * dy - pose.sin * dx
    return polygon_distance(body.vertices, ahead, left)


@inner
def clearance_slack(field, body, margin, start, pose):
    """Slack (m) of the clearance constraint at ``pose``, negative if violated.

    The constraint: the footprint keeps ``margin`` from the centre of every marked cell of ``field``,
    or its distance at ``start`` if that was smaller. The slack is exact only within a cell of 0.
    """
    distance, a = distance_at(field, pose.x, pose.y), field.resolution
    if distance - body.circumscribed >= margin:
        return distance - body.circumscribed - margin
    rows, columns = field.values.shape
    reach = body.circumscribed + margin + a
    first = max(0, int((pose.y - reach - field.y0) / a))
    last = min(rows - 1, int((pose.y + reach - field.y0) / a))
    low = max(0, int((pose.x - reach - field.x0) / a))
    high = min(columns - 1, int((pose.x + reach - field.x0) / a))
    least = a
    for row in range(first, last + 1):
        y = field.y0 + (row + 0.5) * a
        column = low
        while column <= high:
            to_marked = field.values[row, column]
            if to_marked > 0.0:  # no cell is marked nearer than that
                column += max(1, int(to_marked / a))
                continue
            x = field.x0 + (column + 0.5) * a
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
    """The margin (m) that a robot at ``pose`` keeps from every marked cell of ``field``.

    Noise may mark a cell nearer to the robot than its margin. Beside a wall it could then move
    neither along it nor away, so it keeps what it has, but at least half of the margin, and half
    a cell's diagonal: the obstacle may stand anywhere in the cell.
    """
    nowhere = Pose(1e9, 1e9, 1.0, 0.0)
    least = min(margin, max(0.5 * margin, field.resolution / math.sqrt(2.0)))
    return min(margin, max(least, clearance_slack(field, body, 0.0, nowhere, pose)))
