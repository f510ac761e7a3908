"""Witnesses: a motion of the robot among scripted walkers that nobody and nothing touches.

A world of scripted walkers is kept only if a witness is found for it. A witness starts at rest, drives
straight stretches and turns on the spot, each from rest to rest within the robot's limits, waits where
it has to, and ends at rest within the goal's tolerance before the time limit. It keeps 0.1 m or more to
walkers, also while it rests, and 3 cm or more to walls, for the circumscribed disc.

The search knows all scripts, but a motion may not rest on that alone: while a witness drives, nobody
out of its sight (behind a wall) is so near, now or within the time of a stop, that a robot which reacts
0.5 s after it sees somebody and brakes from full speed would be touched. So somebody who steps out from
behind a corner can be met by a robot that stops once it sees them. What the rule does not show is that
a robot can know where to wait: that is the navigator's task.

The search is a weighted best-first search over positions 0.25 m apart, eight headings and time. What
it does not find within its limits may still exist; such a world is left out nevertheless.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench.suites import people_witness_kernels as kernels
from dynastar.bench.suites.people_sites import Point
from dynastar.bench.suites.people_witness_search import search
from dynastar.clearance import distance_field
from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.robot import Robot
from dynastar.simulation import Mover
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]

PITCH, TICK, SAMPLES = 0.25, 0.2, 4  # m, s, samples of a tick
WALL_GAP, WALKER_GAP = 0.08, 0.18  # m, at the samples; 0.03 and 0.1 m are left between them
REACT = 0.5  # s until a robot that sees somebody begins to brake
FIRST = 2  # ticks at rest at first
NEAR_GOAL = 0.2  # m from the goal to a stop that counts as there
MOST_STOPS = 600_000
MOVES = np.array([1, 2, 4, 8, 16, -1, -2, -4])  # steps of the lattice
TURNS = np.array([1, -1, 2, -2, 3, -3, 4])  # eighths of a turn


class Witness(NamedTuple):
    """Legs (n, 5) from ``start``: begin (s), duration (s), distance (m), turn (rad), heading (rad)."""

    start: Pose2D
    legs: Floats


def lattice_heading(bearing: float) -> float:
    """The multiple of an eighth of a turn (rad) nearest to a bearing."""
    return round(bearing / (math.pi / 4)) * math.pi / 4


def find_witness(
    grid: OccupancyGrid,
    robot: Robot,
    walkers: Sequence[Mover],
    ends: tuple[Point, Point],
    heading: float,
    seconds: float,
) -> Witness | None:
    """A witness from one of ``ends`` to the other within ``seconds``; None if none is found.

    The start's ``heading`` (rad) is a multiple of an eighth of a turn.
    """
    (start, goal), cell, limits = ends, grid.resolution, robot.limits
    gaps = distance_field(grid.occupied, cell).astype(np.float64) - 0.5 * cell
    offset = np.mod(start, PITCH)
    x = np.arange(offset[0], grid.columns * cell, PITCH)
    y = np.arange(offset[1], grid.rows * cell, PITCH)
    radius = robot.footprint.circumscribed
    at_nodes = gaps[np.ix_((y / cell).astype(int), (x / cell).astype(int))]
    free = at_nodes >= radius + WALL_GAP
    targets = np.hypot(x[None] - goal[0], y[:, None] - goal[1]) <= NEAR_GOAL
    speed = 2.0 / kernels.duration(2.0, limits.v_max, limits.v_accel, limits.v_brake)
    to_go = kernels.seconds_to_go(free, targets, PITCH, speed)
    row, column = round((start[1] - offset[1]) / PITCH), round((start[0] - offset[0]) / PITCH)
    if not math.isfinite(to_go[row, column]):
        return None
    movers, step = Movers(walkers), TICK / SAMPLES
    count = SAMPLES * int(seconds / TICK)
    positions = np.array([movers.at(k * step) for k in range(count)])
    task = kernels.Task(
        kernels.Lattice(PITCH, TICK, SAMPLES, float(offset[0]), float(offset[1]), cell),
        kernels.Space(gaps, np.ascontiguousarray(grid.occupied), to_go),
        kernels.People(positions.reshape(count, -1, 2), movers.radii),
        kernels.Needs(radius + WALL_GAP, radius + WALKER_GAP, REACT),
        kernels.Drive(
            limits.v_max, -limits.v_min, limits.v_accel, limits.v_brake,
            limits.omega_max, limits.omega_accel, limits.omega_brake, MOVES, TURNS,
        ),
    )  # fmt: skip
    begin = (row, column, round(heading / (math.pi / 4)) % 8, FIRST)
    legs, _ = search(begin, task, MOST_STOPS)
    if len(legs) == 0 and not to_go[row, column] <= 0.0:
        return None
    legs = legs * np.array([TICK, TICK, 1.0, math.pi / 4, math.pi / 4])
    return Witness(Pose2D(*start, heading), legs)


def sampled(witness: Witness, robot: Robot, step: float) -> tuple[Floats, Floats]:
    """Times (n,) every ``step`` s and poses (n, 3) of a witness, from 0 to its end."""
    limits, pose = robot.limits, np.array(witness.start, dtype=np.float64)
    last = float(witness.legs[-1, 0] + witness.legs[-1, 1]) if len(witness.legs) else 0.0
    times = step * np.arange(math.floor(last / step) + 1, dtype=np.float64)
    poses = np.empty((len(times), 3))
    poses[:] = pose
    for begin, seconds, distance, turn, _ in witness.legs:
        after = times >= begin
        done = np.empty((len(times), 2))
        speed = limits.v_max if distance > 0 else -limits.v_min
        for k in np.flatnonzero(after):
            into = min(times[k] - begin, seconds)
            done[k, 0] = math.copysign(
                kernels.travelled(into, abs(distance), speed, limits.v_accel, limits.v_brake)
                if distance
                else 0.0,
                distance,
            )
            done[k, 1] = math.copysign(
                kernels.travelled(
                    into, abs(turn), limits.omega_max, limits.omega_accel, limits.omega_brake
                )
                if turn
                else 0.0,
                turn,
            )
        poses[after, 0] = pose[0] + done[after, 0] * math.cos(pose[2])
        poses[after, 1] = pose[1] + done[after, 0] * math.sin(pose[2])
        poses[after, 2] = pose[2] + done[after, 1]
        pose += (distance * math.cos(pose[2]), distance * math.sin(pose[2]), turn)
    return times, poses
