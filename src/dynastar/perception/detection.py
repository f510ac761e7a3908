"""Detection: groups of neighbouring scan points that may be one obstacle, and the disc of each."""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit, record
from dynastar.grid import GridFrame
from dynastar.perception.past_scans import seen_free_at
from dynastar.perception.placed_scan import PlacedScan

Records = npt.NDArray[Any]

MAPPED, UNOWNED = -2, -1  # owners of points besides the indices of tracks
NEITHER, FIRST, LAST, BOTH = range(4)  # ends of a group
ADJACENT = 3  # beams apart, up to which two points are neighbours
BEHIND = 0.05  # m behind a point that has to have been seen free
GAP = 0.2  # m between neighbouring points that separates two objects, besides the beams' spacing
FEWEST = 3  # points of a group
FREE_FRACTION = 0.4  # of the points of a moving obstacle lie in space that was seen free before
TYPICAL_RADIUS = 0.3  # m, assumed until both ends were in view, and of people by their legs
LEG_RADIUS = 0.12  # m of a leg at most
STRIDE = 0.7  # m between the legs of one person at most


class Known(NamedTuple):
    """The map's obstacles, widened a little, where no moving obstacle is looked for."""

    mask: npt.NDArray[np.bool_]
    frame: GridFrame


class Point:
    """A point of a scan."""

    x: float  # m, map frame
    y: float
    range: float  # m from the sensor
    beam: int
    owner: int  # index of the track that expects it, MAPPED or UNOWNED
    jump: float  # m that it is farther away than the point before; inf with no return between
    breaks: bool  # a new group starts here
    free: bool  # in space that an earlier scan showed as free
    free_at: float  # s, when a scan did so last, or -inf
    wide: bool  # on a surface too wide for a moving obstacle
    moving: bool  # on a track that moves


class Group:
    """Neighbouring points that may be one moving obstacle, and the disc that fits them."""

    start: int  # index of the first point, and of the one after the last
    stop: int
    owner: int  # of its points: the index of a track, or UNOWNED
    x: float  # m, centre and radius of the disc
    y: float
    radius: float
    inside_x: float  # m, a place just behind its middle point
    inside_y: float
    free: float  # fraction of its points in space that an earlier scan showed as free
    legs: bool  # a person's leg, or two
    hidden: int  # ends hidden or cut off by the field of view: NEITHER, FIRST, LAST or BOTH
    paired: bool  # with another leg
    taken: bool  # by a track, or by the other leg


POINT, GROUP = record(Point), record(Group)


def points_of(scan: PlacedScan) -> Records:
    """The points (n,) of a scan as records."""
    points = np.zeros(len(scan.points), POINT)
    points["x"], points["y"] = scan.points.T
    points["beam"] = scan.beams
    return points


@njit(cache=True)
def find_groups(points, sensor, known, space, tracks, widest):
    """Groups (m,) of ``points`` up to ``widest`` m wide, and the points rolled to begin at a break."""
    n, m, stop = len(points), 0, 0
    find_owners(points, sensor, known, space, tracks)
    find_breaks(points, sensor, tracks)
    first = next_break(points, -1)
    rolled, groups = np.empty(n, POINT), np.zeros(n // FEWEST, GROUP)
    for i in range(n):
        rolled[i] = points[(first + i) % n]
    if first == n:  # one surface all round
        return groups[:0], rolled
    split_wide(rolled, widest)
    while stop < n:
        start, stop = stop, next_break(rolled, stop)
        if stop - start >= FEWEST:
            groups[m].start, groups[m].stop = start, stop
            m += describe(groups[m], rolled, sensor, tracks, widest)
    join_legs(groups[:m])
    return groups[:m], rolled


@inner
def find_owners(points, sensor, known, space, tracks):
    """Set the range of each point, its owner, and whether it lies in space seen free.

    The owner is the nearest track that expects the point within its margin, in the outer half of the
    margin only if the point is free. A beam may pass a cell that holds part of a static surface, so the
    space behind the point is what has to be free.
    """
    frame, (rows, columns) = known.frame, known.mask.shape
    cos, sin = math.cos(frame.yaw), math.sin(frame.yaw)
    for point in points:
        dx, dy = point.x - frame.x, point.y - frame.y
        row = math.floor((cos * dy - sin * dx) / frame.resolution)
        column = math.floor((cos * dx + sin * dy) / frame.resolution)
        dx, dy = point.x - sensor.x, point.y - sensor.y
        point.range, point.owner = math.hypot(dx, dy), UNOWNED
        if -1 <= row <= rows and -1 <= column <= columns:  # the rim counts as an obstacle
            row, column = min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)
            if known.mask[row, column]:
                point.owner = MAPPED
                continue
        point.free_at = seen_free_at(*just_behind(point, sensor), space)
        point.free = point.free_at > -np.inf
        nearest = 1.0  # squared distance over squared reach
        for t, track in enumerate(tracks):
            reach = track.radius + (1.0 if point.free else 0.5) * track.margin
            square = (point.x - track.x) ** 2 + (point.y - track.y) ** 2
            if reach > 0.0 and square < nearest * reach * reach:
                point.owner, nearest = t, square / (reach * reach)


