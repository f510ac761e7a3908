import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.path import Trajectory
from dynastar.smoothness import (
    angular_acceleration,
    circles,
    jerk,
    omega_changes,
    smoothness,
    turning_angle,
)


def driven(v: Any, omega: Any, period: float = 0.05) -> Trajectory:
    """A trajectory of speeds at ticks, (n,) each, from (0, 0) along the x axis."""
    v, omega = np.broadcast_arrays(np.asarray(v, float), np.asarray(omega, float))
    headings = np.concatenate([[0.0], np.cumsum(period * 0.5 * (omega[1:] + omega[:-1]))])
    middle = 0.5 * (headings[1:] + headings[:-1])
    steps = (period * 0.5 * (v[1:] + v[:-1]))[:, None] * np.column_stack(
        [np.cos(middle), np.sin(middle)]
    )
    places = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    wrapped = (headings + np.pi) % math.tau - np.pi
    times = 3.0 + period * np.arange(len(v))
    return Trajectory(times, np.column_stack([places, wrapped]), np.column_stack([v, omega]))


def ticks(seconds: float, period: float = 0.05) -> np.ndarray:
    return period * np.arange(round(seconds / period) + 1)


STILL = driven([0.0], [0.0])
NOTHING = Trajectory(np.empty(0), np.empty((0, 3)), np.empty((0, 2)))


def test_smoothness_is_the_variation_of_the_turning_rate_per_metre():
    assert smoothness(driven([1.0] * 41, 0.2)) == pytest.approx(0.0)
    up_and_down = driven([1.0] * 41, [0.0, 0.4, -0.1] + [-0.1] * 38)
    assert smoothness(up_and_down) == pytest.approx(0.9 / 2.0, rel=1e-3)


@pytest.mark.parametrize("period", [0.01, 0.05, 0.1, 0.125])
def test_jerk_of_a_parabola_is_its_second_derivative(period: float):
    t = ticks(5.0, period)
    assert jerk(driven(0.3 * t**2, 0.0, period)) == pytest.approx(0.6, rel=1e-3)
    assert jerk(driven(0.3 * t, 0.0, period)) == pytest.approx(0.0, abs=1e-6)


def test_jerk_hardly_depends_on_the_rate_of_the_ticks():
    """The finite difference from tick to tick would grow without end with the rate."""
    found = []
    for period in (0.0125, 0.025, 0.05, 0.125):
        t = ticks(10.0, period)
        ramp = np.interp(t, [0.0, 2.0, 4.0, 6.0, 8.0], [0.0, 1.0, 1.0, 0.0, 0.0])
        found.append(jerk(driven(ramp, 0.0, period)))
    assert found == pytest.approx([found[0]] * 4, rel=0.05)


def test_noise_of_single_ticks_is_averaged_out():
    t = ticks(10.0)
    assert jerk(driven(1.0 + 0.01 * (-1.0) ** np.arange(len(t)), 0.0)) < 0.2
    # From tick to tick the second difference of that noise is 0.04 / 0.05**2 = 16 m/s3.


def test_angular_acceleration_is_over_time():
    t = ticks(4.0)
    half = np.where(t <= 2.0, 0.5 * t, 1.0)  # half of the time at 0.5 rad/s2, then none
    assert angular_acceleration(driven(0.0, half)) == pytest.approx(0.5 / math.sqrt(2.0))
    assert angular_acceleration(driven(0.0, 0.5 * t)) == pytest.approx(0.5)


@given(
    st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=20),
    st.integers(2, 5),
)
def test_samples_between_the_ticks_do_not_change_angular_acceleration(
    omega: list[float], parts: int
):
    times = np.arange(len(omega), dtype=float)
    finer = np.linspace(0.0, times[-1], parts * (len(omega) - 1) + 1)
    coarse = angular_acceleration(driven(0.0, omega, 1.0))
    fine = angular_acceleration(driven(0.0, np.interp(finer, times, omega), 1.0 / parts))
    assert fine == pytest.approx(coarse, abs=1e-9)


def test_sign_changes_of_omega_are_per_metre_and_not_of_noise():
    t = ticks(10.0)
    swinging = np.sin(math.tau * 0.5 * t + 0.3)  # ten changes in 10 m
    assert omega_changes(driven(np.ones_like(t), swinging)) == pytest.approx(1.0, rel=0.05)
    noise = 0.04 * (-1.0) ** np.arange(len(t))
    assert omega_changes(driven(np.ones_like(t), noise)) == 0.0
    dips = np.where((t > 3.0) & (t < 4.0), noise, 0.4)
    assert omega_changes(driven(np.ones_like(t), dips)) == 0.0


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("turn", "radius", "count"),
    [(200, 0.5, 0), (300, 0.5, 1), (360, 0.9, 1), (560, 0.5, 2), (300, 0.0, 1), (360, 5.0, 0)],
)
def test_circles(way: float, turn: float, radius: float, count: int):
    seconds = math.radians(turn)
    t = ticks(seconds)
    round_ = driven(np.full(len(t), radius), way * 1.0)
    assert circles(round_) == count


def test_the_turning_angle_counts_both_ways():
    t = ticks(40.0)
    found = turning_angle(driven(0.1, 1.5 * np.sign(np.sin(math.tau * t / 4.0))))
    assert found == pytest.approx(1.5 * 40.0, rel=0.05)


def test_to_and_fro_is_no_circle():
    t = ticks(40.0)
    assert circles(driven(0.1, 1.5 * np.sign(np.sin(math.tau * t / 4.0)))) == 0


def test_what_did_not_drive_has_no_numbers():
    for found in (STILL, NOTHING):
        assert smoothness(found) is jerk(found) is None
        assert angular_acceleration(found) is omega_changes(found) is None
        assert circles(found) == turning_angle(found) == 0
