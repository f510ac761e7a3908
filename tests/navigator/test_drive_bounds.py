"""A drive within its declared bounds hits nothing, whatever a guard is asked for."""

import math

import numpy as np
import pytest

from driving import REST, driven
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Guard, NavigatorConfig, RobotState
from dynastar.navigator.braking import Commands
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.simulation.contact import Solids
from dynastar.simulation.lidar import LidarSimulator

STEP = 0.005  # s of the simulated drive


class Guarded:
    """A guard that nothing hides from, and a drive with a gain and a dead band for each speed."""

    def __init__(self, world, robot, pose, gain=(1.0, 1.0), things=(), **config):
        self.robot, self.gain, self.pose, self.twist = robot, gain, Pose2D(*pose), REST
        self.config = NavigatorConfig(hidden_speed=0.0, **config)
        self.guard, self.now = Guard(robot, self.config), 0.0
        self.lidar = LidarSimulator(robot.lidar, world, things)
        self.solids = Solids(world, things)
        self.least_gap = math.inf

    def tick(self, asked, blind=False):
        scan = None if blind else self.lidar.scan(self.pose, self.now)
        given = self.guard.filter(RobotState(self.now, self.pose, self.twist), scan, asked).command
        limits = self.robot.limits
        told = Twist(
            self.gain[0] * given.v if abs(given.v) >= limits.v_least else 0.0,
            self.gain[1] * given.omega if abs(given.omega) >= limits.omega_least else 0.0,
        )
        for _ in range(round(self.config.period / STEP)):
            self.pose, self.twist = driven(self.robot, self.pose, self.twist, told, STEP)
            self.least_gap = min(self.least_gap, self.solids.gap(self.pose, self.robot.footprint))
        self.now += self.config.period


def hall(width, height):
    """A hall of cells of 5 cm with a wall round it."""
    occupied = np.zeros((round(height / 0.05), round(width / 0.05)), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    return OccupancyGrid(occupied, GridFrame(0.05))


@pytest.mark.parametrize(("period", "away"), [(0.2, 0.5), (0.5, 0.95), (0.5, 1.2), (1.0, 1.95)])
def test_a_speed_that_is_reached_long_before_the_period_ends(period, away):
    robot = ROBOTS["jackal"]
    drive = Guarded(hall(12.0, 6.0), robot, (11.95 - 0.254 - away, 3.0, 0.0), period=period)
    for _ in range(round(4.0 / period)):
        drive.tick(Twist(2.0, 0.0))
    assert 0.0 < drive.least_gap < away


def circling(limits, v, omega, nearer, gain, blind_from):
    """Drives a circle beside a wall, that would cut it; the scans end after so many ticks."""
    robot = Robot("disc", limits, Footprint.disc(0.3), Lidar(360, math.tau, 0.0, 8.0))
    radius = v / omega
    start = (6.0 - radius, max(0.35 + radius - nearer, 1.0), -0.5 * math.pi)
    drive = Guarded(hall(14.0, 8.0), robot, start, gain)
    for k in range(100):
        drive.tick(Twist(v, omega), blind=k >= blind_from)
    return drive.least_gap


@pytest.mark.parametrize("blind_from", [24, 31, 1000])
@pytest.mark.parametrize("gain", [(1.05, 0.95), (0.95, 1.05), (1.0, 0.95), (1.05, 1.05)])
def test_each_speed_may_be_off_by_the_error_of_the_drive(gain, blind_from):
    limits = Limits(1.0, 0.8, 0.8, 1.5, 0.3, 1.0)
    assert circling(limits, 1.0, 0.32, 0.6, gain, blind_from) > 0.0


@pytest.mark.parametrize("blind_from", [24, 33, 42, 1000])
def test_a_drive_that_does_not_turn_slowly_leaves_the_arc_of_its_stop(blind_from):
    limits = Limits(1.0, 0.8, 0.8, 1.5, 0.4, 1.0, omega_least=0.3)
    assert circling(limits, 1.0, 0.32, 0.44, (1.0, 1.0), blind_from) > 0.0


def test_a_stop_begins_at_the_speeds_that_the_drive_has_reached():
    """A drive that follows no less than 0.66 rad/s, and comes to that in seconds."""
    limits = Limits(1.2, 2.2, 2.3, 0.23, 1.2, 0.2, v_min=-1.2, v_least=0.35, omega_least=0.66)
    commands, pose = Commands(limits, 0.2, 0.0), Pose2D(0.0, 0.0, 0.0)
    commands.send(RobotState(0.0, pose, Twist(0.0, -0.23)), Twist(0.404, -0.663))
    stopping, now, twist = 0.0, 0.2, Twist(0.404, -0.276)
    while twist.v > 0.0:
        command = commands.brake(RobotState(now, pose, twist))
        _, twist = driven(Robot("thin", limits, Footprint.disc(0.1)), pose, twist, command, 0.2)
        stopping, now = stopping + 0.2, now + 0.2
    assert stopping <= 0.322 / 0.2 + 0.2  # the time in which -0.276 - 0.23 * 0.2 rad/s end


@pytest.mark.parametrize("wide", [0.14, 0.3, 0.6])
@pytest.mark.parametrize("gap", [0.005, 0.015, 0.025])
def test_what_stands_right_before_the_bumper_is_not_a_part_of_the_robot(gap, wide):
    front = 3.0 + 0.254 + gap
    thing = np.array(
        [(front, y) for y in (3.0 - wide / 2, 3.0 + wide / 2)]
        + [(front + 0.3, y) for y in (3.0 + wide / 2, 3.0 - wide / 2)]
    )
    drive = Guarded(hall(8.0, 6.0), ROBOTS["jackal"], (3.0, 3.0, 0.0), things=[thing])
    for _ in range(30):
        drive.tick(Twist(0.5, 0.0))
    assert drive.least_gap > 0.9 * gap
