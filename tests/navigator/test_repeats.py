import math

import numpy as np
import pytest

from driving import room
from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.repeats import contradicted
from dynastar.robot import Lidar
from dynastar.scan import LaserScan
from dynastar.simulation.lidar import LidarSimulator

CONFIG = NavigatorConfig()
LIDAR = Lidar(360, math.tau, 0.05, 3.5)
HALL = OccupancyGrid(np.zeros((300, 300), np.int8), GridFrame(0.1))
PILLAR = np.array([(16.2, 14.6), (16.2, 15.4), (17.0, 15.4), (17.0, 14.6)])


def fraction(grid, before, now, lidar=LIDAR, quantum=0.0, obstacles=(), config=CONFIG):
    """The fraction of the beams at ``before`` that cannot be the same at ``now``."""
    scan = LidarSimulator(lidar, grid, obstacles).scan(Pose2D(*before), 0.0)
    if quantum:
        ranges = np.round(scan.ranges / quantum) * quantum
        scan = LaserScan(0.0, ranges, *(scan.angle_min, scan.angle_increment, 0.0, scan.range_max))
    return contradicted(scan, Pose2D(*before), Pose2D(*now), config)


@pytest.mark.parametrize("lidar", [LIDAR, Lidar(720, 4.7, 0.1, 10.0), Lidar(61, 3.0)])
@pytest.mark.parametrize("quantum", [0.0, 0.001, 0.01])
@pytest.mark.parametrize("moved", [0.05, 0.3, 1.0, 4.0])
def test_walls_that_the_sensor_moves_along_contradict_nothing(lidar, quantum, moved):
    corridor = room(60.0, 2.4)
    before, now = (25.0, 1.1, 0.0), (25.0 + moved, 1.1, 0.0)
    assert fraction(corridor, before, now, lidar, quantum) < 0.005
    assert fraction(corridor, now, before, lidar, quantum) < 0.005


@pytest.mark.parametrize(
    ("now", "least"),
    [
        ((2.1, 2.0, 0.0), 0.2),
        ((2.0, 1.9, 0.0), 0.2),
        ((1.95, 2.06, 0.0), 0.2),
        ((2.0, 2.0, 0.1), 0.5),
        ((2.2, 2.2, -1.5), 0.5),
    ],
)
def test_walls_all_round_are_contradicted_by_every_motion(now, least):
    assert fraction(room(4.0, 4.0), (2.0, 2.0, 0.0), now) > least


def test_the_end_of_a_corridor_in_sight_is_contradicted_by_driving_at_it():
    assert fraction(room(12.0, 2.0), (9.0, 1.0, 0.0), (9.1, 1.0, 0.0)) > 0.05


def test_where_nothing_is_in_sight_nothing_is_contradicted():
    assert fraction(HALL, (15.0, 15.0, 0.0), (16.0, 15.0, 1.0)) == 0.0


def test_a_pillar_that_moves_along_in_an_empty_hall_is_a_contradiction():
    here = (15.0, 15.0, 0.0)
    assert fraction(HALL, here, (15.1, 15.0, 0.0), obstacles=[PILLAR]) > 0.02
    assert fraction(HALL, here, (15.0, 15.3, 0.0), obstacles=[PILLAR]) > 0.02


def test_the_declared_errors_explain_as_much_as_they_are():
    before, now = (2.0, 2.0, 0.0), (2.1, 2.0, 0.0)
    assert fraction(room(4.0, 4.0), before, before) == 0.0
    assert fraction(room(4.0, 4.0), before, now) > 0.2
    assert fraction(room(4.0, 4.0), before, now, config=CONFIG._replace(pose_error=0.05)) == 0.0
    turned, unsure = (2.0, 2.0, 0.06), CONFIG._replace(heading_error=0.04)
    assert fraction(room(4.0, 4.0), before, turned) > 0.2
    assert fraction(room(4.0, 4.0), before, turned, config=unsure) == 0.0
