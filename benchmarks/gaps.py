"""How much wider than itself a gap has to be for a robot to pass it.

A wall that no map has stands across an empty room, askew, with a gap beyond which the goal lies. The gap
is as wide as the robot, twice the declared errors of ranges and position, which are as large as they may
be, and some centimetres more.

    python benchmarks/gaps.py --missions 8
"""

import argparse
import itertools
import math
import os

import numpy as np

from dynastar import OccupancyGrid
from dynastar.bench.workers import completed
from dynastar.geometry import Goal
from dynastar.robot import ROBOTS
from dynastar.simulation import Scenario, run, warm_up
from dynastar.simulation.scenario import Noise

NAMES = ("turtlebot3_burger", "pioneer3dx", "jackal")
ERRORS = ((0.01, 0.01), (0.03, 0.02))  # m, of ranges and of the position
MORE = (0.03, 0.06, 0.1, 0.15, 0.2)  # m
THICK, LONG = 0.15, 8.0  # m, of the wall

Job = tuple[str, tuple[float, float], float, int]


def scenario(job: Job) -> Scenario:
    """A mission through a gap."""
    name, (ranges, position), more, number = job
    robot, random = ROBOTS[name], np.random.default_rng(number)
    values = np.zeros((120, 160), np.int8)
    values[[0, -1]], values[:, [0, -1]] = 100, 100
    half = robot.footprint.half_width + ranges + position + 0.5 * more
    middle, angle = random.uniform((3.7, 2.0), (4.3, 4.0)), random.uniform(-0.3, 0.3)
    cos, sin = math.cos(angle), math.sin(angle)
    walls = []
    for low, high in ((-LONG, -half), (half, LONG)):
        corners = np.array([(-THICK, low), (THICK, low), (THICK, high), (-THICK, high)]) * (
            0.5,
            1.0,
        )
        walls.append(corners @ np.array([(cos, sin), (-sin, cos)]) + middle)
    return Scenario(
        name="gap",
        grid=OccupancyGrid(values, 0.05),
        robot=robot,
        start=(1.5, 3.0, 0.0),
        goals=(Goal(6.5, 3.0),),
        obstacles=tuple(walls),
        noise=Noise(ranges, position),
        seed=number,
        time_limit=120.0,
        navigator={"range_error": ranges, "pose_error": position},
    )


def outcome(job: Job) -> str:
    """How the mission of a job ends."""
    return run(scenario(job)).outcome


def main() -> None:
    """Prints the arrivals by robot, errors and width."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--missions", type=int, default=8, metavar="N", help="for each gap")
    missions = parser.parse_args().missions
    warm_up()
    kinds = list(itertools.product(NAMES, ERRORS))
    jobs = [(*kind, more, n) for kind in kinds for more in MORE for n in range(missions)]
    ends = dict(completed(outcome, jobs, os.cpu_count() or 1))
    print(f"arrived of {missions}; m beyond the robot's width and twice the errors")
    print(f"{'robot':20}{'range':>8}{'pose':>8}" + "".join(f"{more:8.2f}" for more in MORE))
    for name, errors in kinds:
        counts = [
            sum(
                ends[at] == "arrived"
                for at, job in enumerate(jobs)
                if job[:3] == (name, errors, more)
            )
            for more in MORE
        ]
        print(
            f"{name:20}"
            + "".join(f"{error:8.2f}" for error in errors)
            + "".join(f"{n:8}" for n in counts)
        )
    touched = [job for at, job in enumerate(jobs) if ends[at] == "contact"]
    print(f"contacts: {len(touched)} of {len(jobs)}", *touched)


if __name__ == "__main__":
    main()
