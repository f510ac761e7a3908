"""Compiling or loading all that a mission calls, so that nothing is compiled while a robot drives.

Two processes can share the work: what one has compiled, the other loads. ``warm_up_sensing`` begins
with the kernels that ``warm_up`` comes to last.
"""

from collections.abc import Iterator
from functools import cache

import numpy as np

from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.guidance import PathTarget
from dynastar.navigator import Guard, Navigator, NavigatorConfig, RobotState
from dynastar.path import Path
from dynastar.perception import MovingObstacle
from dynastar.planning.search import SearchGrid
from dynastar.robot import ROBOTS, Robot
from dynastar.simulation.scenario import Mover, Scenario
from dynastar.simulation.world import World

TICKS, TURNS, PERIOD = 15, 3, 0.1  # s
OPEN, BY_THE_WALL = (1.0, 1.0, 0.0), (1.0, 0.36, 0.0)  # starts; the second is in the inflation
GOAL = Goal(9.0, 3.0)


@cache
def warm_up() -> None:
    """Compile or load all kernels of a drive, once per process, so that no command waits for it.

    The first call of a version compiles, which takes about half a minute on two cores; later ones
    load what was compiled. To that end two simulated robots, a disc and a polygon, drive past
    a box and a walker.
    """
    robots = list(_robots())
    for _, world, navigator in robots:
        _choose_without_scan(navigator, world)
    # They turn where they stand, for which the polygon has no room, and drive along a path.
    for robot, world, navigator in robots:
        start = world.pose[:2]
        navigator.follow([start], heading=2.0)
        _drive(navigator, world, TURNS)
        navigator.follow([start, GOAL[:2]])
        _drive(navigator, world, TICKS)
        navigator.recovery.way_out.is_wanted = True
        _drive(navigator, world, 1)
        state = RobotState(world.time, world.pose, world.twist)
        Guard(robot).filter(state, world.scan(), Twist(0.1, 0.0))
    for _, world, navigator in robots:
        navigator.set_goal(GOAL)
        _drive(navigator, world, TICKS)
    near = SearchGrid(np.zeros((3, 3), bool))  # as for a way out of the inflation
    near.flood((0, 0))
    near.way_to((2, 2))


@cache
def warm_up_sensing() -> None:
    """Compile or load the kernels of the lidar, and of all that is done with its scans."""
    for _, world, navigator in _robots():
        _drive(navigator, world, TICKS)


def _robots() -> Iterator[tuple[Robot, World, Navigator]]:
    """Each robot, its world and its navigator."""
    occupied = np.pad(np.zeros((58, 98), np.int8), 1, constant_values=100)
    box = np.array([[3.0, 0.6], [3.5, 0.6], [3.5, 1.4], [3.0, 1.4]])
    walker = Mover(0.3, np.array([0.0, 4.0]), np.array([[5.0, 2.2], [1.0, 1.5]]))
    for name, start in ("pioneer3dx", OPEN), ("jackal", BY_THE_WALL):
        grid, robot = OccupancyGrid(occupied, 0.1), ROBOTS[name]
        scenario = Scenario(
            "warm-up", grid, robot, start, (GOAL,), obstacles=(box,), movers=(walker,), latency=0.1
        )
        config = NavigatorConfig(latency=0.1)
        yield robot, World(scenario, Pose2D(*start)), Navigator(grid, robot, config)


def _drive(navigator: Navigator, world: World, ticks: int) -> None:
    """Some ticks in the simulator."""
    for _ in range(ticks):
        state = RobotState(world.time, world.pose, world.twist)
        world.step(navigator.command(state, world.scan()), PERIOD)


def _choose_without_scan(navigator: Navigator, world: World) -> None:
    """Choose a command before the first scan: compiles guidance and dynamic window alone."""
    sensing, driving = navigator.sensing, navigator.driving
    state = RobotState(world.time, world.pose, world.twist)
    obstacles = [MovingObstacle(5.0, 2.2, -1.0, 0.0, 0.3)]
    sensing.perceive(state, None, obstacles)
    view = sensing.view(state.stamp, obstacles, driving.times)
    target = PathTarget(Path(np.array([state.pose[:2], GOAL[:2]])), 0.0)
    closed = navigator.planners.closed_under(sensing.local_map)
    scene = driving.scene(state.pose, 0.0, view, target, closed, navigator.planning_map)
    driving.choose(state.pose, state.twist, scene, ())
