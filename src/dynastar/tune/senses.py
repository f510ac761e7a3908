"""What a recording tells of a lidar: range noise, number of readings, parts of the robot in its view."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynastar.config import checked
from dynastar.errors import ConfigError
from dynastar.robot import Lidar
from dynastar.scan import LaserScan
from dynastar.tune.estimate import Estimate, untold

Floats = npt.NDArray[np.float64]

AT_REST = 10  # scans in a row that a rest needs
STILL = 0.15  # m, spread of a beam that saw the same thing all the time,
STEADY = 2.0  # or so many times the median spread of the beams, if that is more
FEWEST = 100  # readings at rest
ROUNDING = 1e-4  # m
MOST_OWN = 1.0  # m, the farthest own part; nearer where the footprint is known
SEEN = 0.95  # share of the scans in which an own part is seen
CONSTANT = 0.03  # m, spread of the readings of an own part, beyond twice the range error
MOVING = 0.5  # m that the robot has to travel for own parts to be told from others


@dataclass(frozen=True)
class OwnPart:
    """A part of the robot in the lidar's view: direction (rad), distance (m), readings across it."""

    angle: float
    distance: float
    readings: int


def lidar_of(scans: Sequence[LaserScan]) -> dict[str, float]:
    """What the scans themselves say of their lidar, as fields of ``Lidar``: the median of each.

    What a lidar cannot have is left out, as an infinite ``range_max``.
    """
    if not scans:
        return {}
    steps = np.abs([scan.angle_increment for scan in scans])
    spans = steps * [len(scan.ranges) - 1 for scan in scans]
    whole = spans + 1.5 * steps > math.tau  # a full circle does not repeat its first beam
    found = {
        "fov": float(np.median(np.where(whole, math.tau, spans))),
        "range_min": float(np.median([scan.range_min for scan in scans])),
        "range_max": float(np.median([scan.range_max for scan in scans])),
    }
    return {name: value for name, value in found.items() if _is_legal(name, value)}


def _is_legal(name: str, value: float) -> bool:
    try:
        checked(Lidar, {name: value})
    except ConfigError:
        return False
    return True


def range_error(scans: Sequence[LaserScan], resting: npt.NDArray[np.bool_]) -> Estimate:
    """Half of the largest spread of a beam's ranges, over scans at rest; ``resting`` is (n,).

    That is at most the largest error, if errors are symmetric. The upper end is the largest deviation from
    a beam's mean. A constant error of all ranges is not seen.
    """
    errors: list[Floats] = []
    half = 0.0
    for group in _rests(scans, resting):
        ranges = np.array([scan.readings() for scan in group])
        ranges = ranges[:, np.isfinite(ranges).all(axis=0)]
        spread = np.ptp(ranges, axis=0)
        usual = float(np.median(spread)) if len(spread) else 0.0
        ranges = ranges[:, spread < max(STILL, STEADY * usual)]
        errors.append((ranges - ranges.mean(axis=0)).ravel())
        half = max(half, *(0.5 * np.ptp(ranges, axis=0)), 0.0)
    found = np.concatenate([np.empty(0), *errors])
    if len(found) < FEWEST:
        why = f"it has no rest of {AT_REST} scans with the same beams"
        return untold("range_error", "m", why, len(found))
    deviation = float(np.sqrt(np.mean(found**2)))
    high = max(float(np.abs(found).max()), half) + ROUNDING
    evidence = (
        f"half the largest spread at rest, standard deviation {deviation:.3g} m; no constant error"
    )
    low = max(half - ROUNDING, 0.0)
    return Estimate("range_error", "m", float(half), low, high, len(found), evidence)


def _rests(scans: Sequence[LaserScan], resting: npt.NDArray[np.bool_]) -> list[Sequence[LaserScan]]:
    """Scans in a row at rest with equal numbers of readings, ``AT_REST`` or more."""
    groups: list[list[LaserScan]] = [[]]
    for scan, rests in zip(scans, resting, strict=True):
        last = groups[-1]
        if not rests or (last and len(last[0].ranges) != len(scan.ranges)):
            groups.append([])
        if rests:
            groups[-1].append(scan)
    return [group for group in groups if len(group) >= AT_REST]


def readings(scans: Sequence[LaserScan]) -> Estimate:
    """Number of readings of a scan: the median, the least and the largest."""
    counts = np.array([len(scan.ranges) for scan in scans])
    low, high = float(counts.min()), float(counts.max())
    evidence = "the same in each scan" if low == high else "it varies from scan to scan"
    return Estimate("beams", "", float(np.median(counts)), low, high, len(counts), evidence)


def own_parts(
    scans: Sequence[LaserScan], travelled: float, reach: float | None, error: float
) -> tuple[list[OwnPart], str]:
    """Parts of the robot that the lidar sees, and the evidence in words.

    They are directions in which nearly all scans of a drive of ``travelled`` metres read the same
    distance, at most ``reach`` m (None: unknown).
    """
    if travelled < MOVING:
        return [], f"the recording cannot tell own parts: the robot moved {travelled:.2g} m only"
    step = float(np.median([abs(scan.angle_increment) for scan in scans]))
    cells = max(round(math.tau / step), 1)
    values: list[list[float]] = [[] for _ in range(cells)]
    for scan in scans:
        near = scan.ranges.astype(np.float64)
        angles = scan.angles
        for place in np.flatnonzero((near > 0.0) & (near <= (reach or MOST_OWN))):
            values[round(angles[place] % math.tau / step) % cells].append(float(near[place]))
    seen = [
        len(one) >= SEEN * len(scans) and np.ptp(one) <= CONSTANT + 2.0 * error for one in values
    ]
    parts = []
    for first in range(cells):
        if seen[first] and not seen[first - 1]:
            last = first
            while seen[(last + 1) % cells] and last + 1 < first + cells:
                last += 1
            distance = float(
                np.median([v for k in range(first, last + 1) for v in values[k % cells]])
            )
            angle = math.remainder(0.5 * (first + last) * step, math.tau)
            parts.append(OwnPart(angle, distance, last - first + 1))
    words = f"{len(parts)} directions with a constant distance in {len(scans)} scans"
    return parts, words
