"""Detection: groups of neighbouring scan points that may be one obstacle, and the disc of each."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.grid import GridFrame
from dynastar.perception.past_scans import SeenFree, seen_free

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

# Columns of a group: its first point and the one after its last (indices count on round the circle),
# whether its first and its last end are hidden, the fraction of its points in space that was seen
# free, the track that owns its points (-1: none), and the disc that fits.
G_START, G_STOP, G_HIDDEN_FIRST, G_HIDDEN_LAST, G_FREE, G_TRACK, G_X, G_Y, G_RADIUS = range(9)
GROUP_COLUMNS = 9
# Columns of a disc that tracking expects: centre and radius (m), the margin (m) in which points are
# still its own, and 1 if the radius was measured, 0 if it is assumed.
D_X, D_Y, D_RADIUS, D_MARGIN, D_MEASURED = range(5)
MAPPED, NOBODY = -2, -1  # owners of points besides the tracks: the static map, and none
ADJACENT = 3  # beams apart, up to which two points are neighbours
BEHIND = 0.05  # m behind a point that has to have been seen free
GAP = 0.2  # m between neighbouring points that separates two objects, besides the beams' spacing
FEWEST = 3  # points of a group
TYPICAL_RADIUS = 0.3  # m, assumed until both ends were in view


class Known(NamedTuple):
    """The map's obstacles, widened a little, where no moving obstacle is looked for."""

    mask: Mask
    frame: GridFrame


class Sensor(NamedTuple):
    """Where a scan was taken (m, map frame), the angle between its beams (rad), and their number.

    ``full`` is 1 for a scan all round, whose last beam is next to its first, else 0.
    """

    x: float
    y: float
    step: float
    beams: int
    full: int


@njit(cache=True)
def fit_disc(
    points: Floats, group: Floats, sensor: Sensor, radius: float
) -> tuple[float, float, float]:
    """Centre (x, y) of the disc whose near side a group shows, and the half-width seen, metres.

    Rays touch a disc of radius r at distance D at the angle a either side of its centre, sin a = r / D.
    With both ends in view the centre lies in the middle; with one, at the angle a from that end, so
    it moves as that end does, however much comes into view; D is the mean over the points. A
    ``radius`` of 0 is unknown: the half-width seen, and with a hidden end at least TYPICAL_RADIUS.
    """
    n, start, stop = len(points), int(group[G_START]), int(group[G_STOP])
    hidden_first, hidden_last = group[G_HIDDEN_FIRST] > 0.0, group[G_HIDDEN_LAST] > 0.0
    first = math.atan2(points[start % n, 1] - sensor.y, points[start % n, 0] - sensor.x)
    last = math.atan2(points[(stop - 1) % n, 1] - sensor.y, points[(stop - 1) % n, 0] - sensor.x)
    turn = (last - first + math.pi) % (2.0 * math.pi) - math.pi
    side = 1.0 if turn >= 0.0 else -1.0
    width, half_step = abs(turn), 0.5 * sensor.step  # an end in view lies between two beams
    if not hidden_first:
        first -= side * half_step
        width += half_step
    if not hidden_last:
        width += half_step
    distance = 0.0
    for k in range(start, stop):
        distance += math.hypot(points[k % n, 0] - sensor.x, points[k % n, 1] - sensor.y)
    sin = math.sin(min(0.5 * width, 1.2))
    distance = distance / (stop - start) / (1.0 - 0.8 * sin)  # nearly: points lie 0.8 r before it
    seen, r, ux, uy = 0.0, radius, 1.0, 0.0
    for _ in range(10):
        seen, previous = distance * sin, distance
        if radius == 0.0:
            r = max(seen, TYPICAL_RADIUS) if hidden_first or hidden_last else seen
        a = 0.5 * width
        if hidden_last and not hidden_first:
            a = math.asin(min(r / distance, 0.95))
        elif hidden_first and not hidden_last:
            a = width - math.asin(min(r / distance, 0.95))
        ux, uy = math.cos(first + side * a), math.sin(first + side * a)
        distance = 0.0
        for k in range(start, stop):
            px, py = points[k % n, 0] - sensor.x, points[k % n, 1] - sensor.y
            off = ux * py - uy * px
            distance += ux * px + uy * py + math.sqrt(max(r * r - off * off, 0.0))
        distance = max(distance / (stop - start), 1e-3)
        if abs(distance - previous) < 1e-3:
            break
    return sensor.x + distance * ux, sensor.y + distance * uy, seen


