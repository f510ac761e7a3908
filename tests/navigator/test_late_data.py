"""Scans that are late, of several lidars or of no use; late calls; clocks and poses that jump."""

import math
from dataclasses import replace

import numpy as np
import pytest

from driving import LIMITS, REST, ROUND, driven, room, with_ranges
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Guard, NavigatorConfig, RobotState
from dynastar.robot import Lidar, Robot, stopping_time
from dynastar.simulation.lidar import LidarSimulator

START = Pose2D(1.5, 3.0, 0.0)
BOX = (1.9, 2.8, 2.4, 3.2)  # 0.15 m ahead of a robot of 0.25 m radius at the start
BLIND = replace(ROUND, lidar=Lidar(360, math.tau, 0.1, 6.0))  # within 0.1 m of its lidar
CART = Robot(
    "cart",
    LIMITS,
    Footprint.polygon([(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)]),
    Lidar(360, math.radians(270.0), 0.05, 8.0, x=0.2),
)


class Late:
    """A guarded robot that does exactly as told in a true room, and whose scans come ``age`` s late.

    ``every`` s there is a new one. ``offset`` is added to the stamps, and ``moved`` to the poses that the
    guard is told.
    """

    def __init__(self, true, robot=ROUND, age=0.0, every=0.1, pose=START, **config):
        self.guard = Guard(robot, NavigatorConfig(**{"hidden_speed": 0.0, **config}))
        self.robot, self.true, self.pose, self.twist = robot, true, pose, REST
        self.age, self.every, self.now, self.taken = age, every, 100.0, []
        self.offset, self.moved = 0.0, (0.0, 0.0)

    def scan(self):
        return LidarSimulator(self.robot.lidar, self.true).scan(self.pose, self.now)

    def tick(self, command, lasts=None):
        if not self.taken or self.now - self.taken[-1].stamp > self.every - 1e-6:
            self.taken.append(self.scan())
        come = [one for one in self.taken if one.stamp <= self.now - self.age + 1e-9]
        scan = (
            with_ranges(come[-1], come[-1].ranges, stamp=come[-1].stamp + self.offset)
            if come
            else None
        )
        told = self.pose._replace(x=self.pose.x + self.moved[0], y=self.pose.y + self.moved[1])
        state = RobotState(self.now + self.offset, told, self.twist)
        given = self.guard.filter(state, scan, command)
        self.carry_out(given.command, self.guard.config.period if lasts is None else lasts)
        return given

    def carry_out(self, command, lasts, parts=10):
        for _ in range(parts):
            self.pose, self.twist = driven(
                self.robot, self.pose, self.twist, command, lasts / parts
            )
            assert not self.touches(), (self.now, self.pose, self.twist)
        self.now += lasts

    def touches(self):
        """Whether some point of the footprint's outline is in an occupied cell."""
        angles = np.linspace(0.0, math.tau, 90)
        radius = self.robot.footprint.circumscribed
        outline = radius * np.column_stack([np.cos(angles), np.sin(angles)])
        if not self.robot.footprint.is_disc:
            corners = self.robot.footprint.vertices
            parts = np.linspace(0.0, 1.0, 25)[:, None]
            outline = np.vstack(
                [a + parts * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]
            )
        c, s = math.cos(self.pose.theta), math.sin(self.pose.theta)
        x, y = self.pose.x + outline @ (c, -s), self.pose.y + outline @ (s, c)
        cells = np.floor(np.column_stack([y, x]) / self.true.resolution).astype(int)
        return bool(self.true.occupied[cells[:, 0], cells[:, 1]].any())

    def drive(self, command, seconds):
        return [self.tick(command) for _ in range(round(seconds / self.guard.config.period))]


@pytest.mark.parametrize(
    ("age", "period"), [(0.0, 0.1), (0.12, 0.1), (0.2, 0.1), (0.03, 0.02), (0.1, 0.02)]
)
def test_what_is_put_down_beside_a_robot_at_rest_is_not_hit_however_late_the_scans_are(age, period):
    drive = Late(room(), BLIND, age=age, period=period)
    drive.drive(Twist(0.0, 0.0), 1.0)
    drive.true = room(8.0, 6.0, BOX)
    drive.drive(Twist(0.0, 0.0), 1.0)
    drive.drive(Twist(0.3, 0.0), 3.0)
    assert drive.twist == pytest.approx(REST)


@pytest.mark.parametrize("named", [True, False])
def test_what_one_lidar_sees_is_not_cleared_by_another_that_looks_over_it(named):
    """They take turns; the box is low."""
    drive = Late(room(8.0, 6.0, (4.0, 2.0, 5.0, 4.0)))
    high = LidarSimulator(ROUND.lidar._replace(x=0.0 if named else 0.05), room())
    names = ("low", "high") if named else ("", "")
    for k in range(160):
        scan = high.scan(drive.pose, drive.now) if k % 2 else drive.scan()
        state = RobotState(drive.now, drive.pose, drive.twist)
        given = drive.guard.filter(state, replace(scan, frame=names[k % 2]), Twist(0.5, 0.0))
        drive.carry_out(given.command, 0.1)
    assert 3.4 < drive.pose.x < 3.75


