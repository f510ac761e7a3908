"""What the certified stop makes of movers: where they may come while the robot comes to rest."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dynastar.dwa import stop_kernels
from dynastar.robot import Limits
from naive import drive_through, spare_gap

LIMITS = Limits(1.0, 1.5, 1.0, 2.0, 1.0, 2.0)
RADIUS, SPREAD, RAMP = 0.4, 0.1, 0.1

speeds = st.floats(-1.2, 1.2)
mover_rows = st.tuples(
    st.floats(-4, 4), st.floats(-4, 4), speeds, speeds, st.floats(0.1, 0.5), st.floats(0, 1.5)
)


def stays_clear(movers, v, omega, linger=0.0, ahead=0.0, spread=SPREAD):
    """The kernel's answer for a robot at the origin that drives (v, omega) and stops; and ours."""
    stop = max(abs(v) / LIMITS.v_brake, abs(omega) / LIMITS.omega_brake)
    until = RAMP + stop + linger
    state = (0.0, 0.0, 0.3, v, omega)
    touch = stop_kernels.first_touch(
        np.array(movers, float), spread, RADIUS, state, v, omega, RAMP, stop, until, ahead
    )
    assert touch <= until + 1e-9 or touch == math.inf
    times = np.linspace(0.0, until, 600)
    where = drive_through((0.0, 0.0, 0.3), (v, omega), (v, omega), RAMP, stop, times)
    moves = min(RAMP + stop, until)
    return touch == math.inf, spare_gap(movers, spread, RADIUS, where, times, moves, ahead)


@given(
    st.lists(mover_rows, min_size=1, max_size=3),
    st.floats(0, 1.0),
    st.floats(-1, 1),
    st.sampled_from([0.0, 2.0, 5.0]),
    st.sampled_from([0.0, 0.2]),
)
@settings(max_examples=300, deadline=None)
def test_room_to_spare_is_clear_and_a_touch_is_not(movers, v, omega, linger, ahead):
    clear, spare = stays_clear(movers, v, omega, linger, ahead)
    if spare > 0.03:
        assert clear
    # A constant velocity, and nobody too near to begin with: then any touch is an approach.
    apart = min(math.hypot(row[0], row[1]) - row[4] for row in movers) - RADIUS
    _, touch = stays_clear(movers, v, omega, linger, ahead, spread=0.0)
    if touch < -0.05 and apart > 0.0:
        assert not clear


@given(mover_rows, st.floats(0.1, 1.0), st.floats(-1, 1))
@settings(max_examples=300, deadline=None)
def test_a_mover_that_may_stray_into_the_way_is_not_clear(mover, v, omega):
    clear, spare = stays_clear([mover], v, omega)
    assume(math.hypot(mover[0], mover[1]) - mover[4] - RADIUS > 0.02)
    if spare < -0.03:
        assert not clear


def test_a_mover_alongside_may_not_stray_nearer_than_it_is_kept():
    """Side by side at one speed it stays apart while the robot brakes gently, but not by much."""
    gentle = 0.2
    touch = stop_kernels.first_touch(
        np.array([[0.0, 0.72, 1.0, 0.0, 0.3, 0.0]]),
        *(SPREAD, RADIUS, (0.0, 0.0, 0.0, 1.0, 0.0), 1.0, 0.0, RAMP, 1.0 / gentle, 5.1, 0.0),
    )
    assert touch < 5.1


@pytest.mark.parametrize(("angle", "may"), [(0.0, False), (1.0, False), (2.2, True), (3.1, True)])
def test_who_is_too_near_may_be_left_and_not_approached(angle, may):
    beside = (0.6 * math.cos(0.3 + angle), 0.6 * math.sin(0.3 + angle), 0.0, 0.0, 0.3, 0.0)
    assert stays_clear([beside], 0.5, 0.0)[0] == may


def test_who_may_turn_back_as_fast_as_it_ever_was_is_reckoned_with():
    leaving = [0.95, 0.95 * math.tan(0.3), 0.1 * math.cos(0.3), 0.1 * math.sin(0.3), 0.3, 0.1]
    assert stays_clear([leaving], 0.1, 0.0, linger=1.0)[0]
    assert not stays_clear([[*leaving[:5], 1.5]], 0.1, 0.0, linger=1.0)[0]
