import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa.window import dynamic_window, sample_window, spaced
from dynastar.robot import ROBOTS, slew

robots = st.sampled_from(sorted(ROBOTS))


@given(robots, st.floats(-0.3, 1), st.floats(-1, 1), st.floats(0.0, 2.5), st.floats(0.05, 2.0))
@settings(deadline=None)
def test_the_window_is_what_can_be_reached_within_the_limits(name, v, omega, cap, span):
    limits = ROBOTS[name].limits
    v, omega, cap = (
        v * -limits.v_min if v < 0 else v * limits.v_max,
        omega * limits.omega_max,
        min(cap, limits.v_max),
    )
    low_v, high_v, low_w, high_w = dynamic_window(v, omega, limits, cap, span)
    assert limits.v_min - 1e-9 <= low_v <= high_v <= limits.v_max + 1e-9
    assert -limits.omega_max - 1e-9 <= low_w <= high_w <= limits.omega_max + 1e-9
    assert high_v <= max(cap, v) + 1e-9
    slowest = max(limits.v_min, -cap)  # a speed limit holds for backing, too
    assert low_v == pytest.approx(
        min(slew(v, slowest, limits.v_accel, limits.v_brake, span), high_v)
    )
    for end in (low_w, high_w):
        assert abs(end - omega) <= max(limits.omega_accel, limits.omega_brake) * span + 1e-9


@given(st.floats(-5, 5), st.floats(0, 5), st.integers(2, 40))
@settings(deadline=None)
def test_spaced_values_rise_from_end_to_end_with_zero_among_them(low, width, count):
    values, high = np.full(count + 3, np.nan), low + width
    n = spaced(low, high, count, values)
    assert n <= count + 3
    assert values[0] == pytest.approx(low, abs=1e-9)
    assert values[n - 1] == pytest.approx(high, abs=1e-9)
    assert (np.diff(values[:n]) > 0.0).all()
    if n > 1 and low < 0.0 < high:
        assert (values[:n] == 0.0).any()
        rising = np.abs(np.diff(values[1 : n - 1]))
        assert (
            np.argmin(rising) == pytest.approx(np.argmin(np.abs(values[1 : n - 2])), abs=2)
            if len(rising) > 4
            else True
        )


def test_samples_are_all_pairs():
    samples = np.empty((7 * 9, 2))
    n = sample_window((-0.2, 1.0, -1.0, 0.5), np.empty(7), np.empty(9), 4, 6, samples)
    speeds, rates = np.unique(samples[:n, 0]), np.unique(samples[:n, 1])
    assert n == len(speeds) * len(rates) == len({tuple(s) for s in samples[:n]})
    assert (speeds[[0, -1]] == (-0.2, 1.0)).all()
    assert (rates[[0, -1]] == (-1.0, 0.5)).all()
    assert [0.0, 0.0] in samples[:n].tolist()


def test_without_room_there_is_one_sample():
    samples = np.empty((30, 2))
    assert sample_window((0.3, 0.3, 0.1, 0.1), np.empty(5), np.empty(5), 2, 2, samples) == 1
    assert samples[0].tolist() == [0.3, 0.1]
