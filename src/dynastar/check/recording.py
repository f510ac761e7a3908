"""What a recording says of a robot: when its scans and odometry came, and what is in them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError, InputError
from dynastar.geometry import Pose2D, Twist, wrap_angle
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.navigator.latency_check import LatencyCheck
from dynastar.navigator.readings import Readings
from dynastar.robot import Robot, slew
from dynastar.ros.bag import BagReader
from dynastar.ros.bridge import TAKES
from dynastar.ros.incoming import pose_of, refusals, scan_of, seconds, twist_of
from dynastar.ros.replay import COMMANDS, topics_of
from dynastar.ros.transforms import Mount, Transforms

Floats = npt.NDArray[np.float64]
REST = Twist(0.0, 0.0)
READ = "scan", "odom", "/tf", "/tf_static"


@dataclass(frozen=True)
class Stream:
    """Messages of one kind: stamps (n,) and the times when they were recorded (n,), in seconds."""

    stamps: Floats
    recorded: Floats

    @property
    def gaps(self) -> Floats:
        """Seconds from each stamp to the next (n - 1,)."""
        return np.diff(self.stamps)


@dataclass(frozen=True)
class Recording:
    """A recording measured against a robot and its settings.

    Of several lidars ``scans`` are those whose stamps rise worst, or that have the longest gap.
    ``beams``, ``fov``, ``range_min`` and ``range_max`` have a value for each scan. ``speeds`` (n, 2) are
    those of the odometry, m/s and rad/s. ``hints`` are what the navigator's status would have said of the
    readings, ``latency`` (s) is set if commands clearly acted later than declared. ``mount`` is where the
    transforms have the lidar, with the direction of the middle of its scans.
    """

    scans: Stream
    odometry: Stream
    commands: Floats
    beams: npt.NDArray[np.int64]
    fov: Floats
    range_min: Floats
    range_max: Floats
    speeds: Floats
    hints: tuple[str, ...]
    latency: float | None
    mount: Pose2D | None


def read_recording(
    path: str | Path,
    robot: Robot,
    config: NavigatorConfig,
    remap: Mapping[str, str] | None = None,
) -> Recording:
    """Measures a recording; DataError if it cannot be read or lacks scans or odometry.

    ``remap`` gives the recording's names for the topics scan, odom and cmd_vel.
    """
    bag = BagReader(path)
    collected = _Collected(robot, config)
    try:
        topics = topics_of(bag, remap or {}, set(TAKES) - set(READ))
        names = {name: short for short, name in topics.items() if short in (*READ, COMMANDS)}
        for topic, at, message in bag.messages(set(names)):
            collected.take(names[topic], at, message)
    finally:
        bag.close()
    return collected.recording(path)


@dataclass
class _Collected:
    """What is collected message by message."""

    robot: Robot
    config: NavigatorConfig
    odometry: list[tuple[float, float]] = field(default_factory=list)  # stamps, and when recorded
    lidars: dict[str, list[tuple[float, float]]] = field(default_factory=dict)  # the same, by frame
    scans: list[tuple[int, float, float, float]] = field(default_factory=list)
    speeds: list[Twist] = field(default_factory=list)
    commands: list[float] = field(default_factory=list)
    asked: Twist = REST
    followed: Twist = REST
    hints: dict[str, None] = field(default_factory=dict)
    refused: dict[str, list[str]] = field(default_factory=dict)
    state: RobotState | None = None
    base: str = ""
    mounts: dict[str, Pose2D] = field(default_factory=dict)  # of lidars, by frame

    def __post_init__(self) -> None:
        self.readings = Readings(self.robot)
        self.acting = LatencyCheck(self.robot.limits, self.config.latency)
        self.latency: float | None = None
        self.transforms = Transforms()

    def take(self, short: str, at: float, message: Any) -> None:
        """Takes in a message that was recorded at a time (s)."""
        try:
            if short == COMMANDS:
                self._take_command(at, message)
            elif short in ("/tf", "/tf_static"):
                self.transforms.add(message, static=short.endswith("static"))
            elif short == "odom":
                self._take_odometry(message)
                self.odometry.append((seconds(message.header.stamp), at))
            else:
                self._take_scan(message)
                lidar = self.lidars.setdefault(message.header.frame_id, [])
                lidar.append((seconds(message.header.stamp), at))
        except (
            InputError
        ) as error:  # as a robot's node does, which says so and drives by the others
            self.refused.setdefault(short, []).append(str(error))

    def _take_command(self, at: float, message: Any) -> None:
        command = twist_of(getattr(message, "twist", message))
        if not all(map(math.isfinite, command)):
            raise InputError("the command is not finite")
        self.commands.append(at)
        self.asked = command

    def _take_odometry(self, message: Any) -> None:
        stamp, twist = seconds(message.header.stamp), twist_of(message.twist.twist)
        pose = pose_of(message.pose.pose, "the odometry")
        if not all(map(math.isfinite, (*pose, *twist))):
            raise InputError("the odometry is not finite")
        self.speeds.append(twist)
        if self.state is not None and self.commands:
            self._follow(self.state, stamp - self.state.stamp)
        self.state = RobotState(stamp, pose, twist)
        self.base = message.child_frame_id.lstrip("/")

    def _follow(self, state: RobotState, duration: float) -> None:
        """Compares speeds with what a drive makes of the commands, which may be steps."""
        limits, asked, last = self.robot.limits, self.asked, self.followed
        self.followed = Twist(
            slew(last.v, asked.v, limits.v_accel, limits.v_brake, max(duration, 0.0)),
            slew(
                last.omega, asked.omega, limits.omega_accel, limits.omega_brake, max(duration, 0.0)
            ),
        )
        self.acting.note(state, self.followed)
        self.latency = self.acting.longer or self.latency

    def _take_scan(self, message: Any) -> None:
        placed = self.transforms.planar(self.base, message.header.frame_id.lstrip("/"))
        scan = scan_of(message, placed or Mount(self.robot.lidar.mount))
        if (fault := scan.fault()) is not None:
            raise InputError(fault)
        span = scan.angle_increment * max(len(scan.ranges) - 1, 0)
        self.scans.append((len(scan.ranges), abs(span), scan.range_min, scan.range_max))
        if placed is not None:
            x, y, theta = placed.pose
            middle = wrap_angle(theta + scan.angle_min + 0.5 * span)
            self.mounts[message.header.frame_id] = Pose2D(x, y, middle)
        self.readings.interpreted(scan)
        self.hints |= dict.fromkeys(self.readings.hints)

    def recording(self, path: str | Path) -> Recording:
        """What was collected; DataError if there are fewer than two scans or odometry messages."""
        refused, lidars = refusals(self.refused), list(self.lidars.values())
        most = max(map(len, lidars), default=0)
        for count, what in ((most, "scans"), (len(self.odometry), "messages of odometry")):
            if count < 2:
                has = f"{path}: has {count} {what}: expected 2 or more"
                raise DataError("; ".join([has, *refused]))
        streams = [Stream(*np.array(lidar).T) for lidar in lidars if len(lidar) > 1]
        beams, fov, low, high = map(np.array, zip(*self.scans, strict=True))
        return Recording(
            max(streams, key=lambda one: ((one.gaps <= 0.0).sum(), one.gaps.max())),
            Stream(*np.array(self.odometry).T),
            np.array(self.commands),
            beams,
            fov,
            low,
            high,
            np.array(self.speeds),
            (*self.hints, *self._silent(), *refused),
            self.latency,
            self._mount_nearest(),
        )

    def _silent(self) -> list[str]:
        """Which lidars have stopped, while another went on."""
        last = {frame: lidar[-1][0] for frame, lidar in self.lidars.items()}
        end, begin = max(last.values()), self.odometry[0][0]
        return [
            f"the lidar '{frame}' is silent from {stamp - begin:.1f} s on"
            for frame, stamp in last.items()
            if end - stamp > self.config.scan_age
        ]

    def _mount_nearest(self) -> Pose2D | None:
        """The mount, of the lidars recorded, that is nearest to the declared one."""
        x, y, _ = self.robot.lidar.mount
        mounts = self.mounts.values()
        return min(mounts, key=lambda one: math.hypot(one.x - x, one.y - y), default=None)
