"""Lidars whose readings repeat: those that are frozen, and those that see the same everywhere."""

import math
from dataclasses import replace

import numpy as np
import pytest

from driving import ROUND, Drive, room, under_way, with_ranges
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.navigator.scan_feed import FIRST_WAIT, REPEATED, SILENT, ScanFeed
from dynastar.robot import Lidar
from dynastar.simulation.lidar import LidarSimulator

SHORT_SIGHTED = replace(ROUND, lidar=Lidar(360, math.tau, 0.1, 3.5))


def freeze(drive, seconds):
    """Drives on with the ranges of this scan and new stamps."""
    ranges = drive.scan().ranges
    for _ in range(round(10 * seconds)):
        drive.tick(with_ranges(drive.scan(), ranges))


def test_a_frozen_lidar_stops_the_robot_within_a_second_and_is_named():
    drive = under_way()
    v, brake = drive.twist.v, drive.robot.limits.v_brake
    freeze(drive, 0.6 + v / brake)
    assert drive.twist == (0.0, 0.0)
    assert (drive.status.state, drive.status.reason) == ("sensor_lost", REPEATED)


def test_scans_that_change_again_set_it_going_at_once():
    drive = under_way()
    freeze(drive, 2.5)
    assert drive.status.state == "sensor_lost"
    drive.tick()
    assert drive.status.state == "following"
    drive.until("arrived")


def test_a_frozen_lidar_is_tried_again_more_and_more_seldom_slowly_and_not_far():
    drive = under_way()
    ranges = drive.scan().ranges
    for _ in range(20):
        drive.tick(with_ranges(drive.scan(), ranges))
    at, fastest, moves, rested = drive.pose, 0.0, 0, 1.0
    for _ in range(600):
        drive.tick(with_ranges(drive.scan(), ranges))
        fastest, moving = max(fastest, abs(drive.twist.v)), drive.twist != (0.0, 0.0)
        moves += rested >= 1.0 and moving
        rested = 0.0 if moving else rested + 0.1
    assert 2 <= moves <= 1 + math.log2(60.0 / FIRST_WAIT)
    assert 0.0 < fastest < 0.11
    assert math.dist(at[:2], drive.pose[:2]) < 0.1 * moves


@pytest.mark.parametrize(
    ("v_least", "omega_least", "asked", "slow"),
    [
        (0.0, 0.0, (0.5, 0.2), (0.1, 0.04)),
        (0.1, 0.0, (0.38, 0.2), (0.1, 0.2 * 0.1 / 0.38)),
        (0.2, 0.0, (0.5, 0.1), (0.2, 0.04)),
        (0.0, 0.1, (0.3, 0.2), (0.15, 0.1)),
        (0.0, 0.1, (0.0, 1.0), (0.0, 0.3)),
        (0.1, 0.1, (0.1, 0.1), (0.1, 0.1)),
    ],
)
def test_what_is_tried_is_slow_and_a_speed_that_the_drive_follows(
    v_least, omega_least, asked, slow
):
    limits = ROUND.limits._replace(v_least=v_least, omega_least=omega_least, v_brake=0.5)
    drive = under_way(robot=replace(ROUND, limits=limits))
    drive.twist = Twist(0.0, 0.0)
    sensing = drive.navigator.sensing
    state = RobotState(drive.now, drive.pose, drive.twist)
    command = Twist(*asked)
    assert sensing.on_trial(state, command) == command
    for source in sensing.feed._sources.values():
        source.trouble = REPEATED
    tried = sensing.on_trial(state, command)
    assert tried == pytest.approx(slow)
    for speed, least in zip(tried, (v_least, omega_least), strict=True):
        assert speed == 0.0 or speed >= least
    assert sensing.on_trial(state, None) is None
    moving = state._replace(twist=Twist(0.19, 0.0))
    brake = sensing.robot.limits.v_brake  # less than declared, by the drive's error
    slower = max(tried.v, 0.19 - brake * sensing.poses.period)
    assert sensing.on_trial(moving, command).v == pytest.approx(min(slower, command.v))


