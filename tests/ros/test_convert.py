"""Messages and types: what goes in comes out, and what is none is refused with the reason."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from hypothesis import given
from hypothesis import strategies as st

from dynastar.errors import InputError
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame
from dynastar.ros import convert
from dynastar.ros.localization import Localization
from dynastar.scan import LaserScan


@given(st.floats(-math.pi + 1e-6, math.pi))
def test_headings(heading):
    assert convert.yaw_of(convert.rotation_of(heading)) == pytest.approx(heading, abs=1e-9)


@given(st.integers(0, 2**31 - 2), st.integers(0, 999_999_999))
def test_stamps(seconds, nanoseconds):
    back = convert.seconds(convert.stamp_of(seconds + 1e-9 * nanoseconds))
    assert back == pytest.approx(seconds + 1e-9 * nanoseconds, abs=1e-6)


def test_maps_and_scans():
    values = np.random.default_rng(0).integers(-1, 101, (7, 9)).astype(np.int8)
    message = convert.grid_message(values, (0.05, 1.0, -2.0, 0.3), "map", 4.5)
    grid = convert.grid_of(message, "map")
    assert np.array_equal(grid.values, values)
    assert grid.frame == pytest.approx(GridFrame(0.05, 1.0, -2.0, 0.3), abs=1e-7)
    scan = LaserScan(3.25, np.array([1.0, np.inf, np.nan]), -1.0, 0.5, 0.1, 8.0)
    back = convert.scan_of(convert.scan_message(scan, "laser"), Pose2D(0.1, 0.0, 0.0))
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
    ],
)
def test_maps_that_are_none(change, says):
    message = convert.grid_message(np.zeros((3, 3), np.int8), (0.05, 0.0, 0.0), "map", 0.0)
    change(message)
    with pytest.raises(InputError, match=says):
        convert.grid_of(message, "map")


def test_goals_that_are_none():
    goal = PoseStamped()
    goal.header.frame_id = "map"
    goal.pose.orientation.w = 0.0
    with pytest.raises(InputError, match="unit quaternion"):
        convert.goal_of(goal, "map")
    goal.pose.orientation.w, goal.pose.position.y = 1.0, math.inf
    with pytest.raises(InputError, match="finite"):
        convert.goal_of(goal, "map")


def test_paths_head_for_their_next_point():
    message = convert.path_message(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]), "map", 1.0)
    headings = [convert.yaw_of(pose.pose.orientation) for pose in message.poses]
    assert headings == pytest.approx([0.0, math.pi / 2, math.pi / 2])


def test_odometry_is_corrected_by_a_pose_in_the_map():
    found = Localization("amcl")
    assert found.at(0.0) is None
    found.add_odometry(1.0, Pose2D(1.0, 0.0, 0.0), Twist(0.5, 0.0))
    assert found.at(1.0) is None
    found.add_pose(1.0, Pose2D(5.0, 5.0, math.pi / 2))
    state = found.at(1.2)
    assert state.pose == pytest.approx((5.0, 5.1, math.pi / 2))
    found.add_odometry(0.5, Pose2D(9.0, 9.0, 0.0), Twist(0.0, 0.0))  # late: left out
    assert found.stamp == 1.0
    with pytest.raises(InputError, match="finite"):
        found.add_odometry(2.0, Pose2D(math.nan, 0.0, 0.0), Twist(0.0, 0.0))
