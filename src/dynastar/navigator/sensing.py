"""Perceive: from states and scans to what is known of the surroundings."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import lower_bounds
from dynastar.dwa.clearance import Closed
from dynastar.field import Field
from dynastar.geometry import Goal, Pose2D, Twist, compose
from dynastar.navigator.aligned import as_moving, turned_pose
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.pose_history import PoseHistory
from dynastar.navigator.scan_feed import ScanFeed
from dynastar.navigator.status import RobotState, as_state, slowed
from dynastar.perception import LocalMap, MovingObstacle, PlanningMap, Track, Tracker
from dynastar.perception.hidden import Hidden, HiddenSpace
from dynastar.perception.local_map import SEEN_OCCUPIED
from dynastar.perception.placed_scan import placed
from dynastar.perception.prediction import Prediction, Times, predict
from dynastar.robot import Robot
from dynastar.scan import LaserScan, as_scans

Mask = npt.NDArray[np.bool_]

AT_PLACE = 0.5  # m from a moving obstacle, up to which it is at a place
TRIAL = Twist(0.1, 0.3)  # speeds up to which the robot drives to see whether a lidar sees again
SEEN_NOW = 0.15  # s before the newest scan, since which a cell that was seen counts as in view


class View(NamedTuple):
    """What is known of the surroundings in one tick.

    ``closed`` is what is not observed free, ``distance_to_obstacle`` is to what is occupied by
    sensing or on the map, ``speed`` (m/s) is the highest that the view is good for.
    """

    closed: Closed
    distance_to_obstacle: Field
    hidden: Hidden
    moving: Prediction
    speed: float


class Sensing:
    """Keep the local map and the tracks up to date, and make a view of them.

    At the start the disc round the robot is taken as free; ``under_way`` it is only what the robot fills
    at every heading.
    """

    def __init__(
        self,
        robot: Robot,
        config: NavigatorConfig,
        planning_map: PlanningMap,
        under_way: bool = False,
    ) -> None:
        self.robot, self.config, self.planning_map = robot, config, planning_map
        self._keep(LocalMap(config.local_map, *planning_map.lattice))
        self.tracker = Tracker(config.tracker)
        self.poses, self.feed = PoseHistory(robot.limits, config), ScanFeed(robot, config)
        self._is_new = True  # until the first scan
        self._start_radius = robot.footprint.inscribed if under_way else self._own_radius
        self.trusts_map = False  # as of the last update

    def on_map(self, planning_map: PlanningMap) -> "Sensing":
        """The sensing on another map: itself with what it has seen, unless the map has another yaw."""
        if planning_map.grid.frame.yaw != self.planning_map.grid.frame.yaw:
            return Sensing(self.robot, self.config, planning_map, under_way=True)
        self.planning_map = planning_map
        if not self.local_map.lies_on(*planning_map.lattice):
            self._keep(self.local_map.moved_onto(*planning_map.lattice))
        return self

    def _keep(self, local_map: LocalMap) -> None:
        """Another local map, of which no cell is known to be clear of hidden people."""
        n, speed = len(local_map.states), self.config.hidden_speed
        self._hidden = HiddenSpace(n, local_map.resolution, speed, local_map.corner)
        self.local_map = local_map

    def forget(self) -> None:
        """Drop what was seen round the robot, but for the tracks."""
        self.local_map.forget()
        self._hidden.forget()

    def perceive(
        self,
        state: RobotState,
        scan: LaserScan | Sequence[LaserScan] | None,
        movers: Sequence[MovingObstacle] | None,
        trusts_map: bool = False,
    ) -> tuple[RobotState, list[MovingObstacle] | None, str | None]:
        """Check what a caller gives. Returns state and movers in the own frame, and a fault or None.

        ``trusts_map`` as in ``update``.
        """
        yaw = self.planning_map.grid.frame.yaw
        state = as_state(state, self.robot.limits)
        state = state._replace(pose=turned_pose(state.pose, -yaw))
        moving, wrong = as_moving(movers, -yaw)
        return state, moving, self.update(state, as_scans(scan), trusts_map) or wrong

    def on_trial(self, state: RobotState, command: Twist | None) -> Twist | None:
        """The command, slowed while the robot tries whether a lidar tells nothing new for good.

        A faster robot brakes when its data are too old. Both speeds stay such that the drive follows them.
        """
        limits = self.robot.limits
        is_fast = abs(state.twist.v) >= 2.0 * max(TRIAL.v, limits.v_least)
        if command is None or is_fast or not self.feed.in_trouble:
            return command
        v, omega = abs(command.v), abs(command.omega)
        braked = limits.v_brake * self.poses.period, limits.omega_brake * self.poses.period
        fraction = max(
            _fraction(limits.v_least, v),
            _fraction(limits.omega_least, omega),
            _fraction(abs(state.twist.v) - braked[0], v),  # slower than it can be after a period
            _fraction(abs(state.twist.omega) - braked[1], omega),
        )
        return slowed(
            command, Twist(max(TRIAL.v, fraction * v), max(TRIAL.omega, fraction * omega))
        )

    def update(
        self, state: RobotState, scans: Sequence[LaserScan], trusts_map: bool = False
    ) -> str | None:
        """Update local map and tracks. Returns why the data cannot be trusted, or None.

        ``trusts_map`` tells to take unseen space that is free on the map as open.
        """
        self.trusts_map = trusts_map
        fault = self.poses.fault(state)
        if fault is not None:
            return fault
        now, (x, y, _) = state.stamp, state.pose
        jumped = self.poses.add(state)
        if jumped:
            self.forget()
            self.tracker.forget()
            self.feed.forget_poses()
        self.local_map.follow(x, y)
        accepted, fault = self.feed.accept(scans, state, self.poses.pose_at)
        for scan in accepted:
            self._add(scan)
        if not self._is_new:
            self.local_map.keep_free((x, y, self._own_radius), now)
        if self._is_new or jumped or self.trusts_map:  # wherever that is, the robot stands there
            radius = self._start_radius if self._is_new else self.robot.footprint.inscribed
            mapped = self._under(self.planning_map.grid.occupied, outside=True)
            self.local_map.assume_free((x, y, radius), now, mapped)
        self._is_new = self._is_new and self.feed.newest == -math.inf
        self.planning_map.place_robot(x, y, self.robot.footprint.circumscribed)
        barred = self._under(self.planning_map.barred, outside=False)
        trusted = ~self._under(self.planning_map.prior, outside=True) if self.trusts_map else None
        self.local_map.update(now, barred, trusted)
        return fault

    def _under(self, mask: Mask, outside: bool) -> Mask:
        return self.planning_map.under(mask, self.local_map, outside)

    def view(
        self,
        now: float,
        moving: Sequence[MovingObstacle] | None,
        times: Times,
    ) -> View:
        """What is known at ``now``; ``moving`` replaces the tracks, ``times`` as in ``predict``."""
        local = self.local_map
        resolution, x0, y0 = local.frame
        occupied = self.planning_map.occupied_under(local)
        seen = local.free_at >= self.feed.newest - SEEN_NOW
        obstacles = lower_bounds((~occupied).view(np.uint8), resolution)
        as_of = min(self.feed.newest, now)
        hidden = self._hidden.update((local.row0, local.column0), seen, occupied, as_of)
        hidden = hidden.later(now - as_of)
        if self.trusts_map:
            hidden = hidden._replace(speed=0.0)  # the robot drives into unseen space
        return View(
            closed=Closed(
                Field(local.field, x0, y0, resolution),
                local.states == SEEN_OCCUPIED,
                local.boxes,
            ),
            distance_to_obstacle=Field(obstacles, x0, y0, resolution),
            hidden=hidden,
            moving=predict(self._moving(now, moving), self.config.prediction, times),
            speed=self.config.unseen_speed if self.trusts_map else math.inf,
        )

    def is_moving_at(self, place: Goal, moving: Sequence[MovingObstacle] | None) -> bool:
        """Whether one of the moving obstacles, given or tracked, is within reach of a place."""
        return any(
            math.hypot(one.x - place.x, one.y - place.y) < one.radius + AT_PLACE
            for one in (self._tracked if moving is None else moving)
        )

    @property
    def _tracked(self) -> list[Track]:
        """The tracks that move for certain, or have moved."""
        return [track for track in self.tracker.tracks if track.state != "tentative"]

    def _moving(self, now: float, moving: Sequence[MovingObstacle] | None) -> list[MovingObstacle]:
        """Moving obstacles as of ``now``: those given, or those tracked."""
        if moving is not None:
            return list(moving)
        dt = now - self.feed.newest
        return [
            MovingObstacle(t.x + t.vx * dt, t.y + t.vy * dt, t.vx, t.vy, t.radius)
            for t in self._tracked
        ]

    @property
    def _own_radius(self) -> float:
        """Radius (m) that is free at the start and not forgotten: the robot, and its blind range."""
        shape, lidar = self.robot.footprint, self.robot.lidar
        return shape.circumscribed + lidar.range_min + 2.0 * self.local_map.resolution

    def _add(self, scan: LaserScan) -> None:
        """Place a scan by its stamp; tracks first, then what does not move into the local map."""
        config, pose = self.config, self.poses.pose_at(scan.stamp)
        assert pose is not None
        sensor: Pose2D = compose(pose, scan.mount)
        errors = config.range_error, config.heading_error
        view = placed(scan, sensor, errors, config.local_map.narrowest)
        moving, left = self.tracker.update(view, self.planning_map.known)
        for disc in left:
            self.local_map.erase(disc)
        self.local_map.see(view, moving, self.feed.number_of(scan))


def _fraction(least: float, speed: float) -> float:
    """The fraction of a speed that a drive follows at the least, above rounding; 0 of rest."""
    return (1.0 + 1e-9) * least / speed if speed > 0.0 else 0.0
