"""Where the robot was at a stamp, and states that cannot be."""

import pytest

from driving import REST, ROUND, under_way
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Guard, NavigatorConfig, RobotState, pose_history
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


@pytest.fixture
def clock(monkeypatch):
    """The machine's clock, set by hand."""
    now = [100.0]
    monkeypatch.setattr(pose_history, "monotonic", lambda: now[0])
    return now


def test_state_and_scan_that_freeze_together_brake_until_they_go_on(clock):
    drive = under_way()
    frozen = drive.state, drive.scan()
    for _ in range(30):
        clock[0] += 0.1
        command = drive.navigator.command(*frozen)
    assert command == REST
    assert drive.status.state == "sensor_lost"
    assert "state repeats" in drive.status.reason
    drive.twist = REST
    for _ in range(3):
        clock[0] += 0.1
        drive.tick()
    assert drive.status.state == "following"


def test_a_guard_brakes_too(clock):
    drive, guard = under_way(), Guard(ROUND)
    frozen = drive.state, drive.scan()
    for _ in range(30):
        clock[0] += 0.1
        guarded = guard.filter(*frozen, Twist(0.3, 0.0))
    assert guarded.command == REST
    assert "state repeats" in guarded.reason


@pytest.mark.parametrize(("wait", "calls"), [(0.005, 60), (60.0, 3)])
def test_many_calls_a_state_and_long_waits_are_no_fault(clock, wait, calls):
    """A loop that is faster than the odometry, and one that is held up, as by a debugger."""
    drive = under_way()
    for _ in range(4):
        for _ in range(calls):
            clock[0] += wait
            command = drive.navigator.command(drive.state, drive.scan())
            assert drive.status.state == "following"
        drive.carry_out(command)
