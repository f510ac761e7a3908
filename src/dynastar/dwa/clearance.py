"""How near a footprint at a pose comes to space that was not observed free."""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit
from dynastar.dwa.motion import Pose
from dynastar.field import Field, bilinear, is_inside

HALF_DIAGONAL = 1.0 / math.sqrt(2.0)  # of a cell
ROUNDING = 1e-6  # m of clearance that rounding may take
EXACT_WITHIN = 0.3  # m between obstacle and footprint, beyond which its circle stands for it


class Closed(NamedTuple):
    """Cells that were not observed free: the ``distance`` to the nearest, and the hits in them.

    ``hits`` (rows, columns) are the boxes of the hits in the cells that are ``occupied``, metres from
    a cell's centre. In the others an obstacle may be up to half a diagonal from the centre.
    """

    distance: Field
    occupied: npt.NDArray[np.bool_]
    hits: npt.NDArray[Any]


class Box(NamedTuple):
    """An axis-parallel rectangle in the map frame, metres."""

    low_x: float
    high_x: float
    low_y: float
    high_y: float


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
def least_clearance(field, body, pose, enough=EXACT_WITHIN):
    """Metres from the footprint to the nearest marked cell's centre.

    Up to ``enough`` (m) it is too large by no more than ``body.probe_error``; beyond, a lower bound.
    """
    distance = distance_at(field, pose.x, pose.y)
    if distance - body.circumscribed > enough:
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
    """Distance (m) from a point to a convex polygon in the same frame, negative inside."""
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
    return -math.sqrt(best) if inside else math.sqrt(best)


@inner
def body_distance(body, pose, x, y):
    """Distance (m) from a point to the footprint at ``pose``, negative inside."""
    dx, dy = x - pose.x, y - pose.y
    if len(body.vertices) == 0:
        return math.hypot(dx, dy) - body.circumscribed
    ahead, left = pose.cos * dx + pose.sin * dy, pose.cos * dy - pose.sin * dx
    return polygon_distance(body.vertices, ahead, left)


@inner
def box_distance(box, x, y):
    """Distance (m) from a point to a box, negative inside."""
    dx, dy = max(box.low_x - x, x - box.high_x), max(box.low_y - y, y - box.high_y)
    if dx <= 0.0 or dy <= 0.0:
        return max(dx, dy)
    return math.sqrt(dx * dx + dy * dy)


@inner
def closed_box(closed, row, column):
    """Box in the map frame of the obstacles that a closed cell may hold: its hits, or all of the cell."""
    a = closed.distance.resolution
    x, y = closed.distance.x0 + (column + 0.5) * a, closed.distance.y0 + (row + 0.5) * a
    if closed.occupied[row, column]:
        box = closed.hits[row, column]
        return Box(x + box.low_x, x + box.high_x, y + box.low_y, y + box.high_y)
    half = a * HALF_DIAGONAL
    return Box(x - half, x + half, y - half, y + half)


@inner
def body_box_distance(body, pose, box):
    """Distance (m) from the footprint at ``pose`` to a box that is smaller than it.

    It is 0 where they touch, and negative by about the depth to which they overlap.
    """
    n = len(body.vertices)
    if n == 0:
        return box_distance(box, pose.x, pose.y) - body.circumscribed
    least = min(
        body_distance(body, pose, box.low_x, box.low_y),
        body_distance(body, pose, box.low_x, box.high_y),
        body_distance(body, pose, box.high_x, box.low_y),
        body_distance(body, pose, box.high_x, box.high_y),
    )
    for i in range(n):
        ahead, left = body.vertices[i, 0], body.vertices[i, 1]
        x = pose.x + pose.cos * ahead - pose.sin * left
        y = pose.y + pose.sin * ahead + pose.cos * left
        least = min(least, box_distance(box, x, y))
    return least


@inner
def clearance_slack(closed, body, margin, start, pose, enough=0.0):
    """Slack (m) of the clearance constraint at ``pose``, negative if violated.

    The constraint: the footprint keeps ``margin`` from the box of every closed cell, or its distance
    at ``start`` if that was smaller; where they overlapped, it reaches no deeper. A cell does not count
    in which the robot stood at ``start``: overlapped by more than the margin, or without a hit. The
    slack is exact only up to ``enough`` (m), a cell at least.
    """
    field, a = closed.distance, closed.distance.resolution  # no box reaches further from its centre
    least = max(enough, a)
    distance = distance_at(field, pose.x, pose.y)
    if distance - body.circumscribed - a - margin >= least:
        return distance - body.circumscribed - a - margin
    rows, columns = field.values.shape
    reach = body.circumscribed + margin + least + a
    first = max(0, int((pose.y - reach - field.y0) / a))
    last = min(rows - 1, int((pose.y + reach - field.y0) / a))
    low = max(0, int((pose.x - reach - field.x0) / a))
    high = min(columns - 1, int((pose.x + reach - field.x0) / a))
    for row in range(first, last + 1):
        y, column = field.y0 + (row + 0.5) * a, low
        while column <= high:
            to_closed = field.values[row, column]
            if to_closed > 0.0:  # no cell is closed nearer than that
                column += max(1, int(to_closed / a))
                continue
            at = column
            column += 1
            x = field.x0 + (at + 0.5) * a
            far = body.circumscribed + a + margin + least
            if (x - pose.x) ** 2 + (y - pose.y) ** 2 >= far * far:
                continue
            if body_distance(body, pose, x, y) - a - margin >= least:
                continue
            box = closed_box(closed, row, at)
            near = body_box_distance(body, pose, box)
            if near - margin >= least:
                continue
            before = body_box_distance(body, start, box)
            if before < (-margin if closed.occupied[row, at] else 0.0):
                continue  # the robot stands there
            least = min(least, near - min(margin, before))
            if least < -ROUNDING:
                return least
    return least


@njit(cache=True)
def kept_margin(closed, body, margin, pose):
    """The margin (m) that a robot at ``pose`` keeps from every closed cell.

    Noise may mark a cell nearer to the robot than its margin. Beside a wall it could then move
    neither along it nor away, so it keeps what it has, but at least half of the margin.
    """
    nowhere = Pose(1e9, 1e9, 1.0, 0.0)
    return min(margin, max(0.5 * margin, clearance_slack(closed, body, 0.0, nowhere, pose, margin)))
