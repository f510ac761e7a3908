"""What is not seen is never taken as free."""

import numpy as np

from driving import LIMITS
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Navigator, RobotState
from dynastar.robot import Lidar, Robot
from dynastar.simulation.lidar import LidarSimulator


def blind_behind(pose):
    """A navigator in a bare room of 8 x 8 m and the lidar of its robot, which looks ahead only."""
    grid = OccupancyGrid(np.zeros((80, 80), np.int8), GridFrame(0.1))
    robot = Robot("ahead", LIMITS, Footprint.disc(0.2), Lidar(61, 0.6, 0.3, 5.0))
    navigator, lidar = Navigator(grid, robot), LidarSimulator(robot.lidar, grid)

    def tick(now, x):
        at = Pose2D(x, *pose[1:])
        navigator.command(RobotState(now, at, Twist(0.5, 0.0)), lidar.scan(at, now))
        return navigator.sensing.local_map

    return navigator, tick


def test_forgetting_frees_nothing():
    navigator, tick = blind_behind((2.0, 4.0, 0.0))
    for k in range(21):
        local_map = tick(0.1 * k, 2.0 + 0.05 * k)
    before, origin = local_map.open.copy(), local_map.origin
    navigator.sensing.local_map.forget()
    local_map = tick(2.1, 3.0)
    assert local_map.origin == origin
    assert not (local_map.open & ~before & 1).any()


def test_a_start_at_the_edge_of_the_map_takes_nothing_beyond_it_as_free():
    _, tick = blind_behind((0.25, 4.0, 0.0))
    local_map = tick(0.0, 0.25)
    x = local_map.origin[0] + (np.arange(len(local_map.open)) + 0.5) * local_map.resolution
    assert local_map.open[:, x > 0.0].any()
    assert not local_map.open[:, x < 0.0].any()
