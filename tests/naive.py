"""Slow and obvious answers to compare the fast ones with."""

import heapq
import math

import numpy as np
import shapely

from dynastar.errors import NoPath, StartOccupied
from dynastar.robot import slew

STRAIGHT, DIAGONAL = 985, 1393  # the search's units: 1393 / 985 for sqrt(2)
STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def neighbours(occupied, cell):
    """Where one step leads to, corners not cut, and whether it is a diagonal one."""
    rows, columns = occupied.shape

    def free(r, c):
        return 0 <= r < rows and 0 <= c < columns and not occupied[r, c]

    r, c = cell
    for dr, dc in STEPS:
        if free(r + dr, c + dc) and free(r + dr, c) and free(r, c + dc):
            yield (r + dr, c + dc), bool(dr and dc)


def shortest(occupied, start):
    """Dijkstra in floats: the length of the shortest way to every cell that can be reached."""
    lengths = {start: 0.0}
    queue = [(0.0, start)]
    closed = set()
    while queue:
        length, cell = heapq.heappop(queue)
        if cell in closed:
            continue
        closed.add(cell)
        for n, diagonal in neighbours(occupied, cell):
            longer = length + (math.sqrt(2) if diagonal else 1.0)
            if longer < lengths.get(n, math.inf):
                lengths[n] = longer
                heapq.heappush(queue, (longer, n))
    return lengths


def gap_at(blocked, cell):
    """Cells from a cell's centre to the nearest blocked square, or to the edge of the map."""
    if blocked[cell]:
        return 0.0
    gaps = [0.5 + min(at, size - 1 - at) for at, size in zip(cell, blocked.shape, strict=True)]
    for other in np.argwhere(blocked):
        gaps.append(
            math.hypot(*(max(abs(a - b) - 0.5, 0.0) for a, b in zip(cell, other, strict=True)))
        )
    return min(gaps)


def way_out(blocked, inflated, start, goal, radius):
    """Lengths of the shortest way out that leads on and of the path from its end, or the error.

    The exits are tried one after another, each by a search of its own.
    """
    first, reach = start, math.ceil(4.0 * radius) + 4
    if blocked[start]:
        near = [(math.dist(start, cell), *map(int, cell)) for cell in np.argwhere(~blocked)]
        away, *first = min(near, default=(math.inf, 0, 0))
        first = tuple(first)
        if radius <= 0.0 or away > radius + 2.0:
            return StartOccupied
    gap = min(radius, gap_at(blocked, start))
    kept = radius if gap >= radius else gap - 1.0
    closed = blocked.copy()
    for r, c in np.argwhere(~blocked):
        narrow = gap_at(blocked, (r, c)) < kept
        far = max(abs(r - start[0]), abs(c - start[1])) > reach
        closed[r, c] = narrow or far
    lengths = shortest(closed, first)
    exits = sorted((round(g, 6), cell) for cell, g in lengths.items() if not inflated[cell])
    if not exits:
        return StartOccupied
    nearest = exits[0][0]
    beside = nearest <= 1.5 * (radius - gap) + 2.0
    for length, cell in exits:
        rest = shortest(inflated, cell)
        if goal in rest and (not beside or length <= nearest + 1.0 + 1e-6):
            return math.dist(start, first) + length, rest[goal]
    return NoPath


def h(config, n, goal):
    """The estimate h of Eq. 2 in the search's units."""
    dr, dc = abs(n[0] - goal[0]), abs(n[1] - goal[1])
    if config.estimate == "euclidean":
        return int(STRAIGHT * math.sqrt(dr * dr + dc * dc))
    return STRAIGHT * abs(dr - dc) + DIAGONAL * min(dr, dc)


def p_over_q(config, occupied, n, start, goal):
    """P / Q in its three readings, at most 1."""
    if config.q == "ratio":
        a = 1  # cell
        around = occupied[max(n[0] - a, 0) : n[0] + a + 1, max(n[1] - a, 0) : n[1] + a + 1]
        return min(around.sum() / max(occupied.sum(), 1), 1.0)
    r0, r1 = sorted((n[0], goal[0]))
    c0, c1 = sorted((n[1], goal[1]))
    p = occupied[r0 : r1 + 1, c0 : c1 + 1].sum()
    rows, columns = abs(start[0] - goal[0]) + 1, abs(start[1] - goal[1]) + 1
    return min(p / (rows * columns if config.q == "rectangle" else max(rows, columns)), 1.0)