@inner
def just_behind(point, sensor):
    """The place (x, y) that lies ``BEHIND`` m behind a point, as seen from the sensor."""
    behind = BEHIND / max(point.range, 1e-9)
    return point.x + behind * (point.x - sensor.x), point.y + behind * (point.y - sensor.y)


@inner
def find_breaks(points, sensor, tracks):
    """Set the jump of each point, and whether it breaks from the one before by distance or owner.

    A track whose radius is assumed takes over the free points joined to its own, on both sides.
    """
    n, spread = len(points), 2.0 * abs(sensor.step)
    for i in range(n):
        point, before = points[i], points[i - 1]
        distance = math.hypot(point.x - before.x, point.y - before.y)
        point.breaks, point.jump = distance > GAP + spread * point.range, point.range - before.range
        if i == 0 and not sensor.full_circle:
            point.breaks, point.jump = True, 0.0
        elif (point.beam - before.beam) % sensor.beams > ADJACENT:
            point.breaks, point.jump = True, np.inf
    for k in range(2 * n - 2):  # there and back
        i, j = (k + 1, k) if k < n - 1 else (2 * n - 3 - k, 2 * n - 2 - k)
        point, owner = points[i], points[j].owner
        joined = point.owner == UNOWNED and point.free and not points[max(i, j)].breaks
        if joined and owner >= 0 and tracks[owner].measured == 0.0:
            point.owner = owner
    for i in range(n):
        points[i].breaks |= points[i].owner != points[i - 1].owner


@inner
def next_break(points, start):
    """Index of the first point after ``start`` that breaks, or the number of points."""
    stop = start + 1
    while stop < len(points) and not points[stop].breaks:
        stop += 1
    return stop


@inner
def split_wide(points, widest):
    """Mark the surfaces wider than ``widest`` (m), and break them where ``free`` changes."""
    stop = 0
    while stop < len(points):
        start, stop = stop, next_break(points, stop)
        low_x = low_y = np.inf
        high_x = high_y = -np.inf
        for point in points[start:stop]:
            low_x, high_x = min(low_x, point.x), max(high_x, point.x)
            low_y, high_y = min(low_y, point.y), max(high_y, point.y)
        if math.hypot(high_x - low_x, high_y - low_y) > widest:
            for i in range(start, stop):
                points[i].wide = True
                points[i].breaks |= points[i].free != points[i - 1].free


