"""A scan placed in the map frame: all that the local map and the tracker need of it."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from dynastar.geometry import Pose2D
from dynastar.perception.local_map_kernels import scan_points
from dynastar.scan import LaserScan

Floats = npt.NDArray[np.float64]


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
    """A scan in the map frame; ``mount`` on the robot tells its lidar.

    ``free`` (n,) are the ranges (m) observed free between beam i and beam i + 1, ``points`` (k, 2) the
    end points (m) of the beams that hit something, ``beams`` (k,) the indices of these beams.
    """

    sensor: Sensor
    free: Floats
    points: Floats
    beams: npt.NDArray[np.int64]
    mount: Pose2D = Pose2D(0.0, 0.0, 0.0)


def placed(
    scan: LaserScan, pose: Pose2D, errors: tuple[float, float], narrowest: float
) -> PlacedScan:
    """A scan taken with the sensor at ``pose``.

    ``errors`` are the largest of a range (m) and of the heading (rad), ``narrowest`` is the smallest
    width (m) of an obstacle.
    """
    readings = scan.readings()
    first, step = scan.angle_min, scan.angle_increment
    sensor = Sensor(scan.stamp, *pose, first, step, len(readings), scan.full_circle)
    free = free_ranges(readings, scan.range_max, sensor, errors, narrowest)
    points, beams = scan_points(readings, sensor)
    return PlacedScan(sensor, free, points, beams, scan.mount)


def free_ranges(
    readings: Floats,
    range_max: float,
    sensor: Sensor,
    errors: tuple[float, float],
    narrowest: float,
) -> Floats:
    """Range (m) up to which space is observed free between beam i and beam i + 1, (n,).

    As far as the shorter of the two, less the error of a range and half the gap (a corner may stand
    out that far between two beams), while the gap is narrower than the narrowest obstacle. A
    heading error takes the minimum over the neighbours that it could swap in.
    """
    (range_error, heading_error), step = errors, abs(sensor.step)
    reach = np.where(np.isnan(readings), 0.0, np.minimum(readings, range_max))
    reach = np.minimum(reach, np.roll(reach, -1))
    free = np.clip(reach - range_error - 0.5 * reach * step, 0.0, narrowest / step)
    if not sensor.full_circle:
        free[-1] = 0.0
    swap = math.ceil(heading_error / step)
    if swap > 0:
        between = free if sensor.full_circle else free[:-1]
        around = np.pad(between, swap, mode="wrap" if sensor.full_circle else "edge")
        between[:] = sliding_window_view(around, 2 * swap + 1).min(axis=1)
    return free
