"""How far a robot drives until it rests, and how far it sees."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.check.stopping import (
    blind_beyond,
    fastest_within,
    looks_towards,
    sight_of,
    stop_from,
)
from dynastar.navigator import NavigatorConfig
from dynastar.robot import ROBOTS, Lidar, slew

PIONEER = ROBOTS["pioneer3dx"]
CONFIG = NavigatorConfig(latency=0.1)
STEP = 1e-3  # s


def limits(v_max, v_brake):
    return PIONEER.limits._replace(v_max=v_max, v_brake=v_brake)


@given(st.floats(0.05, 3.0), st.floats(0.1, 5.0), st.floats(0.0, 0.5), st.floats(0.05, 0.5))
def test_a_stop_is_as_long_as_a_drive_simulated_in_small_steps(v, brake, latency, period):
    config = NavigatorConfig(latency=latency, period=period, drive_error=0.0)
    stop = stop_from(v, limits(v, brake), config)
    x, speed, time = v * (latency + period), v, latency + period
    while speed > 0.0:
        after = slew(speed, 0.0, brake, brake, STEP)
        x, speed, time = x + 0.5 * (speed + after) * STEP, after, time + STEP
    assert stop.distance == pytest.approx(x, abs=1e-3 * v + 1e-6)
    assert stop.seconds == pytest.approx(time, abs=2.0 * STEP)


@given(st.floats(0.05, 5.0), st.floats(0.1, 5.0), st.floats(0.0, 0.5), st.floats(0.0, 0.5))
def test_the_fastest_speed_within_a_stop_is_the_speed_that_it_starts_from(v, brake, late, error):
    config = NavigatorConfig(latency=late, drive_error=error)
    distance = stop_from(v, limits(9.0, brake), config).distance
    assert fastest_within(distance, limits(9.0, brake), config) == pytest.approx(v, rel=1e-6)
    assert fastest_within(distance, limits(0.5 * v, brake), config) == 0.5 * v


@given(st.integers(20, 2000), st.floats(1.0, 30.0), st.floats(0.01, 0.5), st.floats(2.0, 40.0))
def test_more_beams_more_range_and_a_larger_map_never_see_less(beams, far, narrowest, size):
    def ahead(beams, far, narrowest, size):
        config = CONFIG._replace(
            local_map=CONFIG.local_map._replace(narrowest=narrowest, size=size)
        )
        lidar = Lidar(beams, math.tau, 0.1, far)
        return sight_of(replace(PIONEER, lidar=lidar), config).ahead

    now = ahead(beams, far, narrowest, size)
    better = (2 * beams, far, narrowest, size), (beams, 1.5 * far, narrowest, size)
    better += (beams, far, 1.5 * narrowest, size), (beams, far, narrowest, 1.5 * size)
    assert all(ahead(*one) >= now - 1e-9 for one in better)


def test_a_lidar_that_looks_backwards_sees_nothing_ahead():
    lidar = Lidar(360, math.pi, 0.1, 10.0, theta=math.pi)
    assert not looks_towards(lidar, 0.0)
    assert looks_towards(lidar, math.pi)
    assert sight_of(replace(PIONEER, lidar=lidar), CONFIG).ahead == 0.0


def test_a_lidar_with_all_but_one_step_of_a_turn_looks_all_round():
    step = math.tau / 360
    assert looks_towards(Lidar(360, math.tau - step, 0.1, 10.0), math.pi)
    assert not looks_towards(Lidar(360, math.tau - 10.0 * step, 0.1, 10.0), math.pi)


@pytest.mark.parametrize("x", [-0.2, 0.0, 0.3])
def test_the_blind_disc_reaches_out_of_a_polygon_by_as_much_as_a_dense_search_says(x):
    robot = replace(ROBOTS["jackal"], lidar=Lidar(720, math.tau, 0.5, 10.0, x=x))
    angles = np.linspace(0.0, math.tau, 20000)
    points = np.column_stack([x + 0.5 * np.cos(angles), 0.5 * np.sin(angles)])
    grown = [m for m in np.arange(0.0, 1.0, 0.002) if _covers(robot.footprint, points, m)]
    assert blind_beyond(robot) == pytest.approx(grown[0], abs=0.005)


def _covers(footprint, points, margin):
    """Whether all points are within a rectangle, rounded by a margin."""
    high = footprint.vertices.max(axis=0)
    away = np.maximum(np.abs(points) - high, 0.0)
    return bool((np.hypot(*away.T) <= margin).all())


def test_a_short_blind_range_stays_in_the_footprint():
    assert blind_beyond(replace(PIONEER, lidar=Lidar(range_min=0.25))) == pytest.approx(0.0)
    assert blind_beyond(replace(PIONEER, lidar=Lidar(range_min=0.35))) == pytest.approx(0.1)
