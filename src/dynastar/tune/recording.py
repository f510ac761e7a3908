"""A recording as arrays: commands, odometry and scans by the time at which they were received."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError, DynastarError, InputError
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Robot
from dynastar.ros.bag import BagReader
from dynastar.ros.bridge import REQUESTS, started
from dynastar.ros.incoming import pose_of, refusals, scan_of, twist_of
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

    ``poses`` (m, 3) are those of the odometry. ``robot`` is what the recording was made with, None
    where it does not say. ``left_out`` says in words which messages were refused.
    """

    command_times: Floats
    commands: Floats
    times: Floats
    twists: Floats
    poses: Floats
    scan_times: Floats
    scans: tuple[LaserScan, ...]
    robot: Robot | None = None
    left_out: tuple[str, ...] = ()


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
    lidars: dict[str, list[tuple[float, Any]]] = {}  # by the frame of its scans
    refused: dict[str, list[str]] = {}
    for name, time, message in bag.messages(set(shorts)):
        short = shorts[name]
        if short == REQUESTS:
            robot = robot or _robot_in(message.data)
        elif short == COMMANDS:
            _note(found[short], refused, short, time, _command(message))
        elif short == "odom":
            _note(found[short], refused, short, time, _odometry(message))
        else:
            scan = scan_of(message, AT_ORIGIN)
            lidar = lidars.setdefault(message.header.frame_id, [])
            _note(lidar, refused, short, time, scan.fault() or scan)
    for frame in sorted(lidars, key=lambda name: len(lidars[name])):
        others, found["scan"] = found["scan"], lidars[frame]
        refused.setdefault("scan", []).extend(["another lidar has more scans"] * len(others))
    for short in ("scan", "odom", COMMANDS):
        if len(found[short]) < 2:
            few = f"{bag.path}: fewer than two messages of '{short}' that can be used"
            raise DataError("; ".join([few, *_refusals(refused)]))
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
        _refusals(refused),
    )


def _refusals(refused: Mapping[str, list[str]]) -> tuple[str, ...]:
    """A sentence for each topic of which messages were refused."""
    return refusals({topic: words for topic, words in refused.items() if words})


def _command(message: Any) -> Twist | str:
    """The command in a message, or what is wrong with it."""
    try:
        command = twist_of(getattr(message, "twist", message))
    except InputError as error:
        return str(error)
    return command if all(map(math.isfinite, command)) else "the command is not finite"


def _odometry(message: Any) -> tuple[float, ...] | str:
    """Pose and speeds of a message of odometry, or what is wrong with them."""
    try:
        found = (*pose_of(message.pose.pose), *twist_of(message.twist.twist))
    except InputError as error:
        return str(error)
    return found if all(map(math.isfinite, found)) else "the odometry is not finite"


def _note(
    found: list[tuple[float, Any]],
    refused: dict[str, list[str]],
    topic: str,
    time: float,
    read: Any,
) -> None:
    """Keep what was read from a message, or in words why it was refused."""
    if isinstance(read, str):
        refused.setdefault(topic, []).append(read)
    else:
        found.append((time, read))


def _robot_in(words: str) -> Robot | None:
    """The robot that a recording's first request tells of; None where it tells of none."""
    import json

    try:
        return started(json.loads(words)["start"]).robot
    except (ValueError, KeyError, TypeError, DynastarError):
        return None
