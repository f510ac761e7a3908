"""From scans to what is known of the surroundings; and when the data are not to be trusted."""

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, compose, interpolate, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.status import RobotState
from dynastar.perception import Known, LocalMap, MovingObstacle, Tracker
from dynastar.perception.hidden import Hidden, HiddenSpace
from dynastar.perception.local_map_kernels import scan_points
from dynastar.robot import Robot
from dynastar.scan import LaserScan

SEEN_NOW = 0.15  # s that a cell counts as in view after it was seen
RANGES_UP_TO = 1.001  # times range_max
FARTHEST = 1e6  # m from the map's origin, where positions still tell cells apart
SAME_PLACE = 0.05  # m within which a robot may get the same ranges again
HISTORY = 2.0  # s of poses kept to place scans by


class Sensing:
    """The local map, the tracker, and the poses that scans are placed by."""

    def __init__(self, robot: Robot, config: NavigatorConfig) -> None:
        self.robot, self.config = robot, config
        self.local_map = LocalMap(config.local_map)
        self.tracker = Tracker(config.tracker, config.range_error, config.heading_error)
        self._poses: deque[RobotState] = deque()
        self._seen: dict[Pose2D, float] = {}  # the newest stamp of each sensor
        self._taken: dict[Pose2D, tuple[npt.NDArray[np.floating], Pose2D]] = {}
        self._fresh = True
        self._jumped_to: Pose2D | None = None
        self.hidden = HiddenSpace(
            len(self.local_map.states), config.local_map.resolution, config.hidden_speed
        )

    @property
    def last_scan(self) -> float:
        """Stamp of the newest scan taken in, -inf if there is none."""
        return max(self._seen.values(), default=-math.inf)

    def set_grid(self, grid: OccupancyGrid) -> None:
        """The map, for its keep-out cells and for its obstacles at the start."""
        self.local_map.set_grid(grid)

    @property
    def _own_disc(self) -> float:
        """The radius (m) that is free at the start and not forgotten: the robot, and its blind range."""
        return (
            self.robot.footprint.circumscribed
            + self.robot.lidar.range_min
            + 2.0 * self.config.local_map.resolution
        )

    def place(self, state: RobotState) -> str | None:
        """Takes in where the robot is; what is wrong with that, in words, or None."""
        if not all(math.isfinite(number) for number in (state.stamp, *state.pose, *state.twist)):
            return (
                "the robot's state is not finite: expected a stamp, a pose and a twist of numbers"
            )
        if max(abs(state.pose.x), abs(state.pose.y)) > FARTHEST:
            return (
                f"the robot's pose is ({state.pose.x:g}, {state.pose.y:g}): expected within 1e6 m"
            )
        if self._poses:
            last = self._poses[-1]
            dt = state.stamp - last.stamp
            if dt < 0.0:
                return f"time went back by {-dt:.3f} s"
            if self._jumped(last, state, dt):
                self._poses.clear()
                self.local_map.forget()
                self.tracker.forget()
                self._jumped_to = state.pose
        self._poses.append(state)
        while state.stamp - self._poses[0].stamp > HISTORY:
            self._poses.popleft()
        self.local_map.follow(state.pose.x, state.pose.y)
        return None

    def take_in(self, scans: Sequence[LaserScan], now: float, known: Known) -> str | None:
        """Takes in the scans that are new; what makes the data unusable, in words, or None."""
        fault, ahead = None, 0.0
        for scan in scans:
            if not isinstance(scan, LaserScan):
                fault = f"a scan is {scan!r:.40}: expected a LaserScan"
                continue
            wrong = scan.fault()
            if wrong is None and scan.stamp > now + 0.5 * self.config.period:
                wrong = f"the scan is {scan.stamp - now:.3f} s ahead of the robot's state"
                ahead = max(ahead, scan.stamp - now)
            newer = scan.stamp > self._seen.get(scan.mount, -math.inf)
            if wrong is None and newer:
                wrong = self._without_news(scan)
            if wrong is not None:
                fault = wrong
            elif newer:
                self._see(scan, known)
        age = now - self.last_scan
        if age > self.config.scan_age:
            fault = fault or "no scan" + (f" for {age:.1f} s" if math.isfinite(age) else " yet")
        elif ahead > self.config.scan_age:
            fault = f"the robot's state is {ahead:.1f} s older than the scan"
        else:
            fault = None
        here = self._poses[-1].pose
        self.local_map.assume_free(here.x, here.y, self._own_disc, now, self._fresh)
        if self._jumped_to is not None:  # wherever that is, the robot stands there
            inside = self.robot.footprint.inscribed
            self.local_map.assume_free(here.x, here.y, inside, now, fresh=True)
            self._jumped_to = None
        self._fresh = self._fresh and not math.isfinite(age)
        self.local_map.update(now)
        return fault

    def moving(self, now: float, movers: Sequence[MovingObstacle] | None) -> list[MovingObstacle]:
        """Moving obstacles as of ``now``; ``movers`` in place of those tracked."""
        if movers is not None:
            return [MovingObstacle(*m) for m in movers if all(map(math.isfinite, m))]
        dt = now - self.last_scan
        return [
            MovingObstacle(t.x + t.vx * dt, t.y + t.vy * dt, t.vx, t.vy, t.radius)
            for t in self.tracker.tracks
            if t.state != "tentative"
        ]

    def unseen(self, occupied: npt.NDArray[np.bool_], now: float) -> Hidden:
        """Places where a person may be hidden; ``occupied`` (n, n) are the local map's obstacles."""
        local = self.local_map
        seen = local.free_at >= now - SEEN_NOW
        return self.hidden.update((local.row0, local.column0), seen, occupied, now)

    def _without_news(self, scan: LaserScan) -> str | None:
        """Why a scan tells nothing, in words: no valid range, or the last one again while moving."""
        ranges = np.asarray(scan.ranges)
        beyond = (ranges > RANGES_UP_TO * scan.range_max) & (ranges != np.inf)
        if (np.isnan(ranges) | beyond).all():
            return "the scan has no valid range"
        here = self._poses[-1].pose
        last, there = self._taken.get(scan.mount, (None, here))
        if last is None or not np.array_equal(ranges, last, equal_nan=True):
            self._taken[scan.mount] = (ranges.copy(), here)
            return None
        moved = math.hypot(here.x - there.x, here.y - there.y) > SAME_PLACE
        if moved and np.isfinite(ranges).any():
            return "the scan repeats the last one, though the robot has moved"
        return None

    def _see(self, scan: LaserScan, known: Known) -> None:
        self._seen[scan.mount] = scan.stamp
        sensor = compose(self._pose_at(scan.stamp), scan.mount)
        limits, angles = (scan.range_min, scan.range_max), (scan.angle_min, scan.angle_increment)
        points, beams = scan_points(scan.ranges, limits, angles, tuple(sensor))
        moving = self.tracker.update(scan, sensor, points, beams, self.local_map, known)
        self.local_map.see(
            scan, sensor, points, moving, self.config.range_error, self.config.heading_error
        )

    def _pose_at(self, stamp: float) -> Pose2D:
        after = self._poses[-1]
        for before in reversed(self._poses):
            if before.stamp <= stamp:
                span = after.stamp - before.stamp
                share = min(1.0, (stamp - before.stamp) / span) if span > 0.0 else 0.0
                return interpolate(before.pose, after.pose, share)
            after = before
        return self._poses[0].pose

    def _jumped(self, last: RobotState, state: RobotState, dt: float) -> bool:
        """Whether the pose moved further than the robot can have (the map frame was corrected)."""
        limits, config = self.robot.limits, self.config
        moved = math.hypot(state.pose.x - last.pose.x, state.pose.y - last.pose.y)
        turned = abs(wrap_angle(state.pose.theta - last.pose.theta))
        far = max(limits.v_max, -limits.v_min) * dt * 1.2 + 4.0 * config.pose_error + 0.05
        return (
            moved > far or turned > limits.omega_max * dt * 1.2 + 4.0 * config.heading_error + 0.1
        )
