"""Recordings for tests, as something else than dynastar writes them."""

import math

import numpy as np

from dynastar.geometry import Pose2D, Twist
from dynastar.ros.bag import BagWriter, make
from dynastar.ros.outgoing import Messages

OUT = Messages(make)
ODOMETRY = "nav_msgs/msg/Odometry"


def odometry(k):
    """Message number k, with k as its x, and as many bytes as a scan."""
    message = OUT.odometry(Pose2D(float(k), 0.0, 0.0), Twist(0.0, 0.0), ("odom", "base"), 0.1 * k)
    message.child_frame_id = f"base{k}" + 500 * "x"
    return message


def foreign(
    folder, topics=("/robot/map", "/robot/front/scan", "/robot/odom", "/goal_pose"), late=0.0
):
    """A recording by something else: no requests, wall-clock receive times, other names.

    A topic of None is left out, map or goal. Scans come ``late`` (s) after their stamps.
    """
    names = dict(zip(("map", "scan", "odom", "goal"), topics, strict=True))
    values = np.zeros((100, 100), np.int8)
    values[[0, -1]] = values[:, [0, -1]] = 100
    goal = {"header": OUT.header("map", 0.0), "pose": OUT.pose(Pose2D(4.0, 2.5, 0.0))}
    with BagWriter(folder) as bag:
        wall, pose = 1.7e9, Pose2D(1.0, 2.5, 0.0)
        grid = OUT.grid(values, (0.05, 0.0, 0.0), "map", 0.0)
        if names["map"] is not None:
            bag.write(names["map"], "nav_msgs/msg/OccupancyGrid", wall, grid)
        goal_message = make("geometry_msgs/msg/PoseStamped", **goal)
        for k in range(20):
            time = 0.1 * k
            message = OUT.odometry(pose, Twist(0.0, 0.0), ("odom", "base"), time)
            bag.write(names["odom"], ODOMETRY, wall + time, message)
            scan = make(
                "sensor_msgs/msg/LaserScan",
                header=OUT.header("laser", max(time - late, 0.0)),
                angle_increment=math.tau / 360,
                range_min=0.12,
                range_max=3.5,
                ranges=np.full(360, np.inf, np.float32),
            )
            bag.write(names["scan"], "sensor_msgs/msg/LaserScan", wall + time, scan)
            if k == 5 and names["goal"] is not None:
                bag.write(names["goal"], "geometry_msgs/msg/PoseStamped", wall + time, goal_message)
