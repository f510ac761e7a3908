"""The search for a witness: the best first over stops on a lattice and time."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@njit(cache=True)
def travelled(time: float, distance: float, v_max: float, accel: float, brake: float) -> float:
    """Metres driven ``time`` s into a move of ``distance`` m from rest to rest, as fast as can be."""
    ramp_up, ramp_down = 0.5 * v_max * v_max / accel, 0.5 * v_max * v_max / brake
    top = v_max
    if ramp_up + ramp_down > distance:
        top = math.sqrt(2.0 * distance * accel * brake / (accel + brake))
        ramp_up, ramp_down = 0.5 * top * top / accel, 0.5 * top * top / brake
    up, flat = top / accel, (distance - ramp_up - ramp_down) / top
    if time <= up:
        return 0.5 * accel * time * time
    if time <= up + flat:
        return ramp_up + top * (time - up)
    left = max(up + flat + top / brake - time, 0.0)
    return distance - 0.5 * brake * left * left


@njit(cache=True)
def duration(distance: float, v_max: float, accel: float, brake: float) -> float:
    """Seconds of a move of ``distance`` m (or rad) from rest to rest, as fast as can be."""
    if distance <= 0.0:
        return 0.0
    ramps = 0.5 * v_max * v_max * (1.0 / accel + 1.0 / brake)
    if ramps <= distance:
        return v_max / accel + v_max / brake + (distance - ramps) / v_max
    top = math.sqrt(2.0 * distance * accel * brake / (accel + brake))
    return top / accel + top / brake


@njit(cache=True)
def in_sight(
    ax: float, ay: float, bx: float, by: float, blocked: npt.NDArray[np.bool_], cell: float
) -> bool:
    """Whether no blocked cell lies on the line from (ax, ay) to (bx, by), in steps of half a cell."""
    steps = int(math.hypot(bx - ax, by - ay) / (0.5 * cell)) + 1
    for i in range(steps + 1):
        part = i / steps
        row, column = int((ay + part * (by - ay)) / cell), int((ax + part * (bx - ax)) / cell)
        if blocked[row, column]:
            return False
    return True


@njit(cache=True)
def clear_of_walkers(x, y, sample, positions, radii, need, stop, ahead, blocked, cell):
    """Whether a disc at (x, y) m is clear of all walkers at one sample.

    ``positions`` [samples, m, 2]. ``need`` is metres from the disc's centre to a walker's edge. While
    the robot drives, ``stop`` (m) is not negative, and the edge of a walker out of sight has to be
    ``stop`` further away, at all samples from now to ``ahead`` on.
    """
    last = len(positions) - 1
    now = min(sample, last)
    for m in range(len(radii)):
        dx, dy = positions[now, m, 0] - x, positions[now, m, 1] - y
        reach = need + radii[m]
        if dx * dx + dy * dy < reach * reach:
            return False
        if stop < 0.0:
            continue
        near, far = False, reach + stop
        for later in range(now, min(now + ahead, last) + 1, 4):
            ex, ey = positions[later, m, 0] - x, positions[later, m, 1] - y
            if ex * ex + ey * ey < far * far:
                near = True
                break
        if near and not in_sight(x, y, x + dx, y + dy, blocked, cell):
            return False
    return True


@njit(cache=True)
def top_speed(distance: float, v_max: float, accel: float, brake: float) -> float:
    """The highest speed of a move of ``distance`` m from rest to rest."""
    return min(v_max, math.sqrt(2.0 * distance * accel * brake / (accel + brake)))


@njit(cache=True)
def rests(free, lattice, positions, radii, person):
    """First and last tick [rows, columns, ticks] of the rest at a node that each tick is in; -1 for none.

    During a rest nobody comes nearer to the node than ``person`` m.
    """
    rows, columns = free.shape
    pitch, samples, x0, y0 = lattice[0], lattice[2], lattice[3], lattice[4]
    ticks = len(positions) // samples
    first = np.full((rows, columns, ticks), -1, np.int32)
    last = np.full((rows, columns, ticks), -1, np.int32)
    for row in range(rows):
        for column in range(columns):
            if not free[row, column]:
                continue
            x, y, begin = x0 + column * pitch, y0 + row * pitch, -1
            for tick in range(ticks):
                for k in range(max(tick * samples - samples + 1, 0), tick * samples + 1):
                    clear = True
                    for m in range(len(radii)):
                        dx, dy = positions[k, m, 0] - x, positions[k, m, 1] - y
                        if dx * dx + dy * dy < (person + radii[m]) ** 2:
                            clear = False
                            break
                    if not clear:
                        begin = -1
                        if k == tick * samples:
                            break
                    elif k == tick * samples:
                        begin = tick if begin < 0 else begin
                first[row, column, tick] = begin
            end = -1
            for tick in range(ticks - 1, -1, -1):
                if first[row, column, tick] < 0:
                    end = -1
                    continue
                if end < 0 or first[row, column, tick] != first[row, column, end]:
                    end = tick
                last[row, column, tick] = end
    return first, last


@njit(cache=True)
def drive_clear(node, drive, lattice, gaps, blocked, positions, radii, needs, limits):
    """Whether a drive from a node (row, column, heading, tick) touches nothing.

    ``drive`` is its length (m, below 0 backwards) and its ticks.
    """
    pitch, tick, samples, x0, y0, cell = lattice
    wall, person, react = needs
    accel, brake = limits[2], limits[3]
    length, took = drive
    row, column, heading, begin = node
    speed = limits[0] if length > 0.0 else limits[1]
    step, top = tick / samples, top_speed(abs(length), speed, accel, brake)
    stop = top * react + 0.5 * top * top / brake
    ahead = int((react + top / brake) / step) + 1
    cos, sin = math.cos(heading * math.pi / 4), math.sin(heading * math.pi / 4)
    for k in range(1, took * samples + 1):
        at = travelled(k * step, abs(length), speed, accel, brake)
        moving = at < abs(length)
        at = math.copysign(at, length)
        x, y = x0 + column * pitch + at * cos, y0 + row * pitch + at * sin
        if gaps[int(y / cell), int(x / cell)] < wall:
            return False
        if not clear_of_walkers(
            x, y, begin * samples + k, positions, radii, person, stop if moving else -1.0, ahead,
            blocked, cell,
        ):  # fmt: skip
            return False
    return True


@njit(cache=True)
def search(
    start, lattice, gaps, blocked, to_go, positions, radii, needs, moves, turns, limits, most
):
    """Legs (n, 5) from ``start`` (row, column, heading, tick) to a target; (0, 5) if none is found.

    ``lattice`` is its pitch (m), a tick (s), samples of a tick, x and y of node (0, 0), and the side of
    a cell (m). ``gaps`` and ``blocked`` are by cell, ``to_go`` [rows, columns] is seconds to a target,
    roughly, inf where no robot can stand. ``needs`` is metres from the robot's centre to walls and to
    walkers' edges, and seconds to react. ``limits`` is v_max, v_back, accel, brake, omega_max,
    omega_accel, omega_brake. ``moves`` are in steps of the lattice, ``turns`` in eighths. A leg is begin
    and duration (ticks), distance (m), turn and heading before it (eighths).

    A state is a node, a heading and a rest there, reached as early as possible: who gets there early
    can wait [Phillips2011]. Also returns how many states were made.
    """
    rows, columns = to_go.shape
    pitch, tick, samples = lattice[0], lattice[1], lattice[2]
    ticks = len(positions) // samples
    first, last = rests(np.isfinite(to_go), lattice, positions, radii, needs[1])
    early = np.full((8, rows, columns, ticks), 32000, np.int16)  # by first tick of a rest
    node = np.empty((most, 4), np.int64)
    parent, following = np.empty(most, np.int64), np.empty(most, np.int64)
    leg = np.zeros((most, 5))
    queue = np.full(6 * ticks, -1, np.int64)  # of the states of one cost, the latest
    for i in range(4):
        node[0, i] = start[i]
    parent[0], following[0] = -1, -1
    count, level, found = 1, 0, -1
    if first[start[0], start[1], start[3]] >= 0:
        queue[0] = 0
    while level < len(queue) and count < most - 64:
        this = queue[level]
        if this < 0:
            level += 1
            continue
        queue[level] = following[this]
        r, c, h, t = node[this]
        if early[h, r, c, first[r, c, t]] < t:
            continue
        if to_go[r, c] <= 0.0:
            found = this
            break
        until = last[r, c, t]
        for option in range(len(turns) + len(moves)):
            length, turn, nr, nc = 0.0, 0, r, c
            if option < len(turns):
                turn = turns[option]
                seconds = duration(abs(turn) * math.pi / 4, limits[4], limits[5], limits[6])
            else:
                steps = moves[option - len(turns)]
                dx, dy = round(math.cos(h * math.pi / 4)), round(math.sin(h * math.pi / 4))
                nr, nc = r + steps * int(dy), c + steps * int(dx)
                speed = limits[0] if steps > 0 else limits[1]
                if not (0 <= nr < rows and 0 <= nc < columns) or speed <= 0.0:
                    continue
                if not math.isfinite(to_go[nr, nc]):
                    continue
                length = steps * pitch * math.hypot(dx, dy)
                seconds = duration(abs(length), speed, limits[2], limits[3])
            took, nh = max(1, int(math.ceil(seconds / tick - 1e-9))), (h + turn) % 8
            begin = t
            while begin <= until and begin + took < ticks:
                there = begin + took
                rest = first[nr, nc, there]
                if turn != 0 and there > until:
                    break
                if rest < 0:
                    begin += 1
                    continue
                if early[nh, nr, nc, rest] <= there:
                    begin = last[nr, nc, there] - took + 1
                    continue
                if turn == 0 and not drive_clear(
                    (r, c, h, begin), (length, took), lattice, gaps, blocked, positions, radii, needs,
                    limits,
                ):  # fmt: skip
                    begin += 1 + (begin - t) // 10  # later departures are tried less densely
                    continue
                early[nh, nr, nc, rest] = there
                cost = int(there + 1.5 * to_go[nr, nc] / tick)
                if cost < len(queue) and count < most:
                    node[count] = (nr, nc, nh, there)
                    leg[count] = (float(begin), float(took), length, float(turn), float(h))
                    parent[count], following[count] = this, queue[cost]
                    queue[cost], level = count, min(level, cost)
                    count += 1
                begin = last[nr, nc, there] - took + 1
    n, at = 0, found
    while at >= 0 and parent[at] >= 0:
        n, at = n + 1, parent[at]
    legs, at = np.empty((n, 5)), found
    for i in range(n - 1, -1, -1):
        legs[i] = leg[at]
        at = parent[at]
    return legs, count


@njit(cache=True)
def seconds_to_go(free, targets, pitch, v_max):
    """Seconds at full speed from each node of a lattice to the nearest target; inf without a way."""
    rows, columns = free.shape
    out = np.full((rows, columns), np.inf)
    for row in range(rows):
        for column in range(columns):
            if targets[row, column] and free[row, column]:
                out[row, column] = 0.0
    changed = True
    while changed:
        changed = False
        for turn in range(2):
            for i in range(rows * columns):
                index = i if turn == 0 else rows * columns - 1 - i
                row, column = index // columns, index % columns
                if not free[row, column]:
                    continue
                for dy in range(-1, 2):
                    for dx in range(-1, 2):
                        r, c = row + dy, column + dx
                        if 0 <= r < rows and 0 <= c < columns and (dx != 0 or dy != 0):
                            cost = out[r, c] + pitch * math.hypot(dx, dy) / v_max
                            if cost < out[row, column] - 1e-9:
                                out[row, column] = cost
                                changed = True
    return out
