"""Where the robot is in the map: odometry, corrected by a localization where there is one."""

import math
from collections import deque
from typing import Literal

from dynastar.errors import InputError
from dynastar.geometry import Pose2D, Twist, compose, inverse
from dynastar.navigator import RobotState
from dynastar.navigator.pose_history import pose_at

PoseSource = Literal["odom", "amcl", "tf"]
KEPT = 5.0  # s of odometry
SET_BACK = (
    0.5  # s by which a stamp has to be older than the one before for a clock that was set back
)


class Localization:
    """Keeps odometry, and the pose of the odometry's frame in the map."""

    def __init__(self, source: PoseSource) -> None:
        self.source = source
        self.map_to_odom = Pose2D(0.0, 0.0, 0.0) if source == "odom" else None
        self._odometry: deque[RobotState] = deque()
        self._pose: tuple[float, Pose2D] | None = None  # in the map, before the first odometry

    @property
    def stamp(self) -> float:
        """Stamp (s) of the newest odometry, -inf without any."""
        return self._odometry[-1].stamp if self._odometry else -math.inf

    def reset(self) -> None:
        """Drops all that has a stamp: time has jumped."""
        self._odometry.clear()
        self._pose = None

    def add_odometry(self, stamp: float, pose: Pose2D, twist: Twist) -> None:
        """Takes in odometry. InputError if not finite.

        What is a little older than the newest is left out; by more, the clock was set back.
        """
        if not all(map(math.isfinite, (stamp, *pose, *twist))):
            raise InputError("the odometry is not finite")
        if stamp < self.stamp - SET_BACK:
            self._odometry.clear()
        if stamp <= self.stamp:
            return
        self._odometry.append(RobotState(stamp, pose, twist))
        while self._odometry[0].stamp < stamp - KEPT:
            self._odometry.popleft()
        if self._pose is not None:
            self.add_pose(*self._pose)

    def add_pose(self, stamp: float, pose: Pose2D) -> None:
        """Takes in the pose in the map at a time, as /amcl_pose has it; kept until there is odometry."""
        self._pose = None if self._odometry else (stamp, pose)
        if self._odometry:
            self.map_to_odom = compose(pose, inverse(pose_at(self._odometry, stamp)))

    def at(self, now: float) -> RobotState | None:
        """State in the map at ``now`` (s), from the newest odometry; None if it is not known."""
        if not self._odometry or self.map_to_odom is None:
            return None
        newest = self._odometry[-1]
        pose = pose_at(self._odometry, max(now, newest.stamp))
        return RobotState(now, compose(self.map_to_odom, pose), newest.twist)
