"""Past scans, and the space that they showed as free."""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner, record
from dynastar.geometry import Pose2D
from dynastar.perception.placed_scan import PlacedScan, Sensor

MEMORY = 30.0  # s that scans are kept
CLOSEST = 0.1  # s that they are apart at least,
GROWTH = 0.5  # and of their age
APART, TURNED = 0.1, 0.5  # m and rad, up to which two mounts are those of one lidar
SENSOR = record(Sensor)


class SeenFree(NamedTuple):
    """Space that scans showed as free, the newest scan first.

    ``sensors`` (k,) are SENSOR records, ``ranges`` (k, n) are free between beam i and beam i + 1 (m).
    """

    sensors: npt.NDArray[Any]
    ranges: npt.NDArray[np.float64]


@inner
def seen_free_at(x: float, y: float, space: SeenFree) -> float:
    """When (s) the two beams on either side of (x, y) have passed it last, -inf for never."""
    for k, sensor in enumerate(space.sensors):
        dx, dy = x - sensor.x, y - sensor.y
        turn = (math.atan2(dy, dx) - sensor.theta - sensor.angle_min) / sensor.step
        period = math.tau / abs(sensor.step)
        i = int(turn - period * math.floor(turn / period))
        if i < sensor.beams and dx * dx + dy * dy < space.ranges[k, i] * space.ranges[k, i]:
            return float(sensor.stamp)
    return -math.inf


def is_same(mount: Pose2D, other: Pose2D) -> bool:
    """Whether two mounts are those of one lidar, which may be carried by a joint."""
    turn = math.remainder(mount.theta - other.theta, math.tau)
    return math.dist(mount[:2], other[:2]) < APART and abs(turn) < TURNED


class PastScans:
    """The last scan of each lidar and older ones, farther apart the older they are."""

    def __init__(self) -> None:
        self._kept: list[PlacedScan] = []  # the newest first

    def add(self, scan: PlacedScan) -> None:
        """Store a scan. Keep no scan older than 30 s, and no more old ones than are needed.

        A scan is needed if its neighbours of the same lidar are more than max(0.1 s, half their age)
        apart.
        """
        now, kept = scan.sensor.stamp, [scan]
        recent = [one for one in self._kept if now - one.sensor.stamp <= MEMORY]
        same = [one for one in recent if is_same(one.mount, scan.mount)]
        stamps = [*(one.sensor.stamp for one in same), -math.inf]
        for one, older in zip(same, stamps[1:], strict=True):
            newer = kept[-1].sensor.stamp
            if newer - older > max(CLOSEST, GROWTH * (now - newer)):
                kept.append(one)
        kept += [one for one in recent if not is_same(one.mount, scan.mount)]
        self._kept = sorted(kept, key=lambda one: -one.sensor.stamp)

    def space(self) -> SeenFree:
        """The space that the scans kept show as free."""
        sensors = np.array([one.sensor for one in self._kept], SENSOR)
        ranges = np.zeros((len(sensors), sensors["beams"].max(initial=0)))
        for row, one in zip(ranges, self._kept, strict=True):
            row[: len(one.free)] = one.free
        return SeenFree(sensors, ranges)