def test_a_robot_whose_wheels_slipped_finds_out_that_its_lidar_is_not_frozen():
    """The odometry tells of 0.3 m that were not driven; scans without noise stay the same meanwhile."""
    drive = under_way()
    drive.twist = Twist(0.0, 0.0)
    slipped, seen = 0.0, drive.scan().ranges
    for _ in range(10):
        slipped += 0.03
        pose = drive.pose._replace(x=drive.pose.x + slipped)
        state = RobotState(drive.now, pose, Twist(0.3, 0.0))
        drive.navigator.command(state, with_ranges(drive.scan(), seen))
        drive.now += 0.1
    assert drive.status.reason == REPEATED
    drive.pose = drive.pose._replace(x=drive.pose.x + slipped)  # from here on all is told as it is
    held = True
    for _ in range(200):
        held = held and drive.twist == (0.0, 0.0)
        drive.tick(*([with_ranges(drive.scan(), seen)] if held else []))
        if drive.status.state == "arrived":
            break
    assert drive.status.state == "arrived"


def test_a_pose_that_is_corrected_while_the_robot_rests_tells_nothing_about_the_lidar():
    drive = under_way()
    ranges = drive.scan().ranges
    for k in range(60):
        pose = drive.pose._replace(x=drive.pose.x + 0.01 * k)
        state = RobotState(drive.now, pose, Twist(0.0, 0.0))
        drive.navigator.command(state, with_ranges(drive.scan(), ranges))
        drive.now += 0.1
        assert drive.status.state != "sensor_lost"


def test_a_pose_that_jumps_tells_nothing_about_the_lidar():
    drive = under_way()
    ranges = drive.scan().ranges
    drive.tick(with_ranges(drive.scan(), ranges))
    drive.pose = drive.pose._replace(y=drive.pose.y - 1.0)
    for _ in range(2):
        drive.tick(with_ranges(drive.scan(), ranges))
        assert drive.status.state != "sensor_lost"
        drive.twist = Twist(0.0, 0.0)


@pytest.mark.parametrize("nothing", [math.inf, 3.5])
def test_an_empty_hall_is_crossed(nothing):
    hall = OccupancyGrid(np.zeros((160, 240), np.int8), 0.1)
    drive = Drive(hall, SHORT_SIGHTED, (8.0, 8.0, 0.0))
    drive.navigator.set_goal(Goal(14.0, 9.0))
    while drive.status.state != "arrived":
        assert drive.now < 20.0
        scan = drive.scan()
        assert np.isinf(scan.ranges).all()
        drive.tick(with_ranges(scan, np.full(360, nothing)))
        assert drive.status.state != "sensor_lost"


@pytest.mark.parametrize("quantum", [0.001, 0.01])
def test_a_corridor_that_looks_the_same_everywhere_is_driven_along(quantum):
    drive = Drive(room(40.0, 2.0), SHORT_SIGHTED, (6.0, 1.0, 0.0))
    drive.navigator.set_goal(Goal(20.0, 1.0))
    repeats, last = 0, None
    while drive.status.state != "arrived":
        assert drive.now < 40.0
        scan = drive.scan()
        ranges = np.round(scan.ranges / quantum) * quantum
        repeats += last is not None and np.array_equal(ranges, last)
        last = ranges
        drive.tick(with_ranges(scan, ranges))
        assert drive.status.state != "sensor_lost"
        drive.pose, drive.twist = Pose2D(drive.pose.x, 1.0, 0.0), Twist(drive.twist.v, 0.0)
    assert repeats > 20


