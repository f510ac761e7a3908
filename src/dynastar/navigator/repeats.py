"""Repeated scans: whether the motion of the sensor would have changed the readings."""

import math

import numpy as np

from dynastar.geometry import Pose2D, compose, inverse
from dynastar.navigator.config import NavigatorConfig
from dynastar.scan import LaserScan

ROUNDING = 0.01  # m to which a driver may round a range


def contradicted(scan: LaserScan, before: Pose2D, now: Pose2D, config: NavigatorConfig) -> float:
    """The fraction of beams that cannot read the same at the sensor pose ``now`` as at ``before``.

    Seen from ``before``, the scan's hits join to surfaces. Placed at ``now``, a hit contradicts them if it
    lies farther from the surface in its direction than all errors together, or so far in space that
    showed no hit. A wall that the sensor moves along is the same surface and contradicts nothing; nor
    does a beam without a hit.
    """
    ranges, angles = scan.readings(), scan.angles
    hits = np.flatnonzero(np.isfinite(ranges))
    x, y, turned = compose(inverse(before), now)
    points = np.full((len(ranges), 2), np.nan)
    points[hits] = _polar(ranges[hits], angles[hits])
    moved = np.array((x, y)) + _polar(ranges[hits], angles[hits] + turned)
    step, period = scan.angle_increment, math.tau / abs(scan.angle_increment)
    bearing = np.arctan2(moved[:, 1], moved[:, 0])
    first = np.floor(((bearing - scan.angle_min) / step) % period).astype(np.int64)
    seen = first < len(ranges) - (0 if scan.full_circle else 1)
    hits, moved, first = hits[seen], moved[seen], first[seen] % len(ranges)
    second = (first + 1) % len(ranges)
    side, rel = points[second] - points[first], moved - points[first]
    cross = side[:, 0] * rel[:, 1] - side[:, 1] * rel[:, 0]
    off = np.abs(cross) / np.maximum(np.hypot(side[:, 0], side[:, 1]), 1e-9)
    no_hit = np.isinf(ranges[first]) & np.isinf(ranges[second])
    off[no_hit] = scan.range_max - np.hypot(moved[no_hit, 0], moved[no_hit, 1])
    errors = config.range_error + config.pose_error + config.heading_error * ranges[hits]
    return float(np.count_nonzero(off > 2.0 * errors + ROUNDING) / len(ranges))


def _polar(ranges: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Points (n, 2) at a range (m) and an angle (rad) from the origin."""
    return np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)])
