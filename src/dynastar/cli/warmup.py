"""``dynastar warmup``: compile everything before it is needed."""

import argparse
import sys
import time

from dynastar import compiled, planning, simulation
from dynastar.grid import OccupancyGrid


def execute(arguments: argparse.Namespace) -> int:
    """Plans with every planner and smoothing, and drives a disc and a polygon past a box and a walker."""
    if arguments.clear:
        print(f"{compiled.clear() / 1e6:.0f} MB deleted from {compiled.caches()}", file=sys.stderr)
        return 0
    from tqdm import tqdm

    began = time.perf_counter()
    grid = OccupancyGrid.from_text(["....", ".##.", "...."])
    for step in tqdm([*planning.ALGORITHMS, "again", "driving"], "compiling", file=sys.stderr):
        if step in planning.ALGORITHMS:
            planning.plan(grid, (0.5, 0.5), (3.5, 2.5), planner=step, radius=0.25, explored=True)
        elif step == "again":
            planning.warm_up_rest()
        else:
            simulation.warm_up()
    print(f"compiled in {time.perf_counter() - began:.1f} s", file=sys.stderr)
    return 0
