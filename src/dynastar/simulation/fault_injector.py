"""Applies the faults of a scenario to what the world senses and to its drive."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import RobotState
from dynastar.scan import LaserScan
from dynastar.simulation.faults import KINDS, ONCE, Fault
from dynastar.simulation.world import World

Sensed = tuple[RobotState, LaserScan | None]

_INSTANT = 1e-6  # s, what a duration of 0 stands for: one tick


class FaultInjector:
    """Applies the faults of a scenario between world and controller.

    ``event`` is called with a kind ("fault") and a detail when a fault begins and when it ends.
    """

    def __init__(
        self,
        faults: Sequence[Fault],
        world: World,
        controller: Any,
        event: Callable[[str, str], None],
        seed: int = 0,
    ) -> None:
        self._faults, self._world, self._controller, self._event = faults, world, controller, event
        self._random = np.random.default_rng([seed, len(KINDS)])
        self._begun: dict[Fault, float] = {}
        self._active: list[Fault] = []
        self._held: dict[Fault, Sensed] = {}  # what was delivered before a fault began
        self._past: deque[Sensed] = deque()
        self._memory = max((f.size for f in faults if f.kind == "scans_late"), default=0.0)

    def begin(self) -> None:
        """Begins and ends faults at the world's time; call it before the world is sensed."""
        now, speed = self._world.time, abs(self._world.twist.v)
        for fault in self._faults:
            if fault not in self._begun:
                if now >= fault.start - _INSTANT and speed >= fault.speed:
                    self._begun[fault] = now
                    self._strike(fault)
            elif fault in self._active and now - self._begun[fault] >= self._lasts(fault):
                self._active.remove(fault)
                self._event("fault", f"{fault.kind} ends")
        late = (fault.size for fault in self._active if fault.kind == "commands_late")
        self._world.drive.late = max(late, default=0.0)

    def sensed(self, state: RobotState, scan: LaserScan) -> Sensed:
        """State and scan as the controller receives them."""
        if not self._faults:
            return state, scan
        delivered: Sensed = (state, scan)
        for fault in self._active:
            delivered = self._distorted(fault, *delivered)
        self._past.append((state, scan))
        while self._past[0][0].stamp < state.stamp - self._memory - _INSTANT:
            self._past.popleft()
        return delivered

    @staticmethod
    def _lasts(fault: Fault) -> float:
        return max(fault.duration - _INSTANT, _INSTANT)

    def _strike(self, fault: Fault) -> None:
        detail = f"{fault.kind} begins: {KINDS[fault.kind]}"
        if fault.kind not in ONCE:
            self._active.append(fault)
            if self._past:
                self._held[fault] = self._past[-1]
        elif fault.kind == "obstacle_appears":
            self._world.add_obstacle(np.asarray(fault.polygon, dtype=np.float64))
        elif fault.kind == "kidnapped":
            assert fault.pose is not None
            self._world.place(fault.pose)
        elif callable(getattr(self._controller, "set_map", None)):
            self._controller.set_map(fault.grid)
        else:
            detail = "map_replaced: the controller takes no other map"
        self._event("fault", detail)

    def _distorted(self, fault: Fault, state: RobotState, scan: LaserScan | None) -> Sensed:
        """The delivered state and scan with one fault applied."""
        kind, size = fault.kind, fault.size
        held_state, held_scan = self._held.setdefault(fault, (state, scan))
        if kind == "state_frozen":
            return held_state, scan
        if kind == "state_nan":
            nan = math.nan
            return state._replace(pose=Pose2D(nan, nan, nan), twist=Twist(nan, nan)), scan
        if kind == "twist_glitch":
            return state._replace(twist=state.twist._replace(v=size)), scan
        if kind == "pose_jump":
            x, y, theta = state.pose
            pose = Pose2D(x - size * math.sin(theta), y + size * math.cos(theta), theta)
            return state._replace(pose=pose), scan
        if kind == "clock_back":
            return state._replace(stamp=state.stamp - size), self._shifted(scan, -size)
        if kind == "scans_lost" or scan is None:
            return state, None
        if kind == "scans_frozen":
            return state, held_scan
        if kind == "scans_repeated":
            return state, held_scan and replace(held_scan, stamp=scan.stamp)
        if kind == "scans_late":
            return state, self._late(state.stamp - size)
        if kind == "scans_ahead":
            return state, self._shifted(scan, size)
        ranges = np.array(scan.ranges)
        if kind == "scans_nan":
            ranges[:] = np.nan
        elif kind == "beams_missing":
            ranges[self._random.random(len(ranges)) < size] = np.nan
        elif kind == "side_missing":
            ranges[: round(size * len(ranges))] = np.nan
        return state, replace(scan, ranges=ranges)

    def _late(self, stamp: float) -> LaserScan | None:
        """The newest scan that is not newer than ``stamp``."""
        old = [scan for state, scan in self._past if state.stamp <= stamp + _INSTANT]
        return old[-1] if old else None

    @staticmethod
    def _shifted(scan: LaserScan | None, seconds: float) -> LaserScan | None:
        return None if scan is None else replace(scan, stamp=scan.stamp + seconds)
