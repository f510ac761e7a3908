"""Data, drive and map at fault while the navigator drives: it stops in time, and goes on."""

import math

import numpy as np
import pytest

from driving import under_way, with_ranges
from dynastar.bench.runner import Options
from dynastar.bench.suites import faults
from dynastar.geometry import Twist
from dynastar.navigator.braking import Commands
from dynastar.simulation import drive

MISSIONS = [m for m in faults.missions(Options()) if m.spec.fraction == 0.4]


@pytest.mark.parametrize("mission", MISSIONS, ids=lambda m: f"{m.spec.case.name}-{m.spec.robot}")
def test_every_fault_is_survived_as_it_should_be(mission):
    scenario = faults.scenario(mission, Options(), 0)
    row = faults.judged(drive(scenario), mission.spec.case, scenario.latency)
    assert row["right"], row


@pytest.mark.parametrize("reading", [1.05, 0.5, math.nan, math.inf])
def test_a_stop_ends_whatever_the_odometry_reads(reading):
    going = under_way()
    limits, state = going.navigator.robot.limits, going.state
    commands = Commands(limits, 0.1, 0.0)
    command = commands.send(state, Twist(limits.v_max, 0.0))
    for _ in range(math.ceil(limits.v_max / limits.v_brake / 0.1) + 2):
        before, v = command, command.v * reading
        command = commands.brake(state._replace(twist=Twist(v, 0.0)))
        assert command.v <= before.v
    assert command == (0.0, 0.0)


def test_a_speed_that_cannot_be_is_not_answered_by_one():
    going = under_way()
    limits = going.navigator.robot.limits
    for v, omega in [(1e4, 0.0), (-20.0, 0.0), (0.0, 1e6)]:
        command = going.navigator.command(going.state._replace(twist=Twist(v, omega)), going.scan())
        assert limits.v_min <= command.v <= limits.v_max
        assert abs(command.omega) <= limits.omega_max


def test_the_same_ranges_again_are_news_to_a_robot_that_stands():
    going = under_way()
    ranges = np.array(going.scan().ranges)
    for _ in range(20):
        state = going.state._replace(stamp=going.now, twist=Twist(0.0, 0.0))
        going.navigator.command(state, with_ranges(going.scan(), ranges))
        going.now += 0.1
        assert going.status.state != "sensor_lost"