def cos_beta(config, n, start, goal):
    """cos(beta), 1 at start and goal."""
    if n in (start, goal):
        return 1.0
    to_goal = (goal[0] - n[0], goal[1] - n[1])
    from_start = (n[0] - start[0], n[1] - start[1])
    dot = from_start[0] * to_goal[0] + from_start[1] * to_goal[1]
    cosine = dot / (math.hypot(*from_start) * math.hypot(*to_goal))
    return cosine if config.beta == "progress" else -cosine


def h_improved(config, occupied, n, parent, start, goal):
    """h_A(n) of Eq. 2."""
    value = h(config, n, goal)
    if config.parent:
        value += h(config, parent, goal)
    value -= config.k * STRAIGHT * cos_beta(config, n, start, goal)
    if config.exponential:
        value *= math.exp(p_over_q(config, occupied, n, start, goal))
    return max(value, 0.0)


def improved(occupied, start, goal, config):
    """Eq. 3, literally, the newest first among equal f: (length, expanded cells), or None."""
    g, parents, closed, serial = {start: 0}, {start: None}, set(), 0
    queue = [(0, 0, start)]
    while queue:
        _, _, cell = heapq.heappop(queue)
        if cell in closed:
            continue
        closed.add(cell)
        if cell == goal:
            break
        for n, diagonal in neighbours(occupied, cell):
            longer = g[cell] + (DIAGONAL if diagonal else STRAIGHT)
            if n in closed or longer >= g.get(n, math.inf):
                continue
            g[n], parents[n] = longer, cell
            serial += 1
            f = longer + int(config.weight * h_improved(config, occupied, n, cell, start, goal))
            heapq.heappush(queue, (f, -serial, n))
    if goal not in closed:
        return None
    length, cell = 0.0, goal
    while parents[cell] is not None:
        length += math.dist(cell, parents[cell])
        cell = parents[cell]
    return length, closed


def distances(blocked):
    """Cells from every cell's centre to the nearest blocked cell's centre."""
    at = np.argwhere(blocked)
    each = np.argwhere(np.ones_like(blocked))
    gaps = np.hypot(*(each[:, None, :] - at[None, :, :]).transpose(2, 0, 1)).min(axis=1)
    return gaps.reshape(blocked.shape)


def clearance(blocked, points, outside=True):
    """Cells from a polyline (n, 2) of (row, column) to the nearest blocked square."""
    squares = [shapely.box(r, c, r + 1, c + 1) for r, c in np.argwhere(blocked)]
    if outside:
        rows, columns = blocked.shape
        far = shapely.box(-1e3, -1e3, rows + 1e3, columns + 1e3)
        squares.append(far - shapely.box(0, 0, rows, columns))
    line = shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
    return min((line.distance(square) for square in squares), default=math.inf)


def slips_through(blocked, a, b):
    """Whether a point going from a to b enters a blocked square, or passes a seam or corner."""
    line = shapely.LineString([a, b])
    low, high = np.floor(np.minimum(a, b)).astype(int) - 1, np.floor(np.maximum(a, b)).astype(int)
    rows, columns = blocked.shape

    def is_blocked(r, c):
        return not (0 <= r < rows and 0 <= c < columns) or blocked[r, c]

    for r in range(low[0], high[0] + 2):
        for c in range(low[1], high[1] + 2):
            if not is_blocked(r, c):
                continue
            for height, width in ((1, 1), (2, 1), (1, 2)):
                if is_blocked(r + height - 1, c + width - 1):
                    inner = shapely.box(r, c, r + height, c + width).buffer(
                        -1e-9, join_style="mitre"
                    )
                    if line.intersects(inner):
                        return True
            for dr, dc in ((1, 1), (1, -1)):
                corner = shapely.Point(r + 1, c + max(dc, 0))
                if is_blocked(r + dr, c + dc) and line.distance(corner) < 1e-9:
                    return True
    return False