def test_of_two_lidars_the_one_that_is_frozen_is_named_while_the_other_sees():
    drive = Drive(room())
    other = LidarSimulator(Lidar(360, math.tau, 0.0, 6.0, x=0.1), room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    frozen = drive.scan().ranges
    reasons = set()
    for _ in range(40):
        scans = with_ranges(drive.scan(), frozen), other.scan(drive.pose, drive.now)
        drive.tick(*scans)
        assert drive.status.state != "sensor_lost"
        reasons.add(drive.status.reason)
    assert f"the path; {REPEATED}" in reasons
    assert drive.pose.x > 1.6


def test_a_lidar_that_was_frozen_and_is_silent_now_does_not_slow_the_robot():
    drive = Drive(room(40.0, 6.0))
    other = LidarSimulator(Lidar(360, math.tau, 0.0, 6.0, x=0.1), room(40.0, 6.0))
    drive.navigator.set_goal(Goal(38.0, 3.0))
    frozen = drive.scan().ranges
    for k in range(40):
        if k == 20:
            drive.twist = Twist(0.0, 0.0)
        drive.tick(with_ranges(drive.scan(), frozen), other.scan(drive.pose, drive.now))
    assert 0.05 < drive.twist.v < 0.11
    last = with_ranges(drive.scan(), frozen, stamp=drive.now - 0.1)
    for _ in range(round(10 * SILENT) + 20):
        drive.tick(last, other.scan(drive.pose, drive.now))
    assert drive.twist.v > 0.8
    assert drive.status.reason == "the path"


def test_a_lidar_whose_mount_is_never_the_same_leaves_nothing_behind():
    feed, scan = ScanFeed(ROUND, NavigatorConfig()), Drive(room()).scan()
    for k in range(200):
        now, mount = 0.1 * k, Pose2D(0.1 + 1e-6 * k, 0.0, 0.0)
        state = RobotState(now, Pose2D(1.5, 3.0, 0.0), Twist(0.0, 0.0))
        given = with_ranges(scan, scan.ranges, stamp=now, mount=mount)
        accepted, fault = feed.accept([given], state, lambda stamp: Pose2D(1.5, 3.0, 0.0))
        assert (len(accepted), fault) == (1, None)
    assert len(feed._sources) <= 10 * SILENT + 1


def test_a_scan_that_is_too_old_to_be_placed_is_not_used():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.now = 7.0
    old = with_ranges(drive.scan(), drive.scan().ranges, stamp=0.0)
    drive.tick(old)
    assert drive.status.reason == "the scan is 7.0 s older than the robot's state"
    assert not (drive.navigator.sensing.local_map.hit_at >= 0.0).any()


def test_readings_of_the_robot_itself_alone_are_no_scan():
    drive = under_way()
    for _ in range(20):
        drive.tick(with_ranges(drive.scan(), np.full(360, 0.2)))
    assert drive.status.state == "sensor_lost"
    assert "within the robot's own footprint" in drive.status.reason


def test_posts_in_view_are_named_and_hinder_nothing():
    robot = replace(ROUND, footprint=Footprint.disc(0.25))
    drive = Drive(room(), robot, (1.5, 2.0, 0.5))
    drive.navigator.set_goal(Goal(6.5, 4.0))
    reasons = set()
    while drive.status.state != "arrived":
        assert drive.now < 20.0
        ranges = np.array(drive.scan().ranges)
        for post in (40, 140, 220, 320):
            ranges[post : post + 3] = 0.2
        drive.tick(with_ranges(drive.scan(), ranges))
        reasons.add(drive.status.reason)
    assert "the path; 3 % of the lidar's readings lie within the robot's own footprint" in reasons
    assert drive.status.reason == "the goal is reached"


def test_a_state_of_the_mission_says_what_is_odd_about_the_readings():
    drive = Drive(room(20.0, 12.0), SHORT_SIGHTED, (2.0, 6.0, 0.0))
    drive.navigator.set_goal(Goal(15.0, 6.0))
    reasons = []
    for _ in range(60):
        scan = drive.scan()
        drive.tick(with_ranges(scan, np.where(np.isinf(scan.ranges), 0.0, scan.ranges)))
        reasons.append(drive.status.reason)
    assert "readings" not in reasons[0]
    assert reasons[-1].startswith("the path; ")
    assert "% of the lidar's readings are 0: if the driver writes that for no return" in reasons[-1]
    assert drive.pose.x < 3.0


def test_with_the_setting_the_same_is_driven():
    lidar = SHORT_SIGHTED.lidar._replace(nothing=(0.0,))
    drive = Drive(room(20.0, 12.0), replace(SHORT_SIGHTED, lidar=lidar), (2.0, 6.0, 0.0))
    drive.navigator.set_goal(Goal(15.0, 6.0))
    while drive.status.state != "arrived":
        assert drive.now < 40.0
        scan = drive.scan()
        drive.tick(with_ranges(scan, np.where(np.isinf(scan.ranges), 0.0, scan.ranges)))
        assert "readings" not in drive.status.reason
    assert drive.pose.x > 14.5


def test_infinity_without_a_declared_range_is_free_as_far_as_the_lidar_sees():
    drive = Drive(room(20.0, 12.0), SHORT_SIGHTED, Pose2D(8.0, 6.0, 0.0))
    drive.tick(with_ranges(drive.scan(), drive.scan().ranges, range_max=math.inf))
    local_map = drive.navigator.sensing.local_map
    rows, columns = np.nonzero(local_map.states == 1)
    a, (x0, y0) = local_map.resolution, local_map.origin
    far = np.hypot(x0 + (columns + 0.5) * a - 8.0, y0 + (rows + 0.5) * a - 6.0).max()
    assert 3.3 < far < 3.5
