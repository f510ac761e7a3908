"""Compiling everything that a mission may call, so that its first commands cost what the rest do."""

from dataclasses import replace
from functools import cache

import numpy as np

from dynastar.dwa import Margins, Passing, Start, Surroundings
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.obstacles import ObstacleLayer
from dynastar.path import Path
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
    _pass(scenario)


def _pass(scenario: Scenario) -> None:
    """The ways past a walker, which few missions need."""
    pose, twist = Pose2D(1.0, 1.0, 0.0), Twist(0.0, 0.0)
    path = Path(np.array([(1.0, 1.0), (3.0, 1.0)])).resampled(0.0, 2.0, 0.1)
    path = np.column_stack([path, np.ones(len(path))])
    walker = np.array([[2.0, 2.0, -0.5, -0.5, 0.3, 0.7]])
    passing, margins = Passing(scenario.robot, 0.1), Margins(0.1, 0.1, 0.1)
    layer = ObstacleLayer()
    around = Surroundings(layer.field, *layer.origin, layer.config.resolution, walker)
    start = Start(pose, twist, around, path, margins)
    passing.evade(start)
    passing.go_on(start)
