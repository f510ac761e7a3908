"""What is not seen is never taken as free."""

import numpy as np
import pytest

from driving import LIMITS, under_way, with_ranges
from dynastar.dwa.clearance import distance_at
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Navigator, RobotState
from dynastar.perception.prediction import Times
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


def forget(drive):
    drive.navigator.forget()


def jump(drive):
    drive.pose = drive.pose._replace(y=drive.pose.y - 1.0)


def distance_to_hidden(drive):
    """Metres from the robot to where somebody may be, after a scan that shows only what is ahead."""
    scan = drive.scan()
    drive.tick(with_ranges(scan, np.where(np.cos(scan.angles) > 0.0, scan.ranges, np.nan)))
    sensing = drive.navigator.sensing
    x, y, _ = drive.pose
    return distance_at(sensing.view(drive.now, None, Times(0.0, 0.1, 20)).hidden.distance, x, y)


@pytest.mark.parametrize("lose", [forget, jump])
def test_people_may_be_wherever_what_was_seen_is_forgotten(lose):
    drive = under_way()
    assert distance_to_hidden(drive) > 1.5
    lose(drive)
    assert distance_to_hidden(drive) < 0.75


def test_a_start_at_the_edge_of_the_map_takes_nothing_beyond_it_as_free():
    _, tick = blind_behind((0.25, 4.0, 0.0))
    local_map = tick(0.0, 0.25)
    x = local_map.origin[0] + (np.arange(len(local_map.open)) + 0.5) * local_map.resolution
    assert local_map.open[:, x > 0.0].any()
    assert not local_map.open[:, x < 0.0].any()
