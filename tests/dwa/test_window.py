import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa.motion import state_at
from dynastar.dwa.window import Window, possible, reachable, spaced
from dynastar.robot import ROBOTS, Limits, slew

robots = st.sampled_from(sorted(ROBOTS))


@given(robots, st.floats(0.0, 1.0), st.floats(-3.0, 3.0))
@settings(deadline=None)
def test_equation_5_speeds_are_possible_within_the_limits_and_the_cap_both_ways(name, cap, v):
    limits = ROBOTS[name].limits
    cap *= limits.v_max
    window = possible(limits, cap)
    assert (window.low_v <= v <= window.high_v) == (
        limits.v_min <= v <= limits.v_max and abs(v) <= cap
    )
    assert (window.low_omega, window.high_omega) == (-limits.omega_max, limits.omega_max)


@pytest.mark.parametrize("turn", [-1.0, 1.0])
@pytest.mark.parametrize("forward", [-1.0, 1.0])
def test_every_end_of_equation_6_is_the_speed_and_what_its_own_limit_adds(forward, turn):
    limits = Limits(9.0, 9.0, 0.2, 0.5, 0.3, 0.7, v_min=-9.0)
    state = state_at(0.0, 0.0, 0.0, 2.0 * forward, 3.0 * turn)
    got = reachable(state, limits, possible(limits, 9.0), 2.0)
    v = sorted([2.0 - 0.3 * 2.0, 2.0 + 0.2 * 2.0])  # slower and faster
    omega = sorted([3.0 - 0.7 * 2.0, 3.0 + 0.5 * 2.0])
    ends = sorted(forward * end for end in v), sorted(turn * end for end in omega)
    assert got == pytest.approx((*ends[0], *ends[1]), abs=1e-12)


@given(robots, *[st.floats(0, 1)] * 5, st.floats(0.05, 2.0))
@settings(deadline=None)
def test_equation_6_speeds_are_reachable_if_a_ramp_gets_there_in_time(
    name, v, omega, cap, wanted_v, wanted_omega, duration
):
    limits = ROBOTS[name].limits
    v = limits.v_min + v * (limits.v_max - limits.v_min)
    omega = limits.omega_max * (2.0 * omega - 1.0)
    every = possible(limits, cap * limits.v_max)
    window = reachable(state_at(0.0, 0.0, 0.0, v, omega), limits, every, duration)

    def ramp(wanted_v, wanted_omega):
        return (
            slew(v, wanted_v, limits.v_accel, limits.v_brake, duration),
            slew(omega, wanted_omega, limits.omega_accel, limits.omega_brake, duration),
        )

    lowest, highest = ramp(every.low_v, every.low_omega), ramp(every.high_v, every.high_omega)
    assert (window.low_v, window.low_omega) == pytest.approx(lowest, abs=1e-12)
    assert (window.high_v, window.high_omega) == pytest.approx(highest, abs=1e-12)
    after = ramp(
        every.low_v + wanted_v * (every.high_v - every.low_v),
        every.low_omega + wanted_omega * (every.high_omega - every.low_omega),
    )
    assert window.low_v - 1e-12 <= after[0] <= window.high_v + 1e-12
    assert window.low_omega - 1e-12 <= after[1] <= window.high_omega + 1e-12


def test_the_reachable_speeds_of_an_example():
    limits = Limits(1.0, 1.5, 0.8, 2.0, 3.0, 4.0, v_min=-0.3)
    every = possible(limits, 1.0)
    window = reachable(state_at(0.0, 0.0, 0.0, 0.5, -0.2), limits, every, 0.1)
    # To the left the rate first brakes to 0 in 0.05 s, then rises at 2 rad/s2.
    assert window == pytest.approx(Window(0.5 - 0.3, 0.5 + 0.08, -0.2 - 0.2, 0.05 * 2.0))
    slowed = reachable(state_at(0.0, 0.0, 0.0, 0.5, 0.0), limits, possible(limits, 0.1), 0.1)
    assert (slowed.low_v, slowed.high_v) == pytest.approx((0.2, 0.2))  # braking to the cap


@given(st.floats(-5, 5), st.floats(0, 5), st.integers(2, 40))
@settings(deadline=None)
def test_spaced_values_rise_from_end_to_end_and_contain_zero(low, width, count):
    high = low + width
    values = spaced(low, high, count)
    assert len(values) <= count + 3
    assert values[0] == pytest.approx(low, abs=1e-9)
    assert values[-1] == pytest.approx(high, abs=1e-9)
    assert (np.diff(values) > 0.0).all()
    if len(values) > 1 and low < 0.0 < high:
        assert (values == 0.0).any()


def test_spaced_values_are_denser_near_zero():
    gaps = np.diff(spaced(-1.0, 1.0, 20))
    assert (np.diff(gaps[len(gaps) // 2 :]) > 0.0).all()
    assert gaps.min() < 0.02
    assert gaps.max() < 0.2


def test_a_range_without_width_is_one_value():
    assert spaced(0.3, 0.3, 2).tolist() == [0.3]
