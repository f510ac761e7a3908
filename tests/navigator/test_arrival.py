"""Goals are reached as nearly as the tolerance asks for, wherever they lie in a cell."""

import math

import numpy as np
import pytest

from driving import ROUND, Drive, room
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.arrival import has_arrived
from dynastar.navigator.braking import Acting
from dynastar.robot import ROBOTS, Limits


@pytest.mark.parametrize("tolerance", [0.01, 0.03, 0.1])
@pytest.mark.parametrize("robot", [ROUND, ROBOTS["turtlebot3_burger"], ROBOTS["jackal"]])
@pytest.mark.parametrize("seed", range(3))
def test_a_goal_is_reached_within_a_small_tolerance_without_ado(tolerance, robot, seed):
    random = np.random.default_rng(seed)
    x, y, heading = random.uniform((2.5, 1.0, -3.1), (5.0, 5.0, 3.1))
    drive = Drive(room(), robot, goal_tolerance=tolerance)
    drive.navigator.set_goal(Goal(x, y, heading if seed == 0 else None))
    drive.until("arrived", "blocked", seconds=60.0)
    assert drive.status.state == "arrived", drive.status.reason
    assert drive.status.recoveries == 0
    drive.for_seconds(1.0)
    assert drive.twist == (0.0, 0.0)
    assert math.dist(drive.pose[:2], (x, y)) <= tolerance
    if seed == 0:
        assert abs(math.remainder(drive.pose.theta - heading, math.tau)) <= 0.12


@pytest.mark.parametrize("goal", [(4.0, 0.5), (4.0, 3.0), (4.1, 2.2)])
def test_so_is_one_on_the_border_of_two_cells(goal):
    drive = Drive(room(), ROBOTS["pioneer3dx"], goal_tolerance=0.02)
    drive.navigator.set_goal(Goal(*goal))
    drive.until("arrived", seconds=60.0)
    assert math.dist(drive.pose[:2], goal) <= 0.02


@pytest.mark.parametrize(
    ("now", "acts_at", "omega", "arrived"),
    [
        (0.05, 0.05, 0.0, True),
        (0.05, 0.02, -0.15, True),  # a slow turn that ends within the tolerance
        (0.09, -0.05, -0.5, False),  # turns through it: 0.06 rad more to stop
        (0.12, 0.05, -0.1, False),  # not there yet
        (math.tau - 0.05, -0.05, 0.0, True),
    ],
)
def test_a_heading_counts_from_when_the_robot_is_there_and_stays(now, acts_at, omega, arrived):
    limits, goal = Limits(0.5, 1.0, 1.0, 2.0, 1.0, 2.0), Goal(1.0, 1.0, 0.0)
    acting = Acting(Pose2D(1.0, 1.0, acts_at), Twist(0.0, omega))
    config = NavigatorConfig(heading_tolerance=0.1)
    assert has_arrived(goal, Pose2D(1.0, 1.0, now), acting, limits, config) == arrived
