"""ROS 2 messages to dynastar's types: sizes, frames and numbers are checked.

Messages are used by their fields alone, so those of rclpy and those read from a bag do alike.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dynastar.config import counted
from dynastar.errors import InputError
from dynastar.geometry import Goal, Pose2D, Twist, place, wrap_angle
from dynastar.grid import MAX_CELLS, GridFrame, OccupancyGrid
from dynastar.navigator.pose_history import FARTHEST
from dynastar.ros.transforms import Mount, check_level
from dynastar.scan import LaserScan


def seconds(stamp: Any) -> float:
    """A message's stamp (builtin_interfaces/Time) in seconds."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def yaw_of(rotation: Any, what: str = "an orientation") -> float:
    """The yaw of a rotation, rad; InputError where it is tilted too far, or is none."""
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not 0.9 < norm < 1.1:  # NaN is neither
        raise InputError(
            f"{what} has the orientation ({x:g}, {y:g}, {z:g}, {w:g}): expected a unit quaternion"
        )
    check_level(what, 1.0 - 2.0 * (x * x + y * y) / (norm * norm))
    return wrap_angle(math.atan2(2.0 * (x * y + w * z), w * w + x * x - y * y - z * z))


def position_of(pose: Any, what: str) -> tuple[float, float]:
    """(x, y) of a geometry_msgs/Pose, metres; InputError where they are not finite."""
    x, y = float(pose.position.x), float(pose.position.y)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise InputError(f"{what} has the position ({x:g}, {y:g}): expected finite numbers")
    return x, y


def pose_of(pose: Any, what: str = "a pose") -> Pose2D:
    """A geometry_msgs/Pose in the plane; InputError where it is not finite or tilted too far."""
    x, y = position_of(pose, what)
    return Pose2D(x, y, yaw_of(pose.orientation, what))


def twist_of(twist: Any) -> Twist:
    """A geometry_msgs/Twist in the plane, with the numbers that it has; InputError for no such message."""
    try:
        return Twist(float(twist.linear.x), float(twist.angular.z))
    except AttributeError:
        kind = getattr(twist, "__msgtype__", type(twist).__name__)
        raise InputError(f"a message is a {kind}: expected geometry_msgs/msg/Twist") from None


def goal_of(message: Any, frame: str) -> Goal:
    """The goal in a PoseStamped of ``frame``; InputError for another frame or a pose that is none.

    An orientation of four zeros means any heading.
    """
    check_frame("a goal", message.header.frame_id, frame)
    pose, turn = message.pose, message.pose.orientation
    if any((turn.x, turn.y, turn.z, turn.w)):
        return Goal(*pose_of(pose, "its pose"))
    x, y = position_of(pose, "its pose")
    return Goal(x, y)


def check_frame(what: str, given: str, expected: str) -> None:
    """Raises InputError unless a message is in the frame that is expected."""
    if given.lstrip("/") != expected:
        raise InputError(f"{what} is in the frame '{given:.80}': expected '{expected}'")


def grid_of(message: Any, frame: str) -> OccupancyGrid:
    """The map in an OccupancyGrid. Raises InputError for a wrong frame, size or value."""
    check_frame("the map", message.header.frame_id, frame)
    info = message.info
    rows, columns = int(info.height), int(info.width)
    if not 0 < rows * columns <= MAX_CELLS:
        raise InputError(f"the map is {columns} x {rows} cells: expected 1 to {MAX_CELLS}")
    if len(message.data) != rows * columns:
        raise InputError(f"the map has {len(message.data)} values: expected {columns} x {rows}")
    values = np.frombuffer(message.data, dtype=np.int8).reshape(rows, columns)
    pose = pose_of(info.origin, "the map's origin")
    if max(abs(pose.x), abs(pose.y)) > FARTHEST:
        raise InputError(
            f"the map's origin is {place(pose.x, pose.y)}: expected within {FARTHEST:g} m"
        )
    return OccupancyGrid(values, GridFrame(float(info.resolution), *pose))


def refusals(refused: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """A sentence for each topic: how many of its messages were refused, and why the first was."""
    return tuple(
        f"of {topic} {counted(len(words), 'message')} refused, the first since {words[0]}"
        for topic, words in refused.items()
    )


def scan_of(message: Any, mount: Mount) -> LaserScan:
    """The scan in a LaserScan message, of a lidar mounted at ``mount``."""
    turn = -1.0 if mount.upside_down else 1.0
    return LaserScan(
        seconds(message.header.stamp),
        np.asarray(message.ranges, dtype=np.float32),
        turn * float(message.angle_min),
        turn * float(message.angle_increment),
        float(message.range_min),
        float(message.range_max),
        mount.pose,
        str(message.header.frame_id),
    )
