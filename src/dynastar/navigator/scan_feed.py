"""Scans as they come in: which of them are new, and why others cannot be used."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D
from dynastar.navigator.config import NavigatorConfig
from dynastar.scan import LaserScan

RANGES_UP_TO = 1.001  # times range_max
SAME_PLACE = 0.05  # m within which a robot may get the same ranges again


class ScanFeed:
    """Checks the scans of all lidars; a lidar is told by its mount."""

    def __init__(self, config: NavigatorConfig) -> None:
        self._config = config
        self._stamps: dict[Pose2D, float] = {}  # of the newest scan of each lidar
        self._ranges: dict[Pose2D, tuple[npt.NDArray[np.floating], Pose2D]] = {}

    @property
    def newest(self) -> float:
        """Stamp (s) of the newest scan that was accepted, -inf if there is none."""
        return max(self._stamps.values(), default=-math.inf)

    def accept(
        self, scans: Sequence[LaserScan], now: float, here: Pose2D
    ) -> tuple[list[LaserScan], str | None]:
        """The scans that are new and can be used by a robot at ``here``, and a fault, or None.

        There is no fault as long as some scan is no older than ``scan_age``.
        """
        accepted, fault, ahead = [], None, 0.0
        for scan in scans:
            if not isinstance(scan, LaserScan):
                fault = f"a scan is {scan!r:.40}: expected a LaserScan"
                continue
            wrong = scan.fault()
            if wrong is None and scan.stamp > now + 0.5 * self._config.period:
                wrong = f"the scan is {scan.stamp - now:.3f} s ahead of the robot's state"
                ahead = max(ahead, scan.stamp - now)
            is_new = scan.stamp > self._stamps.get(scan.mount, -math.inf)
            if wrong is None and is_new:
                wrong = self._without_news(scan, here)
            if wrong is not None:
                fault = wrong
            elif is_new:
                self._stamps[scan.mount] = scan.stamp
                accepted.append(scan)
        age = now - self.newest
        if age > self._config.scan_age:
            return accepted, fault or "no scan" + (
                f" for {age:.1f} s" if age < math.inf else " yet"
            )
        if ahead > self._config.scan_age:
            return accepted, f"the robot's state is {ahead:.1f} s older than the scan"
        return accepted, None

    def _without_news(self, scan: LaserScan, here: Pose2D) -> str | None:
        """Describe why a scan has no information: no valid range, or the last one while moving."""
        ranges = scan.ranges
        beyond = (ranges > RANGES_UP_TO * scan.range_max) & (ranges != np.inf)
        if (np.isnan(ranges) | beyond).all():
            return "the scan has no valid range"
        last, there = self._ranges.get(scan.mount, (None, here))
        if last is None or not np.array_equal(ranges, last, equal_nan=True):
            self._ranges[scan.mount] = ranges, here
            return None
        moved = math.hypot(here.x - there.x, here.y - there.y) > SAME_PLACE
        if moved and np.isfinite(ranges).any():
            return "the scan repeats the last one, though the robot has moved"
        return None
