"""The search for a witness: the best first over stops on a lattice and time."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench.suites.people_witness_kernels import Step, drive_clear, duration
from dynastar.compiled import allocating, inner, njit

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class Rests(NamedTuple):
    """``first`` and ``last`` tick [rows, columns, ticks] of the rest at a node that a tick is in; else -1.

    ``early`` [8, rows, columns, ticks] is the earliest arrival found, by heading and first tick of a rest.
    """

    first: npt.NDArray[np.int32]
    last: npt.NDArray[np.int32]
    early: npt.NDArray[np.int16]


class Tree(NamedTuple):
    """States that were made: ``node`` (row, column, heading, tick), the ``leg`` that led there, parents.

    ``queue`` has the latest state of each cost, ``following`` the one before it of the same cost.
    """

    node: Ints
    leg: Floats
    parent: Ints
    following: Ints
    queue: Ints


@allocating
def find_rests(task):
    """The rests at all nodes; during a rest nobody comes nearer to the node than ``needs.person``."""
    rows, columns = task.space.to_go.shape
    ticks = len(task.people.positions) // task.lattice.samples
    first = np.full((rows, columns, ticks), -1, np.int32)
    last = np.full((rows, columns, ticks), -1, np.int32)
    for row in range(rows):
        for column in range(columns):
            if not math.isfinite(task.space.to_go[row, column]):
                continue
            begin_rests(row, column, task, first)
            end = -1
            for tick in range(ticks - 1, -1, -1):
                if first[row, column, tick] < 0:
                    end = -1
                    continue
                if end < 0 or first[row, column, tick] != first[row, column, end]:
                    end = tick
                last[row, column, tick] = end
    early = np.full((8, rows, columns, ticks), 32000, np.int16)
    return Rests(first, last, early)


@inner
def begin_rests(row, column, task, first):
    """Writes to ``first`` the first tick of the rest at a node that each tick is in, or -1."""
    lattice, positions, radii = task.lattice, task.people.positions, task.people.radii
    samples = lattice.samples
    x, y = lattice.x0 + column * lattice.pitch, lattice.y0 + row * lattice.pitch
    begin = -1
    for tick in range(first.shape[2]):
        for k in range(max(tick * samples - samples + 1, 0), tick * samples + 1):
            clear = True
            for m in range(len(radii)):
                dx, dy = positions[k, m, 0] - x, positions[k, m, 1] - y
                if dx * dx + dy * dy < (task.needs.person + radii[m]) ** 2:
                    clear = False
                    break
            if not clear:
                begin = -1
                if k == tick * samples:
                    break
            elif k == tick * samples:
                begin = tick if begin < 0 else begin
        first[row, column, tick] = begin


@inner
def step_of(option, node, task):
    """The step that is the ``option``-th of all turns and moves; 0 ticks where it cannot be made."""
    lattice, drive, to_go = task.lattice, task.drive, task.space.to_go
    row, column, heading = node[0], node[1], node[2]
    if option < len(drive.turns):
        turn = drive.turns[option]
        seconds = duration(
            abs(turn) * math.pi / 4, drive.omega_max, drive.omega_accel, drive.omega_brake
        )
        return Step(0.0, turn, row, column, max(1, int(math.ceil(seconds / lattice.tick - 1e-9))))
    steps = drive.moves[option - len(drive.turns)]
    dx = round(math.cos(heading * math.pi / 4))
    dy = round(math.sin(heading * math.pi / 4))
    there, across = row + steps * int(dy), column + steps * int(dx)
    speed = drive.v_max if steps > 0 else drive.v_back
    inside = 0 <= there < to_go.shape[0] and 0 <= across < to_go.shape[1]
    if not inside or speed <= 0.0 or not math.isfinite(to_go[there, across]):
        return Step(0.0, 0, row, column, 0)
    length = steps * lattice.pitch * math.hypot(dx, dy)
    seconds = duration(abs(length), speed, drive.accel, drive.brake)
    return Step(length, 0, there, across, max(1, int(math.ceil(seconds / lattice.tick - 1e-9))))


@inner
def make_states(this, step, task, rests, tree, count):
    """Makes the states that one step from a state leads to; returns their number, old ones included.

    Also returns the lowest cost of a new state. A rest that follows is reached as early as possible.
    """
    r, c, h, t = tree.node[this]
    nr, nc, nh = step.row, step.column, (h + step.turn) % 8
    ticks, until = rests.first.shape[2], rests.last[r, c, t]
    begin, lowest = t, len(tree.queue)
    while begin <= until and begin + step.took < ticks:
        there = begin + step.took
        rest = rests.first[nr, nc, there]
        if step.turn != 0 and there > until:
            break
        if rest < 0:
            begin += 1
            continue
        if rests.early[nh, nr, nc, rest] <= there:
            begin = rests.last[nr, nc, there] - step.took + 1
            continue
        if step.turn == 0 and not drive_clear(tree.node[this], begin, step, task):
            begin += 1 + (begin - t) // 10  # later departures are tried less densely
            continue
        rests.early[nh, nr, nc, rest] = there
        cost = int(there + 1.5 * task.space.to_go[nr, nc] / task.lattice.tick)
        if cost < len(tree.queue) and count < len(tree.node):
            tree.node[count] = (nr, nc, nh, there)
            tree.leg[count] = (
                float(begin), float(step.took), step.length, float(step.turn), float(h)
            )  # fmt: skip
            tree.parent[count], tree.following[count] = this, tree.queue[cost]
            tree.queue[cost], lowest = count, min(lowest, cost)
            count += 1
        begin = rests.last[nr, nc, there] - step.took + 1
    return count, lowest


@allocating
def legs_to(found, tree):
    """The legs (n, 5) that led to a state, in order; (0, 5) for state -1."""
    n, at = 0, found
    while at >= 0 and tree.parent[at] >= 0:
        n, at = n + 1, tree.parent[at]
    legs, at = np.empty((n, 5)), found
    for i in range(n - 1, -1, -1):
        legs[i] = tree.leg[at]
        at = tree.parent[at]
    return legs


@njit(cache=True)
def search(start, task, most):
    """Legs (n, 5) from ``start`` (row, column, heading, tick) to a target; (0, 5) if none is found.

    A leg is begin and duration (ticks), distance (m), turn and heading before it (eighths). At most
    ``most`` states are made.

    A state is a node, a heading and a rest there, reached as early as possible: who gets there early
    can wait [Phillips2011]. Also returns how many states were made.
    """
    rests = find_rests(task)
    tree = Tree(
        np.empty((most, 4), np.int64),
        np.zeros((most, 5)),
        np.empty(most, np.int64),
        np.empty(most, np.int64),
        np.full(6 * rests.first.shape[2], -1, np.int64),
    )
    for i in range(4):
        tree.node[0, i] = start[i]
    tree.parent[0], tree.following[0] = -1, -1
    count, level, found = 1, 0, -1
    if rests.first[start[0], start[1], start[3]] >= 0:
        tree.queue[0] = 0
    while level < len(tree.queue) and count < most - 64:
        this = tree.queue[level]
        if this < 0:
            level += 1
            continue
        tree.queue[level] = tree.following[this]
        r, c, h, t = tree.node[this]
        if rests.early[h, r, c, rests.first[r, c, t]] < t:
            continue
        if task.space.to_go[r, c] <= 0.0:
            found = this
            break
        for option in range(len(task.drive.turns) + len(task.drive.moves)):
            step = step_of(option, tree.node[this], task)
            if step.took > 0:
                count, lowest = make_states(this, step, task, rests, tree, count)
                level = min(level, lowest)
    return legs_to(found, tree), count
