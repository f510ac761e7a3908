"""The largest speeds along a path: bends, speed limits and the end."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.bench.speed_profile import (
    GENTLE,
    SLOWEST,
    SPACING,
    SWING,
    SpeedProfile,
    bend_speed,
    points,
    turning_speed,
)
from dynastar.path import Path
from dynastar.robot import ROBOTS, Limits

LIMITS = Limits(1.5, 1.0, 0.5, 1.0, 0.4, 0.8)
NONE = np.inf
corners = st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8)), min_size=2, max_size=6)


def profile(line, limits=LIMITS, speed_limit=None):
    path = Path(np.array(line, float))
    at = points(path)
    return path, SpeedProfile(
        path, limits, np.full(len(at), NONE) if speed_limit is None else speed_limit(at)
    )


def test_a_straight_path_is_driven_fully_until_it_has_to_be_braked():
    path, found = profile([(0, 0), (10, 0)])
    brake = GENTLE * LIMITS.v_brake
    for s in np.linspace(0.0, 10.0, 101)[:-1]:
        left = max(0.0, path.length - SPACING - s)
        expected = max(SLOWEST, min(LIMITS.v_max, math.sqrt(2.0 * brake * left)))
        assert found.at(s) == pytest.approx(expected, abs=0.02)
    assert found.at(10.0) == found.at(99.0) == SLOWEST


@given(corners, st.floats(0.2, 2.0))
def test_it_is_what_every_later_point_allows_and_no_less(line, allowed):
    if math.dist(line[0], line[-1]) < 0.2:
        return
    path, found = profile(line, speed_limit=lambda at: np.where(at[:, 0] > 4.0, allowed, NONE))
    at = points(path)
    arc = np.linspace(0.0, path.length, len(at))
    own = np.minimum(turning_speed(path, arc, LIMITS), LIMITS.v_max)
    own = np.minimum(own, np.where(at[:, 0] > 4.0, allowed, NONE))
    own[-1] = 0.0
    own = np.array([own[max(i - 1, 0) : i + 2].min() for i in range(len(own))])
    for i in range(0, len(arc), 7):
        room = 2.0 * GENTLE * LIMITS.v_brake * (arc[i:] - arc[i])
        expected = max(SLOWEST, np.sqrt(own[i:] ** 2 + room).min())
        assert found.at(arc[i]) == pytest.approx(expected, abs=1e-6)


def test_a_corner_is_taken_slowly_and_a_bend_by_little_is_not():
    _, found = profile([(0, 0), (5, 0), (5, 5)])
    assert found.at(5.0) == pytest.approx(float(bend_speed(math.pi / 2, LIMITS)), abs=0.01)
    assert found.at(0.0) == LIMITS.v_max
    assert profile([(0, 0), (5, 0), (10, 0.1)])[1].at(5.0) == LIMITS.v_max


@given(st.sampled_from(sorted(ROBOTS)), st.floats(0.05, 2.9), st.floats(0.01, 0.1))
def test_sharper_bends_are_slower(name, angle, more):
    limits = ROBOTS[name].limits
    assert bend_speed(angle + more, limits) < bend_speed(angle, limits)


def test_a_bend_is_turned_in_the_time_that_its_length_takes():
    for angle in (0.3, 1.0, 2.0):
        speed = float(bend_speed(angle, LIMITS))
        time = 4.0 * SWING / math.tan(0.5 * angle) / speed
        accel, top = 0.8, LIMITS.omega_max
        peak = min(top, accel * time / 2.0)  # up, perhaps held, and down
        assert peak * (time - peak / accel) == pytest.approx(angle)


@given(corners, st.floats(0.1, 2.0), st.floats(1.0, 7.0))
def test_a_speed_limit_is_kept_wherever_the_path_is_under_it(line, allowed, begin):
    path, found = profile(line, speed_limit=lambda at: np.where(at[:, 0] > begin, allowed, NONE))
    for s in np.linspace(0.0, path.length, 200):
        at = path.at(s)
        if at[0] > begin + 0.01:
            assert found.at(s) <= allowed + 1e-6


def test_a_limit_below_the_slowest_holds():
    _, found = profile(
        [(0, 0), (6, 0)], speed_limit=lambda at: np.where(at[:, 0] > 3.0, 0.04, NONE)
    )
    assert found.at(4.0) == pytest.approx(0.04)
    assert found.at(1.0) > 0.5


@given(st.floats(-math.pi, math.pi), st.floats(0.05, 5.0))
def test_the_ends_of_a_path_are_no_bends(direction, length):
    end = length * math.cos(direction), length * math.sin(direction)
    path = Path(np.array([(0.0, 0.0), end]))
    assert turning_speed(path, np.linspace(0.0, length, 20), LIMITS).min() > 10.0 * LIMITS.v_max