def observed_free(gaps, angle_min, increment, full_circle, sensor, centres):
    """Whether points (k, 2) lie within their sector's gap (m); how far off the next beam, in beams;
    and whether just at the gap's end, or at the sensor."""
    x, y, theta = sensor
    dx, dy = centres[:, 0] - x, centres[:, 1] - y
    distance = np.hypot(dx, dy)
    turn = (np.arctan2(dy, dx) - theta - angle_min) * np.sign(increment)
    sector = (turn % math.tau) / abs(increment)
    n = len(gaps)
    beam = np.minimum(sector.astype(int), n - 1)
    seen = (sector < n) | full_circle
    reach = np.where(seen, gaps[beam], 0.0)
    past = np.minimum(np.abs(sector - np.round(sector)), math.tau / abs(increment) - sector)
    return distance <= reach, past, np.minimum(distance, np.abs(distance - reach)) < 1e-9


def straight_lines(clear, points):
    """The shortest way's length from the first point to the last by edges that are ``clear``, or inf."""
    length = dict.fromkeys(range(len(points)), math.inf) | {0: 0.0}
    left = set(length)
    while left:
        here = min(left, key=length.get)
        left.remove(here)
        for there in left:
            step = math.dist(points[here], points[there])
            if length[here] + step < length[there] and clear(points[here], points[there]):
                length[there] = length[here] + step
    return length[len(points) - 1]


def slack_of_constraint(space, footprint, margin, start, pose):
    """Slack (m) of the clearance constraint of a footprint at ``pose`` (x, y, cos, sin), cell by cell.

    ``space`` is as of ``boxes_of``. The footprint keeps ``margin`` from each box, or what it had at
    ``start``; where they overlap, that is how deep a corner of the one is in the other. A box in which
    the robot stood at the start does not count.
    """
    boxes, hit = space
    low_x, high_x, low_y, high_y = boxes.T
    shapes = shapely.box(low_x, low_y, high_x, high_y)
    gaps = []
    for x, y, cos, sin in (pose, start):
        if footprint.is_disc:
            away = signed_distance(shapes, shapely.Point(x, y)) - footprint.circumscribed
        else:
            placed = footprint.vertices @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
            body = shapely.Polygon(placed)
            away = shapely.distance(body, shapes)
            for k in np.flatnonzero(away == 0.0):
                inside = signed_distance(body, shapely.points(shapes[k].exterior.coords))
                through = signed_distance(shapes[k], shapely.points(placed))
                away[k] = min(inside.min(), through.min())
        gaps.append(away)
    counts = gaps[1] >= np.where(hit, -margin, 0.0)
    return float((gaps[0] - np.minimum(margin, gaps[1]))[counts].min(initial=np.inf))


def signed_distance(shape, point):
    """Distances (m) between shapes and points, negative inside: how far the edge is."""
    away = shapely.distance(shape, point)
    return np.where(away > 0.0, away, -shapely.distance(shapely.boundary(shape), point))


def footprint_gaps(centres, footprint, pose):
    """Distances (m) from a footprint at ``pose`` (x, y, cos, sin) to points (k, 2), 0 inside."""
    x, y, cos, sin = pose
    if footprint.is_disc:
        return np.maximum(np.hypot(*(centres - (x, y)).T) - footprint.circumscribed, 0.0)
    placed = footprint.vertices @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
    return shapely.distance(shapely.Polygon(placed), shapely.points(centres))


def mean_speed(current, wanted, accel, brake, duration):
    """Mean of one speed on its way to another: trapezoids between the times at which its ramp bends."""
    zero = abs(current) / brake if current * wanted < 0.0 else 0.0
    begin = 0.0 if current * wanted < 0.0 else abs(current)
    reached = zero + abs(abs(wanted) - begin) / (accel if abs(wanted) > begin else brake)
    times = sorted({0.0, min(zero, duration), min(reached, duration), duration})
    speeds = [slew(current, wanted, accel, brake, t) for t in times]
    return np.dot(np.diff(times), 0.5 * (np.array(speeds[:-1]) + speeds[1:])) / duration
