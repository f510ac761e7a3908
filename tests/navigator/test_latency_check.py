"""A drive with a latency, driven by commands that are within its limits."""

import numpy as np
import pytest

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator.latency_check import LatencyCheck
from dynastar.navigator.status import RobotState
from dynastar.robot import ROBOTS, slew

HERE = Pose2D(0.0, 0.0, 0.0)
REST = Twist(0.0, 0.0)
STEPS = 20  # of the drive to a period


def told(true, declared, *, name="jackal", gain=1.0, lag=0.0, noise=0.0, changes=0.15, calls=1):
    """The latencies that are told, of random commands for 15 s; ``changes`` a share of the ticks."""
    period = 0.1
    limits, random = ROBOTS[name].limits, np.random.default_rng(3)
    check, sent, found = LatencyCheck(limits, declared), [], []
    wanted, command = REST, REST
    reached, driven = REST, np.zeros(2)
    h = period / STEPS
    for k in range(round(15.0 / period)):
        if random.random() < changes:
            wanted = Twist(random.uniform(0.0, limits.v_max), random.uniform(-1.0, 1.0))
        command = slewed(command, wanted, limits, period)
        now = k * period
        read = driven + random.uniform(-noise, noise, 2)
        for _ in range(calls):
            check.note(RobotState(now, HERE, Twist(*read)), command)
        sent.append((now, command))
        found.append(check.longer)
        for i in range(STEPS):
            acting = [twist for t, twist in sent if t <= now + (i + 1) * h - true + 1e-9]
            reached = slewed(reached, acting[-1] if acting else REST, limits, h)
            driven += (np.multiply(reached, gain) - driven) * (h / max(lag, h))
    return [latency for latency in found if latency is not None]


def slewed(now, wanted, limits, dt):
    return Twist(
        slew(now.v, wanted.v, limits.v_accel, limits.v_brake, dt),
        slew(now.omega, wanted.omega, limits.omega_accel, limits.omega_brake, dt),
    )


@pytest.mark.parametrize("name", ["jackal", "turtlebot3_burger", "paper"])
@pytest.mark.parametrize(("true", "declared"), [(0.12, 0.0), (0.2, 0.1), (0.45, 0.3)])
def test_a_latency_longer_than_declared_is_told(name, true, declared):
    found = told(true, declared, name=name)
    assert len(found) > 50
    assert np.abs(np.array(found) - true).max() < 0.06  # half a period


@pytest.mark.parametrize("gain", [0.85, 1.15])
def test_a_drive_that_is_slow_or_fast_does_not_change_the_latency(gain):
    found = told(0.2, 0.0, gain=gain)
    assert len(found) > 50
    assert np.abs(np.array(found) - 0.2).max() < 0.06


@pytest.mark.parametrize("drive", [{}, {"gain": 1.1}, {"lag": 0.04}, {"noise": 0.03}])
@pytest.mark.parametrize(("true", "declared"), [(0.0, 0.0), (0.1, 0.1), (0.1, 0.3), (0.3, 0.3)])
def test_a_latency_up_to_the_declared_one_is_not_told(drive, true, declared):
    assert not told(true, declared, **drive)


def test_a_drive_at_constant_speed_tells_nothing():
    assert not told(0.4, 0.0, changes=0.0)


def test_a_loop_that_is_faster_than_the_odometry_is_told():
    assert told(0.4, 0.0, calls=2) == told(0.4, 0.0)


def test_stamps_that_do_not_rise_begin_anew():
    check = LatencyCheck(ROBOTS["jackal"].limits, 0.0)
    for stamp in (5.0, 5.0, 1.0, 1.1):
        check.note(RobotState(stamp, HERE, REST), REST)
    assert check.longer is None
