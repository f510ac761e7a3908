import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar import robot
from dynastar.dwa.motion import (
    STOP_START,
    Pose,
    State,
    coast,
    driveable,
    driveable_sample,
    driven,
    moved,
    slew,
    state_at,
    state_of,
    stopping_time,
)
from dynastar.geometry import Twist
from dynastar.robot import Limits
from naive import mean_speed

START = Pose(0.3, -0.2, math.cos(0.7), math.sin(0.7))
NO_LEAST = {"v_least": st.just(0.0), "omega_least": st.just(0.0)}
rates = st.floats(0.1, 5.0)
limits_ = st.builds(
    Limits, st.just(2.0), st.just(2.0), rates, rates, rates, rates, v_min=st.just(-1.0), **NO_LEAST
)


def euler(pose, v, omega, duration, steps=20000):
    """Eq. 4 step by step: x += v cos(theta) h, y += v sin(theta) h, theta += omega h."""
    h = duration / steps
    theta = math.atan2(pose.sin, pose.cos) + omega * h * (np.arange(steps) + 0.5)
    end = math.atan2(pose.sin, pose.cos) + omega * duration
    return (
        pose.x + v * h * np.cos(theta).sum(),
        pose.y + v * h * np.sin(theta).sum(),
        math.cos(end),
        math.sin(end),
    )


@given(st.floats(-2, 2), st.floats(-4, 4), st.floats(0.0, 2.0))
@settings(deadline=None)
def test_an_arc_is_what_equation_4_adds_up_to(v, omega, duration):
    found = moved(START, v * duration, omega * duration)
    assert found == pytest.approx(euler(START, v, omega, duration), abs=1e-6)
    assert math.hypot(found.cos, found.sin) == pytest.approx(1.0)


@given(st.floats(-2, 2), st.floats(-2, 2), rates, rates, st.floats(0.0, 2.0))
@settings(deadline=None)
def test_speeds_ramp_as_the_robots_do(current, wanted, accel, brake, duration):
    found = slew(current, wanted, accel, brake, duration)
    assert found == pytest.approx(robot.slew(current, wanted, accel, brake, duration), abs=1e-12)
    assert abs(found - current) <= max(accel, brake) * duration + 1e-9
    assert min(current, wanted) - 1e-9 <= found <= max(current, wanted) + 1e-9
    if abs(found) > abs(current) and found * current >= 0.0:
        assert abs(found) - abs(current) <= accel * duration + 1e-9


@given(limits_, st.floats(-1, 1), st.floats(-1, 1))
@settings(deadline=None)
def test_a_stop_takes_as_long_as_the_robots(limits, v, omega):
    assert stopping_time(v, omega, limits) == robot.stopping_time(Twist(v, omega), limits)


@given(limits_, *[st.floats(-1, 1)] * 4, st.floats(0.01, 1.0))
@settings(deadline=None)
def test_a_period_is_driven_at_the_mean_of_its_speeds(limits, v, omega, to_v, to_omega, duration):
    after = driven(State(START, v, omega), to_v, to_omega, limits, duration)
    assert after.v == slew(v, to_v, limits.v_accel, limits.v_brake, duration)
    assert after.omega == slew(omega, to_omega, limits.omega_accel, limits.omega_brake, duration)
    mean = (
        mean_speed(v, to_v, limits.v_accel, limits.v_brake, duration),
        mean_speed(omega, to_omega, limits.omega_accel, limits.omega_brake, duration),
    )
    assert after.pose == pytest.approx(euler(START, *mean, duration), abs=1e-6)


@given(limits_, st.floats(-1, 1), st.floats(-1, 1), st.integers(0, 10**6))
@settings(deadline=None, max_examples=40)
def test_commands_under_way_take_the_robot_where_the_drive_does(limits, v, omega, seed):
    random = np.random.default_rng(seed)
    commands, durations = random.uniform(-1, 1, (3, 2)), random.uniform(0.0, 0.1, 3)
    theta = 9.0
    after, turned = coast(state_at(0.3, -0.2, theta, v, omega), commands, durations, limits)
    x, y = 0.3, -0.2
    for command, duration in zip(commands, durations, strict=True):
        h = duration / 400
        for _ in range(400):
            before = v, omega
            v = robot.slew(v, command[0], limits.v_accel, limits.v_brake, h)
            omega = robot.slew(omega, command[1], limits.omega_accel, limits.omega_brake, h)
            middle = theta + 0.25 * (before[1] + omega) * h
            x += 0.5 * (before[0] + v) * h * math.cos(middle)
            y += 0.5 * (before[0] + v) * h * math.sin(middle)
            theta += 0.5 * (before[1] + omega) * h
    assert (after.v, after.omega) == pytest.approx((v, omega), abs=1e-6)
    assert turned == pytest.approx(theta - 9.0, abs=1e-6)
    assert (after.pose.x, after.pose.y) == pytest.approx((x, y), abs=2e-3)  # parts taken as arcs
    assert (after.pose.cos, after.pose.sin) == pytest.approx(
        (math.cos(9.0 + turned), math.sin(9.0 + turned))
    )


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.0, 0.5))
def test_a_drive_follows_no_command_below_its_least_speed(command, wanted, least):
    found = driveable(command, wanted, least)
    assert found == 0.0 or abs(found) >= least
    if abs(command) >= least:
        assert found == command
    elif abs(wanted) >= least:
        assert found * wanted >= 0.0
        assert abs(found) == least
    else:
        assert found == 0.0


@given(st.floats(-2.0, 2.0), st.floats(0.0, 0.5), st.floats(-2.0, 0.0), st.floats(0.0, 2.0))
def test_a_sample_is_raised_to_the_least_speed_only_within_the_limits(speed, least, low, high):
    speed = min(max(speed, low), high)
    found = driveable_sample(speed, least, low, high)
    assert low <= found <= high
    assert found == 0.0 or abs(found) >= least
    assert found in (speed, 0.0) or (abs(found) == least and found * speed > 0.0)


def test_a_state_comes_back_from_its_record():
    state = state_at(1.0, 2.0, 0.5, 0.3, -0.2)
    record = np.array([(*state.pose, state.v, state.omega, 0.1)], STOP_START)
    assert state_of(record[0]) == state