def test_what_a_lidar_saw_is_cleared_when_it_sees_the_place_free():
    drive = Late(room(8.0, 6.0, (4.0, 2.0, 5.0, 4.0)))
    drive.drive(Twist(0.5, 0.0), 8.0)
    assert drive.twist == pytest.approx(REST)
    drive.true = room()
    drive.drive(Twist(0.5, 0.0), 4.0)
    assert drive.pose.x > 4.5


@pytest.mark.parametrize("moved", [(0.0, 0.3), (0.4, 0.0), (-0.4, 0.0)])
@pytest.mark.parametrize("age", [0.0, 0.1, 0.2])
def test_a_scan_from_before_the_pose_jumped_is_not_used(moved, age):
    """A robot drives at a wall, and its pose is corrected at some place before that."""
    for place in np.linspace(10.2, 11.1, 4):
        drive = Late(room(12.0, 6.0), age=age, pose=Pose2D(8.5, 3.0, 0.0))
        for _ in range(60):
            drive.moved = moved if drive.pose.x > place else (0.0, 0.0)
            drive.tick(Twist(1.0, 0.0))
        assert drive.pose.x > 11.2


@pytest.mark.parametrize("lasts", [0.02, 0.1, 0.35])
@pytest.mark.parametrize("command", [Twist(0.8, 0.0), Twist(0.6, 0.9)])
def test_a_stop_takes_its_time_however_often_it_is_called(lasts, command):
    drive = Late(room(12.0, 6.0), pose=Pose2D(3.0, 3.0, 0.0))
    drive.drive(command, 1.5)
    fast, since, places = drive.twist, drive.now, [drive.pose]
    drive.age = math.inf
    while drive.twist != REST:
        drive.tick(command, lasts)
        places.append(drive.pose)
        assert drive.now < since + 10.0
    age = drive.guard.config.scan_age
    assert drive.now - since <= age + stopping_time(fast, drive.robot.limits) + 2.5 * lasts + 0.1


def test_a_clock_that_was_set_back_opens_no_space_that_was_not_seen():
    """A wall's end beside the rear of a cart, where its lidar cannot see it."""
    drive = Late(room(8.0, 6.0, (2.0, 3.3, 2.7, 4.0)), CART)
    for _ in range(100):
        drive.tick(Twist(min(0.3, 2.0 * max(0.0, 2.75 - drive.pose.x)), 0.0))
    drive.offset = -50.0
    drive.drive(None, 2.5)
    drive.drive(Twist(0.0, -0.5), 2.0)


@pytest.mark.parametrize("age", [0.0, 0.14, 0.25])
@pytest.mark.parametrize("hidden_speed", [0.0, 1.5])
def test_a_hall_is_driven_through_with_scans_that_are_late_but_not_too_old(age, hidden_speed):
    drive = Late(room(12.0, 6.0), age=age, hidden_speed=hidden_speed, scan_age=0.4)
    drive.drive(Twist(0.6, 0.0), 6.0)
    assert drive.pose.x > 4.0


@pytest.mark.parametrize("reading", [math.nan, 0.0, -1.0, 0.02])
def test_a_lidar_that_is_covered_stops_the_robot(reading):
    robot = replace(ROUND, lidar=Lidar(360, math.tau, 0.05, 6.0))
    drive = Late(room(), robot)
    drive.drive(Twist(0.5, 0.0), 1.5)
    began, drive.scan = (
        drive.pose.x,
        lambda: with_ranges(
            LidarSimulator(robot.lidar, drive.true).scan(drive.pose, drive.now),
            np.full(360, reading),
        ),
    )
    found = drive.drive(Twist(0.5, 0.0), 2.0)
    assert drive.twist == pytest.approx(REST)
    assert "no valid range" in found[-1].reason
    assert drive.pose.x < began + 0.5 * (0.3 + 0.2) + 0.25


def test_a_lidar_that_sees_only_what_is_too_near_is_backed_off_with_slowly_and_not_far():
    limits = LIMITS._replace(v_min=-0.2)
    robot = replace(ROUND, limits=limits, lidar=Lidar(360, math.tau, 0.15, 6.0))
    drive = Late(room(), robot)
    drive.drive(Twist(0.3, 0.0), 5.0)
    drive.drive(Twist(0.0, 0.0), 1.0)
    began, seen = drive.pose.x, drive.scan
    drive.scan = lambda: with_ranges(seen(), np.full(360, 0.1))
    found = [(drive.tick(Twist(-0.2, 0.0)).reason, drive.twist.v) for _ in range(300)]
    assert "nearer than its range_min" in found[-1][0]
    assert min(v for _, v in found[10:]) >= -0.1 - 1e-9
    assert began - 0.4 < drive.pose.x < began - 0.1
