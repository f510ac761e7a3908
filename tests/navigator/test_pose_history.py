"""Where the robot was at a stamp, and states that cannot be."""

import pytest

from driving import REST, ROUND, Drive, room, under_way
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Guard, NavigatorConfig, RobotState
from dynastar.navigator.pose_history import KEPT_FOR, LONGEST_CARRIED, PoseHistory
from dynastar.robot import arc

CONFIG = NavigatorConfig()
ORIGIN = Pose2D(0.0, 0.0, 0.0)


def history(*states):
    made = PoseHistory(ROUND.limits, CONFIG)
    for state in states:
        made.add(state)
    return made


def test_between_states_the_pose_is_interpolated_and_after_the_last_carried_on():
    twist = Twist(0.8, 1.0)
    after = arc(ORIGIN, twist, 0.1)
    known = history(RobotState(1.0, ORIGIN, twist), RobotState(1.1, after, twist))
    for stamp in (1.03, 1.1, 1.149, 1.3):
        truth = arc(ORIGIN, twist, stamp - 1.0)
        assert known.pose_at(stamp) == pytest.approx(truth, abs=1e-3)
    longest = arc(after, twist, LONGEST_CARRIED)
    assert known.pose_at(9.0) == pytest.approx(longest)


def test_before_the_first_state_a_robot_at_rest_was_there_until_states_are_dropped():
    assert history(RobotState(1.0, ORIGIN, REST)).pose_at(0.5) == ORIGIN
    assert history(RobotState(1.0, ORIGIN, Twist(0.5, 0.0))).pose_at(0.5) is None
    later = 1.0 + KEPT_FOR + 0.5
    known = history(
        RobotState(1.0, ORIGIN, REST), RobotState(later, Pose2D(0.9, 0.0, 0.0), Twist(0.5, 0.0))
    )
    assert known.pose_at(later - 0.1) is None


@pytest.mark.parametrize("calls", [1, 7])
def test_state_and_scan_that_freeze_together_brake_until_they_go_on(calls):
    """Though the loop was faster than the odometry before."""
    drive = under_way()
    for _ in range(25):
        for _ in range(calls - 1):
            drive.navigator.command(drive.state, drive.scan())
        drive.tick()
    frozen, said = (drive.state, drive.scan()), []
    for _ in range(30 * calls):
        command = drive.navigator.command(*frozen)
        said.append(drive.status.state)
    assert said[: 2 * calls] == ["following"] * (2 * calls)
    assert said[4 * calls :] == ["sensor_lost"] * (26 * calls)
    assert command == REST
    assert "state repeats" in drive.status.reason
    drive.twist = REST
    drive.tick()
    drive.tick()
    assert drive.status.state == "following"


def test_a_guard_brakes_too():
    drive, guard = under_way(), Guard(ROUND)
    for _ in range(30):
        guarded = guard.filter(drive.state, drive.scan(), Twist(0.3, 0.0))
    assert guarded.command == REST
    assert "state repeats" in guarded.reason


def test_a_loop_that_is_much_faster_than_the_odometry_drives():
    drive = Drive(room())
    drive.navigator.set_goal((6.5, 3.0))
    for state in range(30):
        for _ in range(60):
            command = drive.navigator.command(drive.state, drive.scan())
            assert state == 0 or drive.status.state == "following"
        drive.carry_out(command)
    assert drive.twist.v > 0.4
