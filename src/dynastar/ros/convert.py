"""Messages to dynastar's types and back: sizes, frames and numbers are checked on the way in."""

import array
import math
from typing import Any

import numpy as np
import numpy.typing as npt
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, Quaternion
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Path as PathMessage
from sensor_msgs.msg import LaserScan as ScanMessage

from dynastar.errors import InputError
from dynastar.geometry import Goal, Pose2D, wrap_angle
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io.files import MAX_CELLS
from dynastar.scan import LaserScan

UPRIGHT = 0.02  # rad, largest roll or pitch of a planar pose


def seconds(stamp: Time) -> float:
    """A message's stamp in seconds."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def stamp_of(time: float) -> Time:
    """A message's stamp of a time in seconds."""
    nanoseconds = round(time * 1e9)
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


def yaw_of(rotation: Quaternion) -> float:
    """The heading of a rotation about z, rad; InputError for another or none."""
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not 0.9 < norm < 1.1:  # NaN is neither
        raise InputError(
            f"an orientation is ({x:g}, {y:g}, {z:g}, {w:g}): expected a unit quaternion"
        )
    if 2.0 * math.hypot(x, y) > UPRIGHT * norm:
        raise InputError("an orientation is tilted: expected a rotation about z alone")
    return wrap_angle(2.0 * math.atan2(z, w))


def rotation_of(heading: float) -> Quaternion:
    """The rotation about z by ``heading`` radians."""
    return Quaternion(x=0.0, y=0.0, z=math.sin(0.5 * heading), w=math.cos(0.5 * heading))


def pose_of(pose: Any) -> Pose2D:
    """A geometry_msgs/Pose in the plane; InputError where it is not finite or tilted."""
    x, y = float(pose.position.x), float(pose.position.y)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise InputError(f"a position is ({x:g}, {y:g}): expected finite numbers")
    return Pose2D(x, y, yaw_of(pose.orientation))


def goal_of(message: PoseStamped, frame: str) -> Goal:
    """The goal in a PoseStamped of ``frame``; InputError for another frame or a pose that is none."""
    check_frame("a goal", message.header.frame_id, frame)
    return Goal(*pose_of(message.pose))


def check_frame(what: str, given: str, expected: str) -> None:
    """Raises InputError unless a message is in the frame that is expected."""
    if given.lstrip("/") != expected:
        raise InputError(f"{what} is in the frame '{given:.80}': expected '{expected}'")


def grid_of(message: GridMessage, frame: str) -> OccupancyGrid:
    """The map in a message; InputError for another frame, size or values that are none."""
    check_frame("the map", message.header.frame_id, frame)
    info = message.info
    rows, columns = int(info.height), int(info.width)
    if not 0 < rows * columns <= MAX_CELLS:
        raise InputError(f"the map is {columns} x {rows} cells: expected 1 to {MAX_CELLS}")
    if len(message.data) != rows * columns:
        raise InputError(f"the map has {len(message.data)} values: expected {columns} x {rows}")
    values = np.frombuffer(message.data, dtype=np.int8).reshape(rows, columns)
    pose = pose_of(info.origin)
    return OccupancyGrid(values, GridFrame(float(info.resolution), *pose))


def scan_of(message: ScanMessage, mount: Pose2D) -> LaserScan:
    """The scan in a message, of a lidar mounted at ``mount``."""
    return LaserScan(
        seconds(message.header.stamp),
        np.asarray(message.ranges, dtype=np.float32),
        float(message.angle_min),
        float(message.angle_increment),
        float(message.range_min),
        float(message.range_max),
        mount,
    )


def scan_message(scan: LaserScan, frame: str) -> ScanMessage:
    """A message of a scan."""
    message = ScanMessage()
    message.header.stamp, message.header.frame_id = stamp_of(scan.stamp), frame
    message.angle_min, message.angle_increment = scan.angle_min, scan.angle_increment
    message.angle_max = scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1)
    message.range_min, message.range_max = scan.range_min, scan.range_max
    message.ranges = array.array("f", scan.ranges.astype(np.float32).tobytes())
    return message


def grid_message(
    values: npt.NDArray[np.int8], frame: tuple[float, ...], frame_id: str, time: float
) -> GridMessage:
    """A message of cells [rows, columns], whose ``frame`` is resolution, x, y and yaw if not 0."""
    message = GridMessage()
    message.header.stamp, message.header.frame_id = stamp_of(time), frame_id
    message.info.map_load_time = message.header.stamp
    message.info.resolution = float(frame[0])
    message.info.height, message.info.width = values.shape
    message.info.origin.position.x, message.info.origin.position.y = map(float, frame[1:3])
    message.info.origin.orientation = rotation_of(frame[3] if len(frame) > 3 else 0.0)
    message.data = array.array("b", np.ascontiguousarray(values, np.int8).tobytes())
    return message


def path_message(points: npt.NDArray[np.float64], frame_id: str, time: float) -> PathMessage:
    """A message of a polyline (n, 2), each pose heading for the next."""
    message = PathMessage()
    message.header.stamp, message.header.frame_id = stamp_of(time), frame_id
    steps = np.diff(points, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0]) if len(steps) else np.zeros(0)
    last = headings[-1:] if len(headings) else np.zeros(1)
    for (x, y), heading in zip(points, [*headings, *last], strict=True):
        pose = PoseStamped(header=message.header)
        pose.pose.position.x, pose.pose.position.y = float(x), float(y)
        pose.pose.orientation = rotation_of(float(heading))
        message.poses.append(pose)
    return message
