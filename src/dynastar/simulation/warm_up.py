"""Compiling everything that a mission may call, so that its first commands cost what the rest do."""

from dataclasses import replace
from functools import cache

import numpy as np

from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.simulation.scenario import Mover, Scenario

ROOM = """\
####################
#..................#
#..................#
#........##........#
#........##........#
#..................#
#..................#
####################"""


@cache
def warm_up() -> None:
    """Drives a disc and a polygon past a box and towards a walker for a few seconds, once a process."""
    from dynastar.simulation.run import drive

    walker = Mover(0.3, np.array([0.0, 8.0]), np.array([[5.0, 1.2], [1.0, 1.0]]))
    box = np.array([[3.5, 2.0], [4.0, 2.0], [4.0, 2.5], [3.5, 2.5]])
    scenario = Scenario(
        "warm-up",
        OccupancyGrid.from_text(ROOM, resolution=0.5),
        ROBOTS["pioneer3dx"],
        (1.0, 1.0, 0.0),
        (Goal(9.0, 3.0),),
        obstacles=(box,),
        movers=(walker,),
        latency=0.1,
        time_limit=5.0,
    )
    drive(scenario)
    drive(replace(scenario, robot=ROBOTS["jackal"]))
