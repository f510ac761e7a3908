"""A drive that is not perfect: gain, dead band, lag, slip, varying latency, and what odometry says."""

import math

import numpy as np
import pytest

from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.robot import Limits, Robot
from dynastar.simulation import Drivetrain, Odometry, Scenario, World

QUICK = Robot("quick", Limits(1.0, 1.0, 50.0, 50.0, 50.0, 50.0, v_min=-0.5), Footprint.disc(0.3))
SLOW = Robot("slow", Limits(1.0, 1.0, 0.5, 0.5, 0.5, 0.5), Footprint.disc(0.3))
START = Pose2D(20.0, 20.0, 0.0)
GRID = OccupancyGrid.from_occupied(np.zeros((80, 80), bool), 0.5)


def world(robot=QUICK, latency=0.0, odometry=Odometry(), seed=0, **drive):
    made = Drivetrain(**drive)
    scenario = Scenario(
        "test", GRID, robot, START, (Goal(1.0, 1.0),), drive=made, odometry=odometry,
        latency=latency,
    )  # fmt: skip
    return World(scenario, START, seed)


def driven(made, command, seconds, period=0.1):
    for _ in range(round(seconds / period)):
        made.step(Twist(*command), period)
    return made


def test_a_gain_scales_speeds_beyond_the_limits_too():
    made = driven(world(gain_v=1.2, gain_omega=0.8), (2.0, 1.0), 1.0)
    assert made.twist == pytest.approx((1.2, 0.8))
    assert made.pose.theta == pytest.approx(0.8, abs=0.02)


def test_commands_in_the_dead_band_do_not_move_the_drive():
    made = world(deadband_v=0.05, deadband_omega=0.1)
    assert driven(made, (0.049, -0.099), 1.0).pose == START
    assert driven(made, (0.05, -0.1), 0.2).twist == pytest.approx((0.05, -0.1))
    assert driven(made, (0.02, 0.3), 0.2).twist == pytest.approx((0.0, 0.3))


def test_with_a_lag_speeds_approach_the_command_exponentially():
    made = driven(world(lag=0.3), (0.8, 0.5), 0.3)
    left = 1.0 - math.exp(-1.0)
    assert made.twist == pytest.approx((0.8 * left, 0.5 * left))
    driven(made, (0.0, 0.0), 0.6)
    assert made.twist.v == pytest.approx(0.8 * left * math.exp(-2.0))
    assert not made.resting
    assert driven(made, (0.0, 0.0), 4.0).resting


def test_a_lag_does_not_lift_the_limits_of_acceleration():
    made = driven(world(SLOW, lag=0.1), (1.0, 0.0), 1.0)
    assert made.twist.v == pytest.approx(0.5)


def test_slip_takes_a_share_of_each_speed_anew_for_each_command_and_by_seed():
    made, same, other = (world(slip=0.2, seed=seed) for seed in (1, 1, 2))
    speeds = np.array([driven(made, (1.0, 1.0), 0.1).twist for _ in range(200)])
    assert (speeds[1:] > 0.8).all()
    assert (speeds[1:] < 1.0).all()
    assert speeds[1:].min() < 0.82
    assert speeds[1:].max() > 0.98
    assert abs(np.corrcoef(speeds[1:].T)[0, 1]) < 0.3
    np.testing.assert_array_equal(speeds, [driven(same, (1.0, 1.0), 0.1).twist for _ in range(200)])
    assert driven(other, (1.0, 1.0), 0.1).twist != tuple(speeds[0])


def test_the_latency_varies_between_its_bounds():
    delays = []
    for seed in range(200):
        made = world(latency=0.2, latency_jitter=0.15, seed=seed)
        while made.twist.v == 0.0:
            made.step(Twist(1.0, 0.0) if made.time == 0.0 else Twist(0.0, 0.0), 0.3)
            moved = made.pose.x - START.x
        delays.append(0.3 - moved)
        assert made.time == 0.3
    assert 0.05 <= min(delays) < 0.07
    assert 0.18 < max(delays) <= 0.2 + 0.02


def test_a_command_that_arrives_before_an_earlier_one_replaces_it():
    made = world(latency=0.5)
    made.step(Twist(1.0, 0.0), 0.1)
    made.drive.late = -0.3
    driven(made, (0.0, 0.0), 1.0)
    assert made.pose == START


def test_odometry_says_what_the_wheels_do_and_poses_are_right():
    made = world(odometry=Odometry(1.1, 0.9), gain_v=0.5, slip=0.5)
    driven(made, (1.0, 0.5), 1.0)
    state = made.sensed_state()
    assert state.twist == pytest.approx((1.1 * 0.5, 0.9 * 0.5))
    assert state.pose == made.pose
    assert made.twist.v < 0.5
