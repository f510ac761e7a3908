import math
from dataclasses import replace

import numpy as np
import pytest

from driving import ROUND, with_ranges
from dynastar.errors import ConfigError
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.readings import NAMED_AFTER, Readings
from dynastar.robot import Lidar
from dynastar.scan import LaserScan

CONFIG = NavigatorConfig(range_error=0.01, pose_error=0.02)
CART = Footprint.polygon([(0.4, -0.2), (0.4, 0.2), (-0.6, 0.2), (-0.6, -0.2)])
SCAN = LaserScan(0.0, np.full(360, 4.0), 0.0, math.radians(1.0), 0.05, 6.0)


def readings_of(*values, robot=ROUND, **scan):
    """What the first readings of a scan are taken for."""
    ranges = np.full(360, 4.0)
    ranges[: len(values)] = values
    given = with_ranges(SCAN, ranges, **scan)
    return Readings(robot).interpreted(given)


@pytest.mark.parametrize("code", [0.0, -1.0, 6.5, 65.535, 3.4028235e38, math.nan, -math.inf])
def test_what_the_driver_writes_for_no_return_is_infinite(code):
    robot = replace(ROUND, lidar=ROUND.lidar._replace(nothing=(9.0, code)))
    scan = readings_of(1.0, code, 7.5, robot=robot)
    assert scan.ranges[0] == 1.0
    assert scan.ranges[1] == np.inf
    assert np.isnan(scan.ranges[2])
    assert np.isnan(readings_of(1.0, code).ranges[1])


def test_what_means_no_return_is_a_list_of_numbers():
    assert Lidar(nothing=[0, math.nan]).nothing[0] == 0.0
    for wrong in (0.0, ("far",), (None,)):
        with pytest.raises(ConfigError, match=r"Lidar\.nothing"):
            Lidar(nothing=wrong)


@pytest.mark.parametrize("range_max", [math.inf, 3.4e38])
def test_a_scan_without_a_largest_range_has_that_of_the_lidar(range_max):
    scan = readings_of(5.9, 6.0, 7.0, np.inf, range_max=range_max)
    assert scan.range_max == ROUND.lidar.range_max == 6.0
    assert scan.ranges[[0, 1, 3]] == pytest.approx([5.9, np.inf, np.inf])
    assert np.isnan(scan.ranges[2])


@pytest.mark.parametrize(
    ("footprint", "mount", "edge"),
    [
        (Footprint.disc(0.25), Pose2D(0.0, 0.0, 0.0), 0.25),
        (Footprint.disc(0.25), Pose2D(-0.1, 0.0, 0.0), 0.35),
        (Footprint.disc(0.25), Pose2D(0.1, 0.0, math.pi), 0.35),
        (CART, Pose2D(0.3, 0.0), 0.1),
        (CART, Pose2D(0.3, 0.1, math.pi / 2), 0.1),
    ],
)
def test_a_reading_within_the_footprint_has_no_information(footprint, mount, edge):
    robot = replace(ROUND, footprint=footprint)
    inside = readings_of(edge - 0.001, robot=robot, mount=mount)
    outside = readings_of(edge + 0.001, robot=robot, mount=mount)
    assert np.isnan(inside.ranges[0])
    assert outside.ranges[0] == pytest.approx(edge + 0.001)


def hints_of(ranges, seconds):
    """What is said about a lidar that gives the same ranges for so long."""
    readings = Readings(ROUND)
    for stamp in np.arange(0.0, seconds + 0.01, 0.1):
        readings.interpreted(with_ranges(SCAN, ranges, stamp=stamp))
    return readings.hints


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.0, "25 % of the lidar's readings are 0: if the driver writes that for no return"),
        (65.535, "are 65.535:"),
        (math.nan, "are nan:"),
        (0.1, "25 % of the lidar's readings lie within the robot's own footprint"),
    ],
)
def test_what_is_odd_is_named_after_some_seconds(value, words):
    ranges = np.where(np.arange(360) % 4, 4.0, value)
    assert hints_of(ranges, NAMED_AFTER - 0.2) == []
    [hint] = hints_of(ranges, NAMED_AFTER + 0.2)
    assert words in hint


def test_some_readings_without_information_are_not_odd():
    assert hints_of(np.where(np.arange(360) % 20, 4.0, math.nan), 10.0) == []


def test_what_has_gone_is_named_no_longer():
    readings, ranges = Readings(ROUND), np.where(np.arange(360) % 4, 4.0, 0.0)
    for stamp in np.arange(0.0, 5.0, 0.1):
        readings.interpreted(with_ranges(SCAN, ranges, stamp=stamp))
    assert readings.hints
    readings.interpreted(with_ranges(SCAN, np.full(360, 4.0), stamp=5.0))
    assert readings.hints == []