@inner
def describe(group, points, sensor, tracks, widest):
    """Fill in a group from its first and last index. Returns True if it may be a moving obstacle.

    On a wide surface it may be only where space was seen free: an obstacle can move close to a wall.
    What is seen over half a turn or more surrounds the sensor, like a dead end.
    """
    first, after = points[group.start], points[group.stop % len(points)]
    spanned = (points[group.stop - 1].beam - first.beam) % sensor.beams * abs(sensor.step)
    if first.owner == MAPPED or (first.wide and not first.free) or spanned >= math.pi:
        return False
    group.owner = first.owner
    behind_before, behind_after = first.jump >= -0.5 * GAP, after.jump <= 0.5 * GAP
    group.hidden = FIRST * (behind_before and first.jump < np.inf) + LAST * behind_after
    n_free, nearest, farthest = 0, np.inf, 0.0
    for point in points[group.start : group.stop]:
        n_free += point.free
        nearest, farthest = min(nearest, point.range), max(farthest, point.range)
    group.free = n_free / (group.stop - group.start)
    middle = points[(group.start + group.stop) // 2]
    group.inside_x, group.inside_y = just_behind(middle, sensor)
    owned = group.owner != UNOWNED
    of_legs = owned and tracks[group.owner].legs
    radius = tracks[group.owner].radius if owned and not of_legs else 0.0
    group.x, group.y, seen = fit_disc(points, group, sensor, radius)
    narrow = group.hidden == NEITHER and max(seen, farthest - nearest) < LEG_RADIUS
    group.legs = narrow and (of_legs or group.free >= FREE_FRACTION)
    group.radius = seen
    if group.hidden != NEITHER or group.legs:
        group.radius = max(radius if radius > 0.0 else TYPICAL_RADIUS, seen)
    return seen <= 0.5 * widest and (not first.wide or seen > 0.25 * GAP)


@inner
def join_legs(groups):
    """Make one group of each two legs of a person, nearest pairs first: its centre is their middle.

    Both belong to the same track, or to none, and are at most ``STRIDE`` apart. The second is taken.
    """
    while True:
        first = second = -1
        nearest = STRIDE
        for i in range(len(groups)):
            for j in range(i):
                a, b = groups[i], groups[j]
                distance = math.hypot(a.x - b.x, a.y - b.y)
                legs = a.legs and b.legs and a.owner == b.owner
                if legs and not a.paired and not b.paired and distance < nearest:
                    first, second, nearest = j, i, distance
        if first < 0:
            return
        a, b = groups[first], groups[second]
        a.x, a.y = 0.5 * (a.x + b.x), 0.5 * (a.y + b.y)
        a.paired = b.paired = b.taken = True


@inner
def fit_disc(points, group, sensor, radius):
    """Centre (x, y) of the disc whose near side a group shows, and the half-width seen, metres.

    Rays touch a disc of radius r at distance D at the angle a either side of its centre, sin a = r / D.
    With both ends in view the centre lies in the middle; with one, at the angle a from that end, so
    that it moves as the end does, however much comes into view. D is the mean over the points. A
    ``radius`` of 0 is unknown: the half-width seen, and with a hidden end at least TYPICAL_RADIUS.
    """
    own = points[group.start : group.stop]
    first = math.atan2(own[0].y - sensor.y, own[0].x - sensor.x)
    last = math.atan2(own[-1].y - sensor.y, own[-1].x - sensor.x)
    turn = (last - first + math.pi) % (2.0 * math.pi) - math.pi
    side = 1.0 if turn >= 0.0 else -1.0
    width, half_step = abs(turn), 0.5 * abs(sensor.step)  # an end in view lies between two beams
    if group.hidden in (NEITHER, LAST):
        first -= side * half_step
        width += half_step
    if group.hidden in (NEITHER, FIRST):
        width += half_step
    distance = 0.0
    for point in own:
        distance += point.range
    sin = math.sin(min(0.5 * width, 1.2))
    distance = distance / len(own) / (1.0 - 0.8 * sin)  # nearly: points lie 0.8 r before it
    seen, r, ux, uy = 0.0, radius, 1.0, 0.0
    for _ in range(10):
        seen, previous = distance * sin, distance
        if radius == 0.0:
            r = max(seen, TYPICAL_RADIUS) if group.hidden != NEITHER else seen
        a = 0.5 * width
        if group.hidden == LAST:
            a = math.asin(min(r / distance, 0.95))
        elif group.hidden == FIRST:
            a = width - math.asin(min(r / distance, 0.95))
        ux, uy = math.cos(first + side * a), math.sin(first + side * a)
        distance = 0.0
        for point in own:
            px, py = point.x - sensor.x, point.y - sensor.y
            off = ux * py - uy * px
            distance += ux * px + uy * py + math.sqrt(max(r * r - off * off, 0.0))
        distance = max(distance / len(own), 1e-3)
        if abs(distance - previous) < 1e-3:
            break
    return sensor.x + distance * ux, sensor.y + distance * uy, seen
