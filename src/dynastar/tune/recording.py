"""A recording as arrays: commands, odometry and scans by the time at which they were received."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError, DynastarError, InputError
from dynastar.geometry import Pose2D
from dynastar.robot import Robot
from dynastar.ros.bag import BagReader
from dynastar.ros.bridge import REQUESTS, started
from dynastar.ros.incoming import pose_of, scan_of, twist_of
from dynastar.ros.replay import COMMANDS, topics_of
from dynastar.ros.transforms import Mount
from dynastar.scan import LaserScan

Floats = npt.NDArray[np.float64]

NOT_NEEDED = {"map", "keepout_filter_mask", "speed_filter_mask", "goal_pose", "amcl_pose"}
NOT_NEEDED |= {"/tf", "/tf_static"}
BURST = 1e-3  # s, at most, between messages that came late together
AT_ORIGIN = Mount(Pose2D(0.0, 0.0, 0.0), False)


@dataclass(frozen=True)
class Drive:
    """A recorded drive: times (s), ``commands`` (n, 2) and ``twists`` (m, 2) in m/s and rad/s.

    ``poses`` (m, 3) are those of the odometry. ``robot`` is what the recording was made with, None where
    it does not say.
    """

    command_times: Floats
    commands: Floats
    times: Floats
    twists: Floats
    poses: Floats
    scan_times: Floats
    scans: tuple[LaserScan, ...]
    robot: Robot | None = None


def read_drive(path: str | Path, remap: Mapping[str, str] | None = None) -> Drive:
    """The drive in a recording; ``remap`` names its topics for scan, odom and cmd_vel.

    Raises DataError for a recording that cannot be read, or that lacks one of the three.
    """
    bag = BagReader(path)
    try:
        topics = topics_of(bag, remap or {}, NOT_NEEDED)
        if COMMANDS not in topics:
            raise DataError(
                f"{bag.path}: no topic '{COMMANDS}' in it: give --topic {COMMANDS}=TOPIC for one of "
                f"another name; it has {', '.join(sorted(bag.topics))}"
            )
        return _read(bag, {name: short for short, name in topics.items()})
    finally:
        bag.close()


def _read(bag: BagReader, shorts: Mapping[str, str]) -> Drive:
    found: dict[str, list[tuple[float, Any]]] = {short: [] for short in shorts.values()}
    robot = None
    for name, time, message in bag.messages(set(shorts)):
        short = shorts[name]
        if short == REQUESTS:
            robot = robot or _robot_in(message.data)
        elif short == COMMANDS:
            found[short].append((time, twist_of(getattr(message, "twist", message))))
        elif short == "odom":
            try:
                odometry = (*pose_of(message.pose.pose), *twist_of(message.twist.twist))
            except InputError:  # as a robot's node does
                continue
            if all(map(math.isfinite, odometry)):
                found[short].append((time, odometry))
        else:
            scan = scan_of(message, AT_ORIGIN)
            if scan.fault() is None:
                found[short].append((time, scan))
    for short in ("scan", "odom", COMMANDS):
        if len(found[short]) < 2:
            raise DataError(f"{bag.path}: fewer than two messages of '{short}' that can be used")
    times, states = (np.array(part) for part in zip(*found["odom"], strict=True))
    apart = np.concatenate([[True], np.diff(times) > BURST])
    times, states = times[apart], states[apart]
    return Drive(
        np.array([time for time, _ in found[COMMANDS]]),
        np.array([twist for _, twist in found[COMMANDS]]),
        times,
        states[:, 3:],
        states[:, :3],
        np.array([time for time, _ in found["scan"]]),
        tuple(scan for _, scan in found["scan"]),
        robot,
    )


def _robot_in(words: str) -> Robot | None:
    """The robot that a recording's first request tells of; None where it tells of none."""
    import json

    try:
        return started(json.loads(words)["start"]).robot
    except (ValueError, KeyError, TypeError, DynastarError):
        return None
