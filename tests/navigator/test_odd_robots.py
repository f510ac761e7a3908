"""Robots that are slow, turn slowly, or have their axle at the end of a long body."""

import math

import numpy as np
import pytest

from driving import Drive, room
from dynastar.footprint import Footprint, box
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.perception import LocalMapConfig
from dynastar.robot import ROBOTS, Lidar, Limits, Robot

LIMITS = Limits(1.0, 1.2, 0.8, 2.0, 1.0, 2.0, v_min=-0.3)
FAR = Lidar(720, math.tau, 0.0, 12.0)


def gap_and_door(gap):
    """A wall across with a ``gap`` (m) straight ahead, and a wide door to one side."""
    low = 3.0 - 0.1 * (round(10.0 * gap) // 2)
    return room(12.0, 11.0, (6.0, 0.0, 6.3, low), (6.0, low + gap, 6.3, 8.0))


def arrives(world, robot, start, goal, seconds, **config):
    """A drive that has arrived within so many seconds."""
    drive = Drive(world, robot, start, **config)
    drive.navigator.set_goal(Goal(*goal))
    drive.until("arrived", "blocked", seconds=seconds)
    assert drive.status.state == "arrived", (drive.status.reason, drive.pose)
    return drive


@pytest.mark.parametrize("robot", [ROBOTS["jackal"], Robot("cart", LIMITS, box(1.0, 0.6), FAR)])
@pytest.mark.parametrize("more", [0.07, 0.1, 0.17])
def test_a_gap_that_the_path_goes_round_does_not_draw_the_robot(robot, more):
    width = 0.1 * math.ceil(10.0 * (2.0 * robot.footprint.half_width + more) - 1e-9)
    arrives(gap_and_door(width), robot, (3.0, 3.0, 0.0), (9.0, 3.0), 60.0, hidden_speed=0.0)


@pytest.mark.parametrize("behind", [0.05, 0.1])
@pytest.mark.parametrize("gap", [0.4, 0.5])
def test_a_way_narrower_than_the_body_is_none_though_the_axle_is_at_its_end(behind, gap):
    body = Footprint.polygon([(-behind, -0.3), (0.9, -0.3), (0.9, 0.3), (-behind, 0.3)])
    assert body.inscribed == pytest.approx(behind)
    assert body.half_gap == pytest.approx(0.3)
    drive = arrives(
        gap_and_door(gap), Robot("rear axle", LIMITS, body, FAR), (3.0, 3.0, 0.0), (9.0, 3.0), 60.0
    )
    assert drive.status.replans == 0


def test_the_weakest_brakes_that_may_be_declared_are_driven_with():
    """They are told to brake more gently than that by ``drive_error``."""
    limits = Limits(0.05, 0.5, 0.05, 0.5, 0.01, 0.01)
    arrives(
        room(4.0, 4.0), Robot("weak", limits, Footprint.disc(0.2), FAR), (1, 2, 0), (2, 2), 120.0
    )


@pytest.mark.parametrize("omega_max", [0.1, 0.2])
def test_a_robot_that_turns_slowly_turns_round(omega_max):
    robot = Robot("slow", Limits(0.5, omega_max, 0.5, 0.5, 0.5, 0.5), Footprint.disc(0.3), FAR)
    corridor = room(12.0, 10.0, (0.0, 0.0, 12.0, 4.3), (0.0, 5.7, 12.0, 10.0))
    drive = arrives(corridor, robot, (8.0, 5.0, 0.0), (3.0, 5.0), 80.0)
    assert drive.status.recoveries == 0


@pytest.mark.parametrize("v_max", [0.015, 0.03])
def test_a_slow_robot_is_not_stuck(v_max):
    robot = Robot("slow", Limits(v_max, 0.5, 0.1, 1.0, 0.1, 1.0), Footprint.disc(0.25), FAR)
    drive = arrives(room(), robot, (3.0, 3.0, 0.0), (3.5, 3.0), 60.0)
    assert drive.status.recoveries == 0


@pytest.mark.parametrize("accel", [2.0, 25.0])
@pytest.mark.parametrize("least", [0.12, 0.3, 1.0])
def test_a_drive_that_does_not_turn_slowly_comes_to_the_goals_heading(least, accel):
    limits = Limits(0.5, 1.5, 0.8, accel, 0.8, accel, omega_least=least)
    drive = arrives(
        room(),
        Robot("sticky", limits, Footprint.disc(0.25), FAR),
        (3.0, 3.0, 0.0),
        (5.0, 3.0, 2.0),
        30.0,
    )
    assert abs(math.remainder(drive.pose.theta - 2.0, math.tau)) <= 0.1


def test_a_speed_limit_is_kept_from_its_first_metre_however_long_the_stop():
    grid = room(40.0, 6.0)
    limit = np.full(grid.values.shape, np.inf, np.float32)
    limit[:, 250:] = 0.3
    grid = OccupancyGrid(grid.values, grid.frame, None, limit)
    robot = Robot("paper", ROBOTS["paper"].limits, Footprint.disc(0.3), Lidar(720, range_max=30.0))
    drive = Drive(grid, robot, (2.0, 3.0, 0.0), local_map=LocalMapConfig(size=20.0))
    drive.navigator.set_goal(Goal(38.0, 3.0))
    fastest = 0.0
    while drive.pose.x < 26.0:
        fastest = max(fastest, drive.twist.v)
        drive.tick()
        assert drive.pose.x < 25.0 or drive.twist.v <= 0.3 + 1e-6
        assert drive.now < 60.0
    assert fastest > 1.2


@pytest.mark.parametrize("seed", range(3))
def test_a_robot_with_strong_brakes_drives_the_last_decimetres(seed):
    random = np.random.default_rng(seed)
    for _ in range(35):
        x, y = random.uniform(2.5, 3.5, 2)
        theta, bearing = random.uniform(-math.pi, math.pi, 2)
        left = random.uniform(0.26, 0.6)
        goal = x + left * math.cos(bearing), y + left * math.sin(bearing)
        arrives(room(), ROBOTS["jackal"], (x, y, theta), goal, 6.0)
