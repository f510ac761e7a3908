"""A scan placed in the map frame: all that the local map and the tracker need of it."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D
from dynastar.perception.local_map_kernels import free_ranges, scan_points
from dynastar.scan import LaserScan


class Sensor(NamedTuple):
    """When (s) and at what pose (m, rad, map frame) a scan was taken, and its beams.

    ``step`` is the angle from one beam to the next (rad), ``full_circle`` as of a LaserScan.
    """

    stamp: float
    x: float
    y: float
    theta: float
    angle_min: float
    step: float
    beams: int
    full_circle: bool


class PlacedScan(NamedTuple):
    """A scan in the map frame.

    ``free`` (n,) are the ranges (m) observed free between beam i and beam i + 1, ``points`` (k, 2) the
    end points (m) of the beams that hit something, ``beams`` (k,) the indices of these beams.
    """

    sensor: Sensor
    free: npt.NDArray[np.float64]
    points: npt.NDArray[np.float64]
    beams: npt.NDArray[np.int64]


def placed(
    scan: LaserScan, pose: Pose2D, errors: tuple[float, float], narrowest: float
) -> PlacedScan:
    """A scan taken with the sensor at ``pose``.

    ``errors`` are the largest of a range (m) and of the heading (rad), ``narrowest`` is the smallest
    width (m) of an obstacle.
    """
    x, y, theta = map(float, pose)
    first, step = float(scan.angle_min), float(scan.angle_increment)
    readings, full = scan.readings(), scan.full_circle
    sensor = Sensor(float(scan.stamp), x, y, theta, first, step, len(readings), full)
    free = free_ranges(readings, scan.range_max, step, full, errors, narrowest)
    return PlacedScan(sensor, free, *scan_points(readings, (first, step), (x, y, theta)))
