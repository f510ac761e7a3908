"""Compiling or loading all that a mission calls, so that nothing is compiled while a robot drives."""

from functools import cache

import numpy as np

from dynastar.geometry import Goal, Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Guard, Navigator, NavigatorConfig, RobotState
from dynastar.planning.search import SearchGrid
from dynastar.robot import ROBOTS
from dynastar.simulation.scenario import Mover, Scenario
from dynastar.simulation.world import World

TICKS, TURNS, PERIOD = 15, 3, 0.1  # s
OPEN, BY_THE_WALL = (1.0, 1.0, 0.0), (1.0, 0.36, 0.0)  # starts; the second is in the inflation


@cache
def warm_up() -> None:
    """Compile or load all kernels of a drive, once per process, so that no command waits for it.

    The first call of a version compiles, which takes half a minute to a minute on two cores; later ones
    load what was compiled. To that end two simulated robots, a disc and a polygon, drive past
    a box and a walker.
    """
    near = SearchGrid(np.zeros((3, 3), bool))  # as for a way out of the inflation
    near.flood((0, 0))
    near.way_to((2, 2))
    # First they turn where they stand, for which the polygon has no room. Then they drive along a path,
    # and last to a goal: by then another process may have compiled the planner.
    occupied = np.pad(np.zeros((58, 98), np.int8), 1, constant_values=100)
    box = np.array([[3.0, 0.6], [3.5, 0.6], [3.5, 1.4], [3.0, 1.4]])
    walker = Mover(0.3, np.array([0.0, 4.0]), np.array([[5.0, 2.2], [1.0, 1.5]]))
    goal = Goal(9.0, 3.0)
    for name, start in ("pioneer3dx", OPEN), ("jackal", BY_THE_WALL):
        grid, robot = OccupancyGrid(occupied, 0.1), ROBOTS[name]
        scenario = Scenario(
            "warm-up", grid, robot, start, (goal,), obstacles=(box,), movers=(walker,), latency=0.1
        )
        world = World(scenario, Pose2D(*start))
        navigator = Navigator(grid, robot, NavigatorConfig(latency=0.1))
        navigator.follow([start[:2]], heading=2.0)
        for tick in range(2 * TICKS + TURNS):
            if tick == TURNS:
                navigator.follow([start[:2], goal[:2]])
            if tick == TURNS + TICKS:
                navigator.set_goal(goal)
            if tick == 2 * TICKS + TURNS - 1:
                navigator.recovery.way_out.is_wanted = True
            state = RobotState(world.time, world.pose, world.twist)
            scan = world.scan()
            command = navigator.command(state, scan)
            world.step(command, PERIOD)
        Guard(robot).filter(state, scan, command)
