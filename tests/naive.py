"""Slow and obvious answers to compare the fast ones with."""

import heapq
import math

import numpy as np
import shapely

from dynastar.geometry import Twist, wrap_angle
from dynastar.robot import arc

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


def h(config, n, goal):
    """The estimate h of Eq. 2 in the search's units."""
    dr, dc = abs(n[0] - goal[0]), abs(n[1] - goal[1])
    if config.estimate == "euclidean":
        return int(STRAIGHT * math.sqrt(dr * dr + dc * dc))
    return STRAIGHT * abs(dr - dc) + DIAGONAL * min(dr, dc)


def p_over_q(config, occupied, n, start, goal):
    """P / Q in its three readings, at most 1."""
    if config.q == "ratio":
        a = config.around
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


def evaluate_window(robot, config, reach, samples, pose, twist, around, wish, margins):
    """Eqs. 7 to 9 sample by sample: (best index, refusal codes without the certified stop, terms)."""
    limits, radius = robot.limits, robot.footprint.inscribed
    step = config.horizon / config.steps
    rows, columns = around.field.shape
    refused, terms = np.zeros(len(samples), int), np.zeros((len(samples), 4))
    gap_to_target = math.dist(wish.target, pose[:2])
    cap, v_scale = limits.v_max, limits.v_max
    if config.normalisation == "window":
        low, high = samples[:-1, 0].min(), samples[:-1, 0].max()
        cap, v_scale = min(max(min(wish.v_cap, limits.v_max), low), high), max(high - low, 1e-6)

    def clearance(x, y):
        """Bilinear between the cells' centres, less what a distance can bend between them."""
        fx = (x - around.x0) / around.resolution - 0.5
        fy = (y - around.y0) / around.resolution - 0.5
        if not (0 <= fx < columns - 1 and 0 <= fy < rows - 1):
            return 0.0
        c, r = int(fx), int(fy)
        corners = around.field[r : r + 2, c : c + 2].astype(float)
        d = np.array([1 - fy + r, fy - r]) @ corners @ np.array([1 - fx + c, fx - c])
        a = around.resolution
        return max(0.0, d - 0.5 * a) if d <= a else d - 0.25 * a * a / d

    enough = config.clearance_cap
    if config.clearance_of_path:
        spare = min(clearance(x, y) for x, y in wish.path) - radius - margins.standing
        enough = min(enough, max(spare, 0.03))

    for i, (v1, w1) in enumerate(samples):
        at = pose
        stop = max(abs(v1) / limits.v_brake, abs(w1) / limits.omega_brake)
        must = reach + 0.5 * stop
        gone, turned, clear, strays, aim, aim_turn = 0.0, 0.0, [], [], pose, 0.0
        for k in range(1, max(config.steps, math.ceil(must / step)) + 1):
            share = min(1.0, (k - 0.5) * step / reach)
            now = Twist(twist.v + share * (v1 - twist.v), twist.omega + share * (w1 - twist.omega))
            at = arc(at, now, step)
            gone, turned = gone + abs(now.v) * step, turned + now.omega * step
            free = clearance(at.x, at.y) - radius
            if free < margins.standing and k * step <= must:
                refused[i] = 2
                break
            if k > config.steps:
                continue
            free = max(0.0, free - margins.standing)
            for x, y, vx, vy, r, _ in around.movers:
                gap = math.dist((x + vx * k * step, y + vy * k * step), at[:2])
                gap -= radius + r + margins.movers
                if gap <= 0.0 and k * step <= must + 0.5 * stop:
                    refused[i] = 3
                free = min(free, max(0.0, gap))
            if refused[i]:
                break
            clear.append(free)
            place = gone / wish.spacing
            if int(place) < len(wish.path) - 1:
                index = np.arange(len(wish.path))
                same = [np.interp(place, index, column) for column in wish.path.T]
                strays.append(math.dist(same, at[:2]))
            if gone <= 0.5 * gap_to_target:
                aim, aim_turn = at, turned
        if refused[i]:
            continue
        bearing = math.atan2(wish.target[1] - aim.y, wish.target[0] - aim.x)
        dist = clear[-1] if config.dist == "end" else min(clear)
        terms[i] = (
            1.0 - min(abs(wrap_angle(bearing - pose.theta) - aim_turn), math.pi) / math.pi,
            min(dist, enough) / enough,
            max(0.0, 1.0 - abs(max(v1, 0.0) - cap) / v_scale),
            1.0 - min(1.0, sum(strays) / max(len(strays), 1) / config.path_cap),
        )
    free = refused == 0
    total = terms[free].sum(axis=0) if config.normalisation == "sum" else np.ones(4)
    scaled = terms / np.where(total > 1e-9, total, np.inf)
    score = np.where(free, (scaled * np.array(config.weights)).sum(axis=1), -np.inf)
    return int(np.argmax(score)), refused, terms


def drive_through(start, twist, wanted, ramp, stop, times, hold=0.0):
    """(x, y) (n, 2) at ``times``: the speeds ramp to ``wanted``, hold, and ramp to zero."""
    fine = np.linspace(0.0, max(times[-1], 1e-6), 20001)
    step = fine[1] - fine[0]
    t = fine[:-1] + 0.5 * step
    rising = np.clip(t / ramp, 0.0, 1.0) if ramp > 0.0 else np.ones_like(t)
    left = np.clip(1.0 - (t - ramp - hold) / max(stop, 1e-9), 0.0, 1.0)
    v, omega = (a + (b - a) * rising for a, b in zip(twist, wanted, strict=True))
    falling = np.where(t > ramp + hold, left, 1.0)
    v, omega = v * falling, omega * falling
    theta = start[2] + np.cumsum(omega) * step - 0.5 * omega * step
    x = np.concatenate([[start[0]], start[0] + np.cumsum(v * np.cos(theta)) * step])
    y = np.concatenate([[start[1]], start[1] + np.cumsum(v * np.sin(theta)) * step])
    return np.column_stack([np.interp(times, fine, x), np.interp(times, fine, y)])


def spare_gap(movers, spread, radius, where, times, moves, ahead):
    """The least gap (m) to movers that keep on, stand or turn back, less what they may stray."""
    least = math.inf
    for x, y, vx, vy, r, top in movers:
        speed = math.hypot(vx, vy)
        top = max(top, speed) / speed if speed > 1e-3 else 0.0
        for scale in (1.0, 0.0, -1.0):
            at = np.outer(times + ahead, (vx, vy)) * scale * top + (x, y)
            gaps = np.hypot(*(at - where).T) - radius - r
            least = min(least, (gaps - spread * np.minimum(times + ahead, moves)).min())
    return least


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


def spare_of_rule(centres, footprint, margin, start, pose):
    """Metres that a footprint at ``pose`` (x, y, cos, sin) keeps beyond what it has to, cell by cell.

    It has to keep ``margin`` from each of ``centres`` (k, 2), or what it kept at ``start``.
    """

    def gaps(at):
        x, y, cos, sin = at
        if footprint.is_disc:
            return np.maximum(np.hypot(*(centres - (x, y)).T) - footprint.circumscribed, 0.0)
        placed = footprint.vertices @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
        return shapely.distance(shapely.Polygon(placed), shapely.points(centres))

    return float((gaps(pose) - np.minimum(margin, gaps(start))).min())