@njit(cache=True)
def find_owners(
    points: Floats, sensor: Sensor, known: Known, space: SeenFree, discs: Floats
) -> tuple[Integers, Mask]:
    """Object of each point (n,), and whether the point lies in space that was seen free.

    An owner is MAPPED, NOBODY or the nearest of ``discs`` (k, 5); in the outer half of a disc's margin
    only points in space that was seen free are its own. A surface that stands may lie in a cell that
    beams pass, so the space behind the point is what counts.
    """
    owner, free = np.full(len(points), NOBODY), np.zeros(len(points), np.bool_)
    frame = known.frame
    cos, sin = math.cos(frame.yaw), math.sin(frame.yaw)
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        dx, dy = x - frame.x, y - frame.y
        column = int(math.floor((cos * dx + sin * dy) / frame.resolution))
        row = int(math.floor((cos * dy - sin * dx) / frame.resolution))
        inside = 0 <= row < known.mask.shape[0] and 0 <= column < known.mask.shape[1]
        if inside and known.mask[row, column]:
            owner[i] = MAPPED
            continue
        dx, dy = x - sensor.x, y - sensor.y
        behind = BEHIND / max(math.hypot(dx, dy), 1e-9)
        free[i] = seen_free(x + behind * dx, y + behind * dy, space)
        nearest = 1.0  # squared distance over squared reach
        for t in range(len(discs)):
            dx, dy = x - discs[t, D_X], y - discs[t, D_Y]
            reach = discs[t, D_RADIUS] + (1.0 if free[i] else 0.5) * discs[t, D_MARGIN]
            if reach > 0.0 and dx * dx + dy * dy < nearest * reach * reach:
                owner[i], nearest = t, (dx * dx + dy * dy) / (reach * reach)
    return owner, free


@njit(cache=True)
def compare_neighbours(points: Floats, beams: Integers, sensor: Sensor) -> tuple[Mask, Integers]:
    """Whether each point is apart from the one before, and how it lies behind it.

    That is 1 for further away, -1 for nearer, 0 for neither, and 2 if nothing was hit between them.
    """
    n = len(points)
    apart, jumps = np.zeros(n, np.bool_), np.zeros(n, np.int64)
    for i in range(n):
        r = math.hypot(points[i, 0] - sensor.x, points[i, 1] - sensor.y)
        before = math.hypot(points[i - 1, 0] - sensor.x, points[i - 1, 1] - sensor.y)
        width = math.hypot(points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1])
        if i == 0 and sensor.full == 0:
            apart[i] = True
        elif (beams[i] - beams[i - 1]) % sensor.beams > ADJACENT:
            apart[i], jumps[i] = True, 2
        else:
            apart[i] = width > GAP + 2.0 * r * sensor.step
            jumps[i] = 1 if r > before + 0.5 * GAP else (-1 if r < before - 0.5 * GAP else 0)
    return apart, jumps


@njit(cache=True)
def find_groups(
    points: Floats,
    beams: Integers,
    sensor: Sensor,
    owned: tuple[Integers, Mask],
    discs: Floats,
    widest: float,
) -> Floats:
    """Groups (m, GROUP_COLUMNS) of neighbouring points that may be one moving obstacle.

    A group breaks where neighbours lie further apart than GAP plus twice the beams' spacing and
    where the owner changes (``owned``: see ``find_owners``). Of what is wider than ``widest``, only
    runs of points in space that was seen free are groups: a person may walk close to a wall.
    """
    n, (owner, free) = len(points), owned
    found, m = np.empty((n, GROUP_COLUMNS)), 0
    breaks, jumps = compare_neighbours(points, beams, sensor)
    for k in range(2 * n - 2):  # a disc of assumed radius owns what is joined to it, on both sides
        i, j = (k + 1, k) if k < n - 1 else (2 * n - 3 - k, 2 * n - 2 - k)
        t = owner[j]
        joined = owner[i] == NOBODY and free[i] and not breaks[max(i, j)]
        if joined and t >= 0 and discs[t, D_MEASURED] == 0.0:
            owner[i] = t
    first = -1
    for i in range(n):
        breaks[i] |= owner[i] != owner[i - 1]
        if breaks[i] and first < 0:
            first = i
    if first < 0:
        return found[:0]  # one surface all round
    start = whole = first  # of the group, and where one that is too wide ends
    while start < first + n:
        stop = start + 1
        while stop < first + n and not breaks[stop % n]:
            stop += 1
        if start >= whole:
            low_x = low_y = np.inf
            high_x = high_y = -np.inf
            for k in range(start, stop):
                px, py = points[k % n, 0], points[k % n, 1]
                low_x, high_x = min(low_x, px), max(high_x, px)
                low_y, high_y = min(low_y, py), max(high_y, py)
            if math.hypot(high_x - low_x, high_y - low_y) > widest:
                whole = stop
        here, part = start % n, start < whole
        if part:
            stop = start + 1
            while stop < whole and free[stop % n] == free[here]:
                stop += 1
        if stop - start >= FEWEST and owner[here] != MAPPED and (free[here] or not part):
            group, t = found[m], owner[here]
            group[G_START], group[G_STOP], group[G_TRACK] = start, stop, t
            group[G_HIDDEN_FIRST] = 0.0 if jumps[here] == -1 or jumps[here] == 2 else 1.0
            group[G_HIDDEN_LAST] = 0.0 if jumps[stop % n] > 0 else 1.0
            count = 0
            for k in range(start, stop):
                count += free[k % n]
            group[G_FREE] = count / (stop - start)
            radius = discs[t, D_RADIUS] if t >= 0 else 0.0
            x, y, seen = fit_disc(points, group, sensor, radius)
            if group[G_HIDDEN_FIRST] + group[G_HIDDEN_LAST] == 0.0:
                radius = seen
            else:
                radius = max(radius if t >= 0 else TYPICAL_RADIUS, seen)
            group[G_X], group[G_Y], group[G_RADIUS] = x, y, radius
            if seen <= 0.5 * widest and (not part or seen > 0.25 * GAP):
                m += 1
        start = stop
    return found[:m]
