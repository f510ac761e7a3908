"""Regulated pure pursuit [Macenski2023] on a replanned path: the classic that stops for what is ahead."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench.controllers.base import PathController
from dynastar.bench.controllers.costmap import Surroundings
from dynastar.geometry import Pose2D, Twist, wrap_angle
from dynastar.navigator import RobotState

Floats = npt.NDArray[np.float64]


class Settings(NamedTuple):
    """The settings of the controller, as Nav2 names them where it has them."""

    lookahead_time: float = 1.0  # s
    lookahead_low: float = 0.3  # m
    lookahead_high: float = 1.2  # m
    rotate_from: float = 0.785  # rad off the carrot, from which it turns on the spot
    radius_low: float = 0.9  # m, arcs tighter than that are slowed down for
    proximity: float = 0.4  # m to what is blocked, below which it slows down
    speed_low: float = 0.25  # m/s that curvature and proximity leave
    approach: float = 0.6  # m before the goal, where it begins to slow down
    approach_low: float = 0.05  # m/s
    horizon: float = 1.0  # s, how far ahead contact is looked for, at least to a stop
    braking: float = 0.7  # fraction of the robot's braking that it counts on


class PurePursuit(PathController):
    """Drives the arc to a point ahead on the path, slower in bends, near things and near the goal.

    The path comes from the map and what the lidar has seen, and is planned anew every second.
    Contact is looked for along the arc: it goes no faster than it can stop for, and stops where the
    way is not free. Everything counts as static. Where the arc to the carrot is not free, nearer
    carrots are tried. The speed aimed at is the robot's largest; Nav2's speeds and distances are
    meant for 0.5 m/s, so the lookahead reaches to 1.2 m here (0.9 m there).

    Tuned on 50 BARN worlds and a dozen MRPB missions: more room beside the path, finer cells and a
    least speed of 0.25 m/s took the arrivals from 45 to 48 of 50, and from 1 of 10 to 8 of 12.
    """

    settings = Settings()

    def follow(self, state: RobotState) -> Twist | None:
        """The twist along the arc to the carrot; None where nothing ahead is free."""
        path, options, limits = self.route.path, self.settings, self.robot.limits
        assert path is not None
        pose, v = state.pose, max(state.twist.v, 0.0)
        stop = v**2 / (2.0 * options.braking * limits.v_brake)
        late = v * (self.config.period + self.config.latency)
        reach = max(options.horizon * limits.v_max, stop + late) + options.lookahead_high
        around = self.costmap.surroundings(
            pose, min(reach, 4.0) + options.proximity + self.robot.footprint.circumscribed
        )
        lookahead = min(
            max(options.lookahead_time * v, options.lookahead_low), options.lookahead_high
        )
        off, curvature, free = self._best_arc(pose, lookahead, reach, around)
        if abs(off) > options.rotate_from:
            return self.turned(pose, off, around)
        room = free - late - 0.02
        if room <= 0.0:
            return None
        speeds = self._regulated(pose, curvature, around) | {
            "obstacle ahead": math.sqrt(2.0 * options.braking * limits.v_brake * room),
            "turning rate": limits.omega_max / max(abs(curvature), 1e-9),
        }
        left = path.length - self.route.s
        if left < options.approach:
            slow = max(limits.v_max * left / options.approach, options.approach_low)
            speeds["approach to the goal"] = slow
        cause, speed = min(speeds.items(), key=lambda item: item[1])
        if speed < limits.v_max:
            self.status = replace(self.status, limited_by=cause)
        # The drive ramps up: the arc belongs to the speed it will have.
        ramp = min(speed, limits.v_max, self._last.v + limits.v_accel * self.config.period)
        return Twist(min(speed, limits.v_max), max(ramp, 0.0) * curvature)

    def _best_arc(
        self, pose: Pose2D, lookahead: float, reach: float, around: Surroundings
    ) -> tuple[float, float, float]:
        """Bearing of the carrot (rad), curvature (1/m) of the arc to it, and its free length (m).

        Of carrots nearer and nearer, the first whose arc is free that far; else the freest.
        """
        path, best = self.route.path, None
        assert path is not None
        while True:
            x, y = path.at(self.route.s + lookahead)
            off = wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.theta)
            distance = max(math.dist(pose[:2], (x, y)), 1e-3)
            curvature = 2.0 * math.sin(off) / distance
            free = self.free_length(pose, curvature, min(reach, 4.0), around)
            if best is None or free > best[2]:
                best = off, curvature, free
            if free >= distance or lookahead <= self.settings.lookahead_low:
                return best if free < distance else (off, curvature, free)
            lookahead = max(0.7 * lookahead, self.settings.lookahead_low)

    def _regulated(self, pose: Pose2D, curvature: float, around: Surroundings) -> dict[str, float]:
        """The speeds (m/s) that curvature and proximity leave, by cause."""
        options, fastest = self.settings, self.robot.limits.v_max
        gap = float(around.gaps(np.array([pose]), self.discs)[0])
        left = {
            "curvature": 1.0 / max(abs(curvature) * options.radius_low, 1e-9),
            "proximity": max(gap, 0.0) / options.proximity,
        }
        low = min(options.speed_low, fastest)
        return {cause: max(fastest * min(part, 1.0), low) for cause, part in left.items()}
