"""``dynastar warmup``: compile everything before it is needed."""

import argparse
import sys
import time

from dynastar import planning, simulation
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Scenario

ROOM = """\
####################
#..................#
#..................#
#........##........#
#........##........#
#..................#
#..................#
####################"""


def execute(arguments: argparse.Namespace) -> int:
    """Plans with every planner and drives a disc and a polygon past a box and a walker."""
    import numpy as np
    from tqdm import tqdm

    del arguments
    began = time.perf_counter()
    grid = OccupancyGrid.from_text(ROOM, resolution=0.5)
    steps = tqdm([*planning.PLANNERS, "pioneer3dx", "jackal"], "compiling", file=sys.stderr)
    for step in steps:
        if step in planning.PLANNERS:
            planning.plan(grid, (1.0, 1.0), (9.0, 3.0), planner=step, radius=0.25, explored=True)
            continue
        walker = Mover(0.3, np.array([0.0, 8.0]), np.array([[7.5, 3.2], [3.0, 3.2]]))
        box = np.array([[3.5, 1.0], [4.0, 1.0], [4.0, 1.5], [3.5, 1.5]])
        simulation.run(
            Scenario(
                "warmup",
                grid,
                ROBOTS[step],
                (1.0, 1.0, 0.0),
                (Goal(9.0, 3.0),),
                obstacles=(box,),
                movers=(walker,),
                time_limit=30.0,
            )
        )
    print(f"compiled in {time.perf_counter() - began:.1f} s", file=sys.stderr)
    return 0
