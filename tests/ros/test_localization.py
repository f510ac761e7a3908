"""Where the robot is in the map, from odometry and a pose in the map."""

import math

import pytest

from dynastar.errors import InputError
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import arc
from dynastar.ros.localization import Localization


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


@pytest.mark.parametrize("late", [0.0, 0.04, 0.05, 0.08, 0.1, 0.13])
def test_a_pose_between_two_messages_of_odometry_is_joined_to_where_the_robot_was_then(late):
    """The true frames coincide: whatever the time of the pose, the correction is nothing."""
    found, twist = Localization("amcl"), Twist(0.5, 2.0)
    poses = [arc(Pose2D(0.0, 0.0, 0.0), twist, t) for t in (0.0, 0.1, late)]
    for stamp, pose in zip((1.0, 1.1), poses, strict=False):
        found.add_odometry(stamp, pose, twist)
    found.add_pose(1.0 + late, poses[2])
    assert found.map_to_odom == pytest.approx((0.0, 0.0, 0.0), abs=2e-3)


def test_a_pose_that_comes_before_the_odometry_is_kept_for_it():
    found = Localization("amcl")
    found.add_pose(0.5, Pose2D(5.0, 5.0, 0.0))
    assert found.at(1.0) is None
    found.add_odometry(1.0, Pose2D(1.0, 0.0, 0.0), Twist(0.0, 0.0))
    assert found.at(1.0).pose == pytest.approx((5.0, 5.0, 0.0))
    found.reset()
    found.add_odometry(0.1, Pose2D(2.0, 0.0, 0.0), Twist(0.0, 0.0))
    assert found.at(0.1).pose == pytest.approx((6.0, 5.0, 0.0))


def test_one_message_of_another_time_does_not_block_those_that_follow():
    found = Localization("odom")
    found.add_odometry(3600.0, Pose2D(9.0, 9.0, 0.0), Twist(0.0, 0.0))
    found.add_odometry(1.0, Pose2D(1.0, 0.0, 0.0), Twist(0.0, 0.0))
    assert found.at(1.0).pose == Pose2D(1.0, 0.0, 0.0)
