"""Faults of sensors, odometry, clock, drive and map: what they do, as plain data."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.config import nearest, summary
from dynastar.errors import ScenarioError
from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid

KINDS = {
    "scans_lost": "no scan is delivered",
    "scans_frozen": "the last scan is delivered again and again, with its old stamp",
    "scans_repeated": "the last scan is delivered again and again, with fresh stamps",
    "scans_nan": "every range is NaN",
    "beams_missing": "a random fraction `size` of the ranges of each scan is NaN",
    "side_missing": "the first fraction `size` of the ranges is NaN",
    "scans_late": "scans are delivered `size` seconds late, with their true stamps",
    "scans_ahead": "stamps of scans are `size` seconds ahead",
    "pose_jump": "the reported pose is `size` metres to the left of the true one",
    "state_frozen": "the last state is reported again and again, with its old stamp",
    "state_nan": "pose and twist are NaN",
    "twist_glitch": "the reported speed is `size` m/s",
    "clock_back": "stamps of states and scans are `size` seconds back",
    "commands_late": "commands act `size` seconds later than the declared latency",
    "map_replaced": "the controller gets another map, `grid`",
    "obstacle_appears": "an obstacle, `polygon`, appears in the true world",
    "kidnapped": "the robot is put at `pose`; the reported pose is right afterwards",
}
ONCE = ("map_replaced", "obstacle_appears", "kidnapped")  # happen at one moment


@dataclass(frozen=True, eq=False)
class Fault:
    """A fault of one of ``KINDS``, which says what ``size`` means.

    It begins at the first tick from ``start`` (s) on at which the robot drives at ``speed`` (m/s)
    or faster, and lasts ``duration`` seconds: 0 for one tick, inf for good. Raises ScenarioError
    for an unknown kind, a number out of range, or a missing grid, polygon or pose.
    """

    kind: str
    start: float
    duration: float = 1.0
    size: float = 0.0
    speed: float = 0.0
    pose: Pose2D | None = None
    polygon: npt.NDArray[np.float64] | None = None
    grid: OccupancyGrid | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ScenarioError(f"unknown fault '{self.kind}'{nearest(self.kind, KINDS)}")
        for name in ("start", "duration", "speed"):
            if not getattr(self, name) >= 0.0:
                raise ScenarioError(
                    f"the fault {self.kind} has {name} {getattr(self, name)}: expected 0 or more"
                )
        if not math.isfinite(self.size):
            raise ScenarioError(f"the fault {self.kind} has size {self.size}: expected a number")
        if self.kind in ("beams_missing", "side_missing") and not 0.0 <= self.size <= 1.0:
            raise ScenarioError(f"the fault {self.kind} has size {self.size}: expected 0 to 1")
        if self.kind in ("scans_late", "commands_late") and self.size < 0.0:
            raise ScenarioError(f"the fault {self.kind} has size {self.size}: expected 0 or more")
        needs = {"map_replaced": "grid", "obstacle_appears": "polygon", "kidnapped": "pose"}
        name = needs.get(self.kind, "")
        if name and getattr(self, name) is None:
            raise ScenarioError(f"the fault {self.kind} needs a {name}")

    def __repr__(self) -> str:
        return summary(
            self, self.kind, f"at {self.start:g} s for {self.duration:g} s, size {self.size:g}"
        )

    def described(self) -> dict[str, Any]:
        """The fault as plain data, its grid left out."""
        polygon = None if self.polygon is None else np.asarray(self.polygon).tolist()
        pose = None if self.pose is None else list(self.pose)
        names = ("kind", "start", "duration", "size", "speed")
        return {name: getattr(self, name) for name in names} | {"pose": pose, "polygon": polygon}
