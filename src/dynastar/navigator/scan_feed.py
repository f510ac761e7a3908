"""Scans as they come in: which of them are new, and why others cannot be used."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from dynastar.config import shown
from dynastar.geometry import Pose2D, compose
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.pose_history import AT_REST, KEPT_FOR
from dynastar.navigator.readings import Readings
from dynastar.navigator.repeats import contradicted
from dynastar.navigator.status import RobotState
from dynastar.robot import Robot
from dynastar.scan import LaserScan

ENOUGH = 0.02  # of the beams contradict a scan that repeats
FIRST_WAIT = 2.0  # s at rest before a lidar that seems frozen is tried again; doubles each time
LONGEST_WAIT = 60.0  # s
SILENT = 5.0  # s without a scan, after which a lidar is forgotten
NO_VALID_RANGE = (
    "the scan has no valid range: its readings are NaN, beyond range_max or within the robot's own "
    "footprint (if the driver writes them for no return, declare them in sensor.nothing)"
)
REPEATED = "the scan repeats the last one, though the robot has moved"

FROM_BEFORE = "the scan is from before the first pose, or before the pose jumped"
TOO_NEAR = "the scan has no valid range: what the lidar sees is nearer than its range_min"

PoseAt = Callable[[float], Pose2D | None]


class Source:
    """What is kept of one lidar."""

    def __init__(self, robot: Robot, number: int) -> None:
        self.readings, self.number = Readings(robot), number
        self.stamp = -math.inf  # of the newest scan that was accepted,
        self.heard = -math.inf  # and of the newest of all
        self.last: LaserScan | None = None  # the first scan with the newest readings,
        self.pose = Pose2D(0.0, 0.0, 0.0)  # and the sensor's pose then, in the map frame
        self.tries = 0  # to drive on though the lidar seems frozen
        self.is_tried = False
        self.trouble = ""  # why its scans are not used

    def try_again(self, rest: float) -> bool:
        """Whether to drive on though the lidar tells nothing new, after the robot has rested ``rest`` s."""
        wait = min(FIRST_WAIT * 2.0 ** min(self.tries, 10), LONGEST_WAIT)
        tried, self.is_tried = self.is_tried, rest >= wait
        self.tries += tried and not self.is_tried
        return self.is_tried


class ScanFeed:
    """Checks the scans of all lidars; a lidar is told by the name of its frame, or else by its mount.

    ``newest`` is the stamp (s) of the newest scan that was accepted, -inf if there is none.
    """

    def __init__(self, robot: Robot, config: NavigatorConfig) -> None:
        self._robot, self._config = robot, config
        self._sources: dict[str | Pose2D, Source] = {}
        self._moved_at = -math.inf  # stamp (s) of the last state in which the robot moved
        self.newest = -math.inf

    @property
    def in_trouble(self) -> bool:
        """Whether the scans of some lidar are not used."""
        return any(source.trouble for source in self._sources.values())

    def number_of(self, scan: LaserScan) -> int:
        """The number of the lidar of an accepted scan, unlike those of the others."""
        return self._sources[_key(scan)].number

    @property
    def hints(self) -> list[str]:
        """What has been odd about the scans for some seconds, though the robot drives."""
        found = [hint for source in self._sources.values() for hint in source.readings.hints]
        trouble = [source.trouble for source in self._sources.values() if source.trouble]
        return list(dict.fromkeys(found + trouble))

    def forget_poses(self) -> None:
        """The robot's pose has jumped: it does not tell what readings should have changed."""
        for source in self._sources.values():
            source.last = None

    def accept(
        self, scans: Sequence[LaserScan], state: RobotState, pose_at: PoseAt
    ) -> tuple[list[LaserScan], str | None]:
        """The scans that are new and can be used, interpreted, and a fault, or None.

        ``pose_at`` gives the robot's pose at a stamp, None if it is not known. There is no fault as long
        as some scan is no older than ``scan_age``.
        """
        accepted, fault, ahead, now = [], None, 0.0, state.stamp
        if max(map(abs, state.twist)) > AT_REST:
            self._moved_at = now
        for key in [key for key, one in self._sources.items() if now - one.heard > SILENT]:
            del self._sources[key]
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
            pose = pose_at(given.stamp) if wrong is None else None
            if pose is None:
                wrong = wrong or FROM_BEFORE
            else:
                scan, wrong = self._news(given, now, pose)
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
        self, given: LaserScan, now: float, robot: Pose2D
    ) -> tuple[LaserScan | None, str | None]:
        """The scan as it can be used, None if it has no information that is new, and why it is wrong.

        ``robot`` is the robot's pose at the scan's stamp.
        """
        source = self._source(given)
        if given.stamp <= source.stamp:
            return None, None
        scan = source.readings.interpreted(given)
        is_blind = bool(np.isnan(scan.ranges).all())
        if is_blind and not _is_too_near(given):
            return None, NO_VALID_RANGE
        self._sources[_key(given)], source.heard = source, scan.stamp
        if is_blind:
            source.trouble = TOO_NEAR
        else:
            is_frozen = self._is_frozen(source, scan, compose(robot, scan.mount))
            source.trouble = REPEATED if is_frozen else ""
        if source.trouble and not source.try_again(now - self._moved_at):
            return None, source.trouble
        source.stamp = scan.stamp
        self.newest = max(self.newest, scan.stamp)
        return (None if source.trouble else scan), None

    def _source(self, scan: LaserScan) -> Source:
        """What is kept of the lidar of a scan, or of a new one."""
        known = self._sources.get(_key(scan))
        if known is not None:
            return known
        taken = {one.number for one in self._sources.values()}
        number = next(n for n in range(len(taken) + 1) if n not in taken)
        return Source(self._robot, number)

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


def _key(scan: LaserScan) -> str | Pose2D:
    return scan.frame or scan.mount


def _is_too_near(scan: LaserScan) -> bool:
    """Whether something is nearer than the lidar measures: 0 and less are no distances."""
    return bool(((scan.ranges > 0.0) & (scan.ranges <= scan.range_min)).any())
