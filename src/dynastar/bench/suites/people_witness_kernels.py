"""What a search for a witness is told, how the robot moves, and whether that touches somebody."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, njit

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class Lattice(NamedTuple):
    """Places and times of stops: nodes ``pitch`` (m) apart, the first at (x0, y0) m, ticks (s).

    ``samples`` are the positions of walkers in a tick, ``cell`` (m) is the side of a cell of the map.
    """

    pitch: float
    tick: float
    samples: int
    x0: float
    y0: float
    cell: float


class Space(NamedTuple):
    """``gaps`` (m) and ``blocked`` are by cell of the map, ``to_go`` [rows, columns] by node.

    ``to_go`` is the seconds to a target, roughly, inf where no robot can stand.
    """

    gaps: Floats
    blocked: npt.NDArray[np.bool_]
    to_go: Floats


class People(NamedTuple):
    """``positions`` [samples, m, 2] and ``radii`` (m,) of the walkers, metres."""

    positions: Floats
    radii: Floats


class Needs(NamedTuple):
    """Metres from the robot's centre to walls and to walkers' edges, and seconds to react."""

    wall: float
    person: float
    react: float


class Drive(NamedTuple):
    """Limits of the robot, its ``moves`` in steps of the lattice and its ``turns`` in eighths."""

    v_max: float
    v_back: float
    accel: float
    brake: float
    omega_max: float
    omega_accel: float
    omega_brake: float
    moves: Ints
    turns: Ints


class Task(NamedTuple):
    """All that a search knows beside its start."""

    lattice: Lattice
    space: Space
    people: People
    needs: Needs
    drive: Drive


class Step(NamedTuple):
    """A way on from a stop: ``length`` (m, below 0 backwards), ``turn`` (eighths), node, ticks."""

    length: float
    turn: int
    row: int
    column: int
    took: int


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


@inner
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


@inner
def clear_of_walkers(x, y, sample, people, need, stop, map_):
    """Whether a disc at (x, y) m is clear of all walkers at one sample.

    ``need`` is metres from the disc's centre to a walker's edge. ``stop`` is a distance (m), not negative
    while the robot drives, and a number of samples: the edge of a walker out of sight has to be so much
    further away, at all samples from now to so many on. ``map_`` is which cells are blocked and their
    side (m).
    """
    positions, radii = people
    further, ahead = stop
    blocked, cell = map_
    last = len(positions) - 1
    now = min(sample, last)
    for m in range(len(radii)):
        dx, dy = positions[now, m, 0] - x, positions[now, m, 1] - y
        reach = need + radii[m]
        if dx * dx + dy * dy < reach * reach:
            return False
        if further < 0.0:
            continue
        near, far = False, reach + further
        for later in range(now, min(now + ahead, last) + 1, 4):
            ex, ey = positions[later, m, 0] - x, positions[later, m, 1] - y
            if ex * ex + ey * ey < far * far:
                near = True
                break
        if near and not in_sight(x, y, x + dx, y + dy, blocked, cell):
            return False
    return True


@inner
def top_speed(distance: float, v_max: float, accel: float, brake: float) -> float:
    """The highest speed of a move of ``distance`` m from rest to rest."""
    return min(v_max, math.sqrt(2.0 * distance * accel * brake / (accel + brake)))


@inner
def drive_clear(node, begin, step, task):
    """Whether a drive that leaves a node (row, column, heading, ...) at a tick touches nothing."""
    lattice, drive, people, needs = task.lattice, task.drive, task.people, task.needs
    gaps, cell = task.space.gaps, lattice.cell
    map_ = (task.space.blocked, cell)
    row, column, heading = node[0], node[1], node[2]
    length = step.length
    speed = drive.v_max if length > 0.0 else drive.v_back
    pause, top = (
        lattice.tick / lattice.samples,
        top_speed(abs(length), speed, drive.accel, drive.brake),
    )
    stop = top * needs.react + 0.5 * top * top / drive.brake
    ahead = int((needs.react + top / drive.brake) / pause) + 1
    cos, sin = math.cos(heading * math.pi / 4), math.sin(heading * math.pi / 4)
    for k in range(1, step.took * lattice.samples + 1):
        at = travelled(k * pause, abs(length), speed, drive.accel, drive.brake)
        moving = at < abs(length)
        at = math.copysign(at, length)
        x = lattice.x0 + column * lattice.pitch + at * cos
        y = lattice.y0 + row * lattice.pitch + at * sin
        if gaps[int(y / cell), int(x / cell)] < needs.wall:
            return False
        sample = begin * lattice.samples + k
        further = stop if moving else -1.0
        if not clear_of_walkers(x, y, sample, people, needs.person, (further, ahead), map_):
            return False
    return True


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
