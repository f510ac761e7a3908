"""The readings of one lidar: what they mean for the robot, and what is odd about them."""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from dynastar.robot import Robot
from dynastar.scan import LaserScan

FARTHEST_RANGE = 1e3  # m; a scan with a larger range_max declares none
CODE_ERROR = 1e-6  # relative difference of a reading from a value in ``Lidar.nothing``
MANY = 0.1  # of the readings without information are named
NAMED_AFTER = 3.0  # s that something lasts before it is named

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


class Readings:
    """Turns the scans of one lidar into scans without the driver's and the mount's peculiarities.

    ``hints`` name what has been odd about the readings for some seconds.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.hints: list[str] = []
        self._since: dict[str, float] = {}  # stamp (s) since which a kind of reading is there

    def interpreted(self, scan: LaserScan) -> LaserScan:
        """The scan with +inf for no return, and NaN where the robot sees itself or nothing is known.

        A scan that declares no finite range_max has that of the robot's ``Lidar``.
        """
        lidar = self.robot.lidar
        if scan.range_max > FARTHEST_RANGE:
            scan = replace(scan, range_max=lidar.range_max)
        if lidar.nothing:
            ranges = scan.ranges.copy()
            ranges[_equals_any(ranges.astype(np.float64), lidar.nothing)] = np.inf
            scan = replace(scan, ranges=ranges)
        readings = scan.readings()
        own = self._own(scan, readings)
        self._find_odd(scan, np.isnan(readings), len(own))
        readings[own] = np.nan
        return replace(scan, ranges=readings.astype(np.float32))

    def _own(self, scan: LaserScan, readings: Floats) -> npt.NDArray[np.int64]:
        """The indices of the beams that end within the robot's own footprint."""
        shape, mount = self.robot.footprint, scan.mount
        reach = shape.circumscribed + math.hypot(mount.x, mount.y)
        near = np.flatnonzero(readings < reach)
        angles = mount.theta + scan.angle_min + scan.angle_increment * near
        x = mount.x + readings[near] * np.cos(angles)
        y = mount.y + readings[near] * np.sin(angles)
        return near[shape.covers(np.column_stack([x, y]))]

    def _find_odd(self, scan: LaserScan, unknown: Mask, own: int) -> None:
        """Bring ``hints`` up to date: readings without information, and of the robot itself."""
        n, found = len(scan.ranges), {}
        if np.count_nonzero(unknown) >= MANY * n:
            values, counts = np.unique(scan.ranges[unknown], return_counts=True)
            value, count = float(values[np.argmax(counts)]), int(counts.max())
            if count >= MANY * n:
                found["unknown"] = (
                    f"{_percent(count, n)} of the lidar's readings are {value:g}: if the driver "
                    f"writes that for no return, declare it in sensor.nothing"
                )
        if own:
            found["own"] = (
                f"{_percent(own, n)} of the lidar's readings lie within the robot's own footprint"
            )
        self._since = {kind: self._since.get(kind, scan.stamp) for kind in found}
        self.hints = [
            words for kind, words in found.items() if scan.stamp - self._since[kind] >= NAMED_AFTER
        ]


def _equals_any(ranges: Floats, values: tuple[float, ...]) -> Mask:
    """Whether each range (n,) is one of ``values``, but for the rounding to a float32."""
    found = np.zeros(len(ranges), bool)
    for value in values:
        low, high = sorted((value * (1.0 - CODE_ERROR), value * (1.0 + CODE_ERROR)))
        found |= np.isnan(ranges) if math.isnan(value) else (low <= ranges) & (ranges <= high)
    return found


def _percent(part: int, whole: int) -> str:
    return f"{max(1, round(100 * part / whole))} %"
