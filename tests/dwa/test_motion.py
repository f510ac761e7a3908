import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar import robot
from dynastar.dwa.motion import coast, driven, moved, slew
from dynastar.robot import Limits

START = (0.3, -0.2, math.cos(0.7), math.sin(0.7))
rates = st.floats(0.1, 5.0)
limits_ = st.builds(
    Limits, st.just(2.0), st.just(2.0), rates, rates, rates, rates, v_min=st.just(-1.0)
)


def euler(pose, v, omega, duration, steps=20000):
    """Eq. 4 step by step: x += v cos(theta) h, y += v sin(theta) h, theta += omega h."""
    x, y, cos, sin = pose
    h = duration / steps
    theta = math.atan2(sin, cos) + omega * h * (np.arange(steps) + 0.5)
    end = math.atan2(sin, cos) + omega * duration
    return (
        x + v * h * np.cos(theta).sum(),
        y + v * h * np.sin(theta).sum(),
        math.cos(end),
        math.sin(end),
    )


@given(st.floats(-2, 2), st.floats(-4, 4), st.floats(0.0, 2.0))
@settings(deadline=None)
def test_an_arc_is_what_equation_4_adds_up_to(v, omega, duration):
    found = moved(START, v * duration, omega * duration)
    assert found == pytest.approx(euler(START, v, omega, duration), abs=1e-6)
    assert math.hypot(found[2], found[3]) == pytest.approx(1.0)


@given(st.floats(-2, 2), st.floats(-2, 2), rates, rates, st.floats(0.0, 2.0))
@settings(deadline=None)
def test_speeds_ramp_as_the_robots_do(current, wanted, accel, brake, duration):
    found = slew(current, wanted, accel, brake, duration)
    assert found == pytest.approx(robot.slew(current, wanted, accel, brake, duration), abs=1e-12)
    assert abs(found - current) <= max(accel, brake) * duration + 1e-9
    assert min(current, wanted) - 1e-9 <= found <= max(current, wanted) + 1e-9
    if abs(found) > abs(current) and found * current >= 0.0:
        assert abs(found) - abs(current) <= accel * duration + 1e-9


@given(limits_, *[st.floats(-1, 1)] * 4, st.floats(0.01, 0.2))
@settings(deadline=None)
def test_a_period_is_driven_at_the_mean_of_its_ends(limits, v, omega, to_v, to_omega, duration):
    after, v1, w1 = driven(START, v, omega, to_v, to_omega, limits, duration)
    assert v1 == slew(v, to_v, limits.v_accel, limits.v_brake, duration)
    assert w1 == slew(omega, to_omega, limits.omega_accel, limits.omega_brake, duration)
    mean = 0.5 * (v + v1), 0.5 * (omega + w1)
    assert after == pytest.approx(euler(START, *mean, duration), abs=1e-6)


@given(limits_, st.floats(-1, 1), st.floats(-1, 1), st.integers(0, 10**6))
@settings(deadline=None, max_examples=40)
def test_commands_under_way_take_the_robot_where_the_drive_does(limits, v, omega, seed):
    random = np.random.default_rng(seed)
    commands, durations = random.uniform(-1, 1, (3, 2)), random.uniform(0.0, 0.1, 3)
    x, y, theta, v1, w1 = coast((0.3, -0.2, 9.0), (v, omega), commands, durations, limits)
    at_x, at_y, turned = 0.3, -0.2, 9.0
    for command, duration in zip(commands, durations, strict=True):
        h = duration / 400
        for _ in range(400):
            before = v, omega
            v = robot.slew(v, command[0], limits.v_accel, limits.v_brake, h)
            omega = robot.slew(omega, command[1], limits.omega_accel, limits.omega_brake, h)
            middle = turned + 0.25 * (before[1] + omega) * h
            at_x += 0.5 * (before[0] + v) * h * math.cos(middle)
            at_y += 0.5 * (before[0] + v) * h * math.sin(middle)
            turned += 0.5 * (before[1] + omega) * h
    assert (v1, w1) == pytest.approx((v, omega), abs=1e-6)
    # A ramp that ends within a quarter of a command is driven at the mean of its ends.
    assert (x, y, theta) == pytest.approx((at_x, at_y, turned), abs=2e-3)
