"""Messages and types: what goes in comes out, and what is none is refused with the reason."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.errors import InputError
from dynastar.geometry import Goal, Pose2D
from dynastar.grid import GridFrame
from dynastar.ros import incoming
from dynastar.ros.bag import as_read, make
from dynastar.ros.outgoing import Messages, rotation_of
from dynastar.ros.transforms import Mount
from dynastar.scan import LaserScan

OUT = Messages(make)


@given(st.floats(-math.pi + 1e-6, math.pi))
def test_headings(heading):
    assert incoming.yaw_of(rotation_of(make, heading)) == pytest.approx(heading, abs=1e-9)


def rotated(roll, pitch, yaw):
    """A quaternion of a roll about x, then a pitch about y, then a yaw about z, by products."""

    def about(axis, angle):
        w, v = math.cos(angle / 2), np.zeros(3)
        v[axis] = math.sin(angle / 2)
        return w, v

    w, v = about(2, yaw)
    for axis, angle in ((1, pitch), (0, roll)):
        other_w, other_v = about(axis, angle)
        w, v = w * other_w - v @ other_v, w * other_v + other_w * v + np.cross(v, other_v)
    return make("geometry_msgs/msg/Quaternion", x=v[0], y=v[1], z=v[2], w=w)


@given(st.floats(-3.1, 3.1), st.floats(-1.0, 1.0), st.floats(0.0, 5.0))
def test_poses_that_are_tilted_by_up_to_5_degrees_are_used_by_their_yaw(yaw, share, tilt):
    pitch = math.radians(tilt) * share
    roll = math.acos(min(math.cos(math.radians(tilt)) / math.cos(pitch), 1.0))
    assert incoming.yaw_of(rotated(roll, pitch, yaw)) == pytest.approx(yaw, abs=1e-7)


@pytest.mark.parametrize(
    ("roll", "pitch", "says"),
    [
        (5.2, 0.0, "odometry is tilted by 5.2 degrees: expected at most 5"),
        (4.0, -4.0, "odometry is tilted by 5.7 degrees"),
        (0.0, 90.0, "tilted by 90.0 degrees"),
        (180.0, 0.0, "tilted by 180.0 degrees"),
    ],
)
def test_poses_that_are_tilted_more_say_by_how_much(roll, pitch, says):
    pose = OUT.pose(Pose2D(1.0, 2.0, 0.0))
    pose.orientation = rotated(math.radians(roll), math.radians(pitch), 0.7)
    with pytest.raises(InputError, match=says):
        incoming.pose_of(pose, "the odometry")


@given(st.integers(0, 2**31 - 2), st.integers(0, 999_999_999))
def test_stamps(seconds, nanoseconds):
    back = incoming.seconds(OUT.stamp(seconds + 1e-9 * nanoseconds))
    assert back == pytest.approx(seconds + 1e-9 * nanoseconds, abs=1e-6)


def test_maps_and_scans():
    values = np.random.default_rng(0).integers(-1, 101, (7, 9)).astype(np.int8)
    message = OUT.grid(values, (0.05, 1.0, -2.0, 0.3), "map", 4.5)
    grid = incoming.grid_of(message, "map")
    assert np.array_equal(grid.values, values)
    assert grid.frame == pytest.approx(GridFrame(0.05, 1.0, -2.0, 0.3), abs=1e-7)
    scan = LaserScan(3.25, np.array([1.0, np.inf, np.nan]), -1.0, 0.5, 0.1, 8.0)
    message = as_read("sensor_msgs/msg/LaserScan", OUT.scan(scan, "laser"))
    back = incoming.scan_of(message, Mount(Pose2D(0.1, 0.0, 0.0)))
    np.testing.assert_array_equal(back.ranges, scan.ranges)
    assert (back.stamp, back.angle_min, back.mount.x) == (3.25, -1.0, 0.1)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda m: setattr(m.header, "frame_id", "odom"), "frame 'odom': expected 'map'"),
        (lambda m: setattr(m.info, "width", 4), "values: expected"),
        (lambda m: setattr(m.info, "width", 0), "expected 1 to"),
        (lambda m: setattr(m.info, "resolution", 0.0), "resolution"),
        (lambda m: setattr(m.info.origin.orientation, "x", 0.7), "quaternion|tilted"),
        (lambda m: setattr(m.info.origin.position, "x", math.nan), "finite"),
        (lambda m: setattr(m.info.origin.position, "y", -1e18), "expected within 1e\\+06 m"),
        (
            lambda m: setattr(m.info.origin, "orientation", rotated(0.0, 0.2, 1.0)),
            "origin is tilted by 11.5 degrees: expected at most 5",
        ),
    ],
)
def test_maps_that_are_none(change, says):
    message = OUT.grid(np.zeros((3, 3), np.int8), (0.05, 0.0, 0.0), "map", 0.0)
    change(message)
    with pytest.raises(InputError, match=says):
        incoming.grid_of(message, "map")


def test_a_goal_with_an_orientation_of_zeros_has_any_heading():
    goal = make("geometry_msgs/msg/PoseStamped", header=OUT.header("map", 0.0))
    goal.pose.position.x = 2.0
    assert incoming.goal_of(goal, "map") == Goal(2.0, 0.0, None)
    goal.pose = OUT.pose(Pose2D(2.0, 0.0, 0.5))
    assert incoming.goal_of(goal, "map").heading == pytest.approx(0.5)


def test_goals_that_are_none():
    goal = make("geometry_msgs/msg/PoseStamped", header=OUT.header("map", 0.0))
    goal.pose.orientation.w = 0.5
    with pytest.raises(InputError, match="unit quaternion"):
        incoming.goal_of(goal, "map")
    goal.pose = OUT.pose(Pose2D(1.0, math.inf, 0.0))
    with pytest.raises(InputError, match="finite"):
        incoming.goal_of(goal, "map")


def test_paths_head_for_their_next_point():
    message = OUT.path(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]), "map", 1.0)
    headings = [incoming.yaw_of(pose.pose.orientation) for pose in message.poses]
    assert headings == pytest.approx([0.0, math.pi / 2, math.pi / 2])


def test_a_message_that_is_no_twist_is_told():
    with pytest.raises(InputError, match="expected geometry_msgs/msg/Twist"):
        incoming.twist_of(make("std_msgs/msg/String", data="go"))
