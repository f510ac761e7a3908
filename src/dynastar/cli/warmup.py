"""``dynastar warmup``: compile everything before it is needed."""

import argparse
import sys
import time

from dynastar import planning, simulation
from dynastar.grid import OccupancyGrid


def execute(arguments: argparse.Namespace) -> int:
    """Plans with every planner, and drives a disc and a polygon past a box and a walker."""
    from tqdm import tqdm

    del arguments
    began = time.perf_counter()
    grid = OccupancyGrid.from_text(["....", ".##.", "...."])
    for step in tqdm([*planning.PLANNERS, "driving"], "compiling", file=sys.stderr):
        if step in planning.PLANNERS:
            planning.plan(grid, (0.5, 0.5), (3.5, 2.5), planner=step, radius=0.25, explored=True)
        else:
            simulation.warm_up()
    print(f"compiled in {time.perf_counter() - began:.1f} s", file=sys.stderr)
    return 0
