"""Past scans, to tell what has come to where space was seen free before."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.geometry import Pose2D
from dynastar.perception.local_map_kernels import bearing, free_ranges
from dynastar.scan import LaserScan

Floats = npt.NDArray[np.float64]

MEMORY = 30.0  # s that scans are kept
CLOSEST = 0.1  # s that they are apart at least,
GROWTH = 0.5  # and of their age
NARROWEST = 0.1  # m between beams, up to which nothing goes unseen


class SeenFree(NamedTuple):
    """Where past scans saw free space, the newest first, as far as they are newer than ``since`` (s).

    ``ranges`` (k, n) are free from the sensor between beam i and beam i + 1 (m); ``views`` (k, 6) the
    sensor's pose, its first beam's angle, its beams' increment, and their number; ``stamps`` (k,) s.
    """

    ranges: Floats
    views: Floats
    stamps: Floats
    since: float


@njit(cache=True)
def seen_free(x: float, y: float, space: SeenFree) -> bool:
    """Whether the beams on either side of (x, y) have passed it since ``space.since``."""
    for k in range(len(space.stamps)):
        if space.stamps[k] <= space.since:
            return False
        view = space.views[k]
        dx, dy = x - view[0], y - view[1]
        turn = (bearing(dx, dy) - view[2] - view[3]) / view[4]
        period = 2.0 * math.pi / abs(view[4])
        i = int(turn - period * math.floor(turn / period))
        if i < view[5] and dx * dx + dy * dy < space.ranges[k, i] * space.ranges[k, i]:
            return True
    return False


class PastScans:
    """Keeps the last scan, and older ones the further apart the older they are."""

    def __init__(self, range_error: float, heading_error: float) -> None:
        self._errors = range_error, heading_error
        self._kept: list[tuple[float, list[float], Floats]] = []

    def forget(self) -> None:
        """Drops all scans."""
        self._kept.clear()

    def add(self, scan: LaserScan, sensor: Pose2D) -> None:
        """Takes in a scan from the ``sensor`` pose; drops what is too old, or has neighbours enough."""
        n, step = len(scan.ranges), scan.angle_increment
        limits = scan.range_min, scan.range_max
        ranges = free_ranges(scan.ranges, limits, step, scan.full_circle, self._errors, NARROWEST)
        view = [*map(float, sensor), float(scan.angle_min), float(step), float(n)]
        now, scans = scan.stamp, [(scan.stamp, view, ranges), *self._kept]
        kept = scans[:1]
        for one, older in zip(
            scans[1:], [*(stamp for stamp, *_ in scans[2:]), -math.inf], strict=False
        ):
            newer = kept[-1][0]
            if newer - older > max(CLOSEST, GROWTH * (now - newer)):
                kept.append(one)
        self._kept = [one for one in kept if now - one[0] <= MEMORY]

    def since(self, stamp: float) -> SeenFree:
        """Space that was seen free after ``stamp`` (s)."""
        kept = self._kept
        ranges = np.zeros((len(kept), max((len(r) for _, _, r in kept), default=0)))
        for row, (_, _, own) in zip(ranges, kept, strict=True):
            row[: len(own)] = own
        views = np.array([view for _, view, _ in kept]).reshape(-1, 6)
        return SeenFree(ranges, views, np.array([one[0] for one in kept]), stamp)
