"""Compiling or loading what the simulator calls, so that its first step costs what the rest do."""

from functools import cache

import numpy as np

from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.simulation.scenario import Mover, Scenario
from dynastar.simulation.world import World


@cache
def warm_up() -> None:
    """Looks round and moves as a disc and as a polygon beside a box and a walker, once a process."""
    start = Pose2D(1.0, 1.0, 0.0)
    box = np.array([[3.5, 2.0], [4.0, 2.0], [4.0, 2.5], [3.5, 2.5]])
    walker = Mover(0.3, np.array([0.0, 8.0]), np.array([[5.0, 1.2], [1.0, 1.0]]))
    for robot in "pioneer3dx", "jackal":
        world = World(
            Scenario(
                "warm-up",
                OccupancyGrid(np.zeros((40, 100), dtype=np.int8), 0.1),
                ROBOTS[robot],
                start,
                (Goal(9.0, 3.0),),
                obstacles=(box,),
                movers=(walker,),
            ),
            start,
        )
        world.scan()
        world.step(Twist(0.1, 0.0), 0.1)
