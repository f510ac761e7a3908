"""Scans as they come in: which of them are new, and why others cannot be used."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from dynastar.config import shown
from dynastar.geometry import Pose2D, compose
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.pose_history import KEPT_FOR
from dynastar.navigator.readings import Readings
from dynastar.navigator.repeats import contradicted
from dynastar.navigator.status import RobotState
from dynastar.robot import Robot
from dynastar.scan import LaserScan

ENOUGH = 0.02  # of the beams contradict a scan that repeats
AT_REST = 0.01  # m/s and rad/s up to which the robot is at rest
FIRST_WAIT = 2.0  # s at rest before a lidar that seems frozen is tried again; doubles each time
LONGEST_WAIT = 60.0  # s
SILENT = 5.0  # s without a scan, after which a lidar is forgotten
NO_VALID_RANGE = (
    "the scan has no valid range: its readings are NaN, beyond range_max or within the robot's own "
    "footprint (if the driver writes them for no return, add them to lidar.nothing)"
)
REPEATED = "the scan repeats the last one, though the robot has moved"

PoseAt = Callable[[float], Pose2D]


class Source:
    """What is kept of one lidar."""

    def __init__(self, robot: Robot, config: NavigatorConfig) -> None:
        self.readings = Readings(robot, config)
        self.stamp = -math.inf  # of the newest scan that was accepted,
        self.heard = -math.inf  # and of the newest of all
        self.last: LaserScan | None = None  # the first scan with the newest readings,
        self.pose = Pose2D(0.0, 0.0, 0.0)  # and the sensor's pose then, in the map frame
        self.tries = 0  # to drive on though the lidar seems frozen
        self.is_tried = self.is_frozen = False

    def try_again(self, rest: float) -> bool:
        """Whether to drive on though the lidar seems frozen, after the robot has rested ``rest`` s."""
        wait = min(FIRST_WAIT * 2.0 ** min(self.tries, 10), LONGEST_WAIT)
        tried, self.is_tried = self.is_tried, rest >= wait
        self.tries += tried and not self.is_tried
        return self.is_tried


class ScanFeed:
    """Checks the scans of all lidars; a lidar is told by its mount.

    ``newest`` is the stamp (s) of the newest scan that was accepted, -inf if there is none.
    """

    def __init__(self, robot: Robot, config: NavigatorConfig) -> None:
        self._robot, self._config = robot, config
        self._sources: dict[Pose2D, Source] = {}
        self._moved_at = -math.inf  # stamp (s) of the last state in which the robot moved
        self.newest = -math.inf

    @property
    def is_frozen(self) -> bool:
        """Whether some lidar repeats readings that the robot's motion contradicts."""
        return any(source.is_frozen for source in self._sources.values())

    @property
    def hints(self) -> list[str]:
        """What has been odd about the scans for some seconds, though the robot drives."""
        found = [hint for source in self._sources.values() for hint in source.readings.hints]
        return list(dict.fromkeys(found + [REPEATED] * self.is_frozen))

    def forget_poses(self) -> None:
        """The robot's pose has jumped: it does not tell what readings should have changed."""
        for source in self._sources.values():
            source.last = None

    def accept(
        self, scans: Sequence[LaserScan], state: RobotState, pose_at: PoseAt
    ) -> tuple[list[LaserScan], str | None]:
        """The scans that are new and can be used, interpreted, and a fault, or None.

        ``pose_at`` gives the robot's pose at a stamp. There is no fault as long as some scan is no older
        than ``scan_age``.
        """
        accepted, fault, ahead, now = [], None, 0.0, state.stamp
        if max(map(abs, state.twist)) > AT_REST:
            self._moved_at = now
        for mount in [at for at, one in self._sources.items() if now - one.heard > SILENT]:
            del self._sources[mount]
        for given in scans:
            if not isinstance(given, LaserScan):
                fault = f"a scan is {shown(given)}: expected a LaserScan"
                continue
            wrong = given.fault()
            if wrong is None and given.stamp > now + 0.5 * self._config.period:
                wrong = f"the scan is {given.stamp - now:.3f} s ahead of the robot's state"
                ahead = max(ahead, given.stamp - now)
            if wrong is None and now - given.stamp > KEPT_FOR:  # where the robot was is not known
                wrong = f"the scan is {now - given.stamp:.1f} s older than the robot's state"
            if wrong is None:
                scan, wrong = self._news(given, now, pose_at)
                accepted += [scan] if scan is not None else []
            fault = wrong or fault
        age = now - self.newest
        if age > self._config.scan_age:
            return accepted, fault or "no scan" + (
                f" for {age:.1f} s" if age < math.inf else " yet"
            )
        if ahead > self._config.scan_age:
            return accepted, f"the robot's state is {ahead:.1f} s older than the scan"
        return accepted, None

    def _news(
        self, given: LaserScan, now: float, pose_at: PoseAt
    ) -> tuple[LaserScan | None, str | None]:
        """The scan as it can be used, None if it has no information that is new, and why it is wrong."""
        source = self._sources.get(given.mount) or Source(self._robot, self._config)
        if given.stamp <= source.stamp:
            return None, None
        scan = source.readings.interpreted(given)
        if np.isnan(scan.ranges).all() and not (given.ranges <= given.range_min).any():
            return None, NO_VALID_RANGE
        self._sources[given.mount], source.heard = source, scan.stamp
        pose = compose(pose_at(scan.stamp), scan.mount)
        source.is_frozen = self._is_frozen(source, scan, pose)
        if source.is_frozen and not source.try_again(now - self._moved_at):
            return None, REPEATED
        source.stamp = scan.stamp
        self.newest = max(self.newest, scan.stamp)
        return (None if source.is_frozen else scan), None

    def _is_frozen(self, source: Source, scan: LaserScan, pose: Pose2D) -> bool:
        """Whether a lidar repeats readings that the motion since it first gave them contradicts."""
        last = source.last
        if last is None or not np.array_equal(scan.ranges, last.ranges, equal_nan=True):
            source.last, source.pose, source.tries, source.is_tried = scan, pose, 0, False
        elif self._moved_at <= last.stamp:  # at rest since: the pose may have been corrected
            source.pose = pose
        else:
            return contradicted(scan, source.pose, pose, self._config) >= ENOUGH
        return False
