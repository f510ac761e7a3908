import math

import pytest

from driving import Drive, room
from dynastar.geometry import Twist
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.pose_history import PoseHistory
from dynastar.robot import ROBOTS


def under_way(**config):
    drive = Drive(room(), **config)
    drive.navigator.set_goal((6.5, 3.0))
    return drive


def test_a_robot_that_drives_as_told_has_no_hint():
    drive = under_way()
    for _ in range(80):
        command = drive.tick()
        assert ";" not in drive.status.reason
    assert command == Twist(0.0, 0.0)
    assert drive.status.state == "arrived"


def test_commands_that_move_nothing_are_named():
    drive = under_way()
    for _ in range(50):
        drive.navigator.command(drive.state, drive.scan())
        drive.now += 0.1
        if drive.now < 3.0:
            assert "moved nothing" not in drive.status.reason
    assert "commands have moved nothing for" in drive.status.reason
    assert "v_least" in drive.status.reason


def test_commands_that_come_late_are_named():
    drive = under_way()
    drive.for_seconds(0.5)
    assert "apart" not in drive.status.reason
    drive.now += 0.15
    drive.tick()
    assert "commands come 0.25 s apart, not 0.10 s" in drive.status.reason
    drive.for_seconds(2.5)
    assert "apart" not in drive.status.reason


def test_an_odometry_without_speed_is_named():
    drive = under_way()
    for _ in range(20):
        command = drive.navigator.command(drive.state._replace(twist=Twist(0.0, 0.0)), drive.scan())
        drive.carry_out(command)
    assert "the poses moved" in drive.status.reason
    assert "odometry" in drive.status.reason


@pytest.mark.parametrize("gap", [0.1, 0.105, 0.2, 0.7, 5.0])
def test_the_period_is_the_declared_one_or_the_longest_of_the_last_two_seconds(gap):
    drive = under_way()
    poses = PoseHistory(ROBOTS["paper"].limits, NavigatorConfig(period=0.1))
    assert poses.period == 0.1
    for stamp in (0.0, 0.1, 0.1 + gap):
        poses.add(drive.state._replace(stamp=stamp))
    assert poses.period == pytest.approx(0.1 if gap <= 0.11 or gap > 2.0 else min(gap, 1.0))
    for k in range(25):
        poses.add(drive.state._replace(stamp=0.1 + gap + 0.1 * (k + 1)))
    assert poses.period == 0.1
    assert math.isfinite(poses.travelled()[0])
