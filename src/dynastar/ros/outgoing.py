"""dynastar's types to ROS 2 messages, made by rclpy's classes or by those that write a bag."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, Twist
from dynastar.scan import LaserScan

Make = Callable[..., Any]  # make("std_msgs/msg/Header", frame_id="map"): a message; other fields 0
Colour = tuple[float, float, float, float]


def rotation_of(make: Make, heading: float) -> Any:
    """The rotation about z by ``heading`` radians."""
    turn = {"z": math.sin(0.5 * heading), "w": math.cos(0.5 * heading)}
    return make("geometry_msgs/msg/Quaternion", **turn)


class Messages:
    """Messages of standard types, with a frame and a stamp in seconds."""

    def __init__(self, make: Make) -> None:
        self.make = make

    def stamp(self, time: float) -> Any:
        """A stamp of a time in seconds."""
        nanoseconds = round(time * 1e9)
        stamp = {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}
        return self.make("builtin_interfaces/msg/Time", **stamp)

    def header(self, frame: str, time: float) -> Any:
        """A header."""
        return self.make("std_msgs/msg/Header", stamp=self.stamp(time), frame_id=frame)

    def point(self, x: float, y: float, z: float = 0.0) -> Any:
        """A point, metres."""
        return self.make("geometry_msgs/msg/Point", x=float(x), y=float(y), z=float(z))

    def pose(self, pose: Pose2D) -> Any:
        """A pose in the plane."""
        turned = rotation_of(self.make, pose.theta)
        position = self.point(pose.x, pose.y)
        return self.make("geometry_msgs/msg/Pose", position=position, orientation=turned)

    def twist(self, twist: Twist) -> Any:
        """A twist in the plane, m/s and rad/s."""
        vector = "geometry_msgs/msg/Vector3"
        linear = self.make(vector, x=float(twist.v))
        angular = self.make(vector, z=float(twist.omega))
        return self.make("geometry_msgs/msg/Twist", linear=linear, angular=angular)

    def twist_stamped(self, twist: Twist, frame: str, time: float) -> Any:
        """A twist in the plane with a stamp."""
        header = self.header(frame, time)
        return self.make("geometry_msgs/msg/TwistStamped", header=header, twist=self.twist(twist))

    def scan(self, scan: LaserScan, frame: str) -> Any:
        """A scan."""
        return self.make(
            "sensor_msgs/msg/LaserScan",
            header=self.header(frame, scan.stamp),
            angle_min=float(scan.angle_min),
            angle_max=float(scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1)),
            angle_increment=float(scan.angle_increment),
            range_min=float(scan.range_min),
            range_max=float(scan.range_max),
            ranges=np.ascontiguousarray(scan.ranges, np.float32),
        )

    def odometry(self, pose: Pose2D, twist: Twist, frames: tuple[str, str], time: float) -> Any:
        """Odometry in the first of two frames, of the second."""
        covered = self.make("geometry_msgs/msg/PoseWithCovariance", pose=self.pose(pose))
        moving = self.make("geometry_msgs/msg/TwistWithCovariance", twist=self.twist(twist))
        header = self.header(frames[0], time)
        kind = "nav_msgs/msg/Odometry"
        return self.make(kind, header=header, child_frame_id=frames[1], pose=covered, twist=moving)

    def grid(
        self, values: npt.NDArray[np.int8], frame: tuple[float, ...], frame_id: str, time: float
    ) -> Any:
        """A map of cells [rows, columns], whose ``frame`` is resolution, x, y and yaw if not 0."""
        x, y, *yaw = frame[1:]
        info = self.make(
            "nav_msgs/msg/MapMetaData",
            map_load_time=self.stamp(time),
            resolution=float(frame[0]),
            height=values.shape[0],
            width=values.shape[1],
            origin=self.pose(Pose2D(x, y, yaw[0] if yaw else 0.0)),
        )
        data = np.ascontiguousarray(values, np.int8).reshape(-1)
        header = self.header(frame_id, time)
        return self.make("nav_msgs/msg/OccupancyGrid", header=header, info=info, data=data)

    def path(self, points: npt.NDArray[np.float64], frame_id: str, time: float) -> Any:
        """A polyline (n, 2), metres, each pose heading for the next."""
        header = self.header(frame_id, time)
        steps = np.diff(points, axis=0)
        headings = np.arctan2(steps[:, 1], steps[:, 0]) if len(steps) else np.zeros(0)
        last = headings[-1:] if len(headings) else np.zeros(1)
        poses = [
            self.make(
                "geometry_msgs/msg/PoseStamped",
                header=header,
                pose=self.pose(Pose2D(x, y, heading)),
            )
            for (x, y), heading in zip(points.tolist(), [*headings, *last], strict=True)
        ]
        return self.make("nav_msgs/msg/Path", header=header, poses=poses)

    def transforms(self, found: list[tuple[str, str, Pose2D]], time: float) -> Any:
        """Transforms of (parent, child, pose of the child)."""
        made = []
        for parent, child, pose in found:
            moved = self.make("geometry_msgs/msg/Vector3", x=float(pose.x), y=float(pose.y))
            transform = self.make(
                "geometry_msgs/msg/Transform",
                translation=moved,
                rotation=rotation_of(self.make, pose.theta),
            )
            kind, header = "geometry_msgs/msg/TransformStamped", self.header(parent, time)
            made.append(self.make(kind, header=header, child_frame_id=child, transform=transform))
        return self.make("tf2_msgs/msg/TFMessage", transforms=made)

    def text(self, words: str) -> Any:
        """A std_msgs/String."""
        return self.make("std_msgs/msg/String", data=words)

    def colour(self, colour: Colour) -> Any:
        """A colour of red, green, blue and alpha, each from 0 to 1."""
        parts = dict(zip("rgba", map(float, colour), strict=True))
        return self.make("std_msgs/msg/ColorRGBA", **parts)
