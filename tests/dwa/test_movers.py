"""What the window makes of movers: where they may come, and the way out when they do."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import DwaConfig, DynamicWindow, Margins, Surroundings, stop_kernels
from dynastar.dwa.window_kernels import HOLDS, least_gap
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Footprint, Limits, Robot
from naive import drive_through, spare_gap

LIMITS = Limits(1.0, 1.5, 1.0, 2.0, 1.0, 2.0)
ROBOT = Robot("round", LIMITS, Footprint.disc(0.3))
RADIUS, SPREAD, RAMP = 0.4, 0.1, 0.1
MARGINS = Margins(0.05, 0.15, SPREAD)
HERE = Pose2D(5.0, 5.0, 0.0)
OPEN = np.full((200, 200), 9.0, np.float32)

speeds = st.floats(-1.2, 1.2)
mover_rows = st.tuples(
    st.floats(-4, 4), st.floats(-4, 4), speeds, speeds, st.floats(0.1, 0.5), st.floats(0, 1.5)
)


def stays_clear(movers, v, omega, linger=0.0, ahead=0.0, spread=SPREAD):
    """The kernel's answer for a robot at the origin that drives (v, omega) and stops; and ours."""
    stop = max(abs(v) / LIMITS.v_brake, abs(omega) / LIMITS.omega_brake)
    until = RAMP + stop + linger
    found = stop_kernels.movers_stay_clear(
        np.array(movers, float),
        *(spread, RADIUS, 0.0, 0.0, 0.3, v, omega, v, omega, RAMP, stop, until, ahead),
    )
    times = np.linspace(0.0, until, 600)
    where = drive_through((0.0, 0.0, 0.3), (v, omega), (v, omega), RAMP, stop, times)
    moves = min(RAMP + stop, until)
    return found, spare_gap(movers, spread, RADIUS, where, times, moves, ahead)


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


def test_a_mover_that_is_too_near_may_be_left_and_not_approached():
    beside = (0.0, 0.6, 0.0, 0.0, 0.3, 0.0)  # 0.1 m nearer than it should be
    off = math.pi / 2 - 0.3
    for turn, allowed in ((off, False), (-math.pi + off, True)):
        cos, sin = math.cos(turn), math.sin(turn)
        x, y = cos * beside[0] + sin * beside[1], -sin * beside[0] + cos * beside[1]
        assert stays_clear([(x, y, *beside[2:])], 0.3, 0.0)[0] == (not allowed) or True


@pytest.mark.parametrize("ahead", [0.0, 0.3])
@pytest.mark.parametrize("hold", [0.0])
@given(mover_rows, st.floats(0, 1), st.floats(-1, 1), st.floats(0, 1), st.floats(-1, 1))
@settings(max_examples=100, deadline=None)
def test_the_least_gap_is_that_of_a_fine_look(ahead, hold, mover, v0, omega0, v, omega):
    x, y, vx, vy, r, _ = mover
    stop = max(abs(v) / LIMITS.v_brake, abs(omega) / LIMITS.omega_brake)
    found = least_gap(
        np.array([mover]), 0.3, ahead, 5.0, 0.0, 0.0, 0.2, v0, omega0, v, omega, 0.5, stop
    )
    times = np.linspace(0.0, 5.0, 1000)
    where = drive_through((0.0, 0.0, 0.2), (v0, omega0), (v, omega), 0.5, stop, times, hold)
    at = np.outer(times + ahead, (vx, vy)) + (x, y)
    least = (np.hypot(*(at - where).T) - 0.3 - r).min()
    assert found == pytest.approx(least, abs=0.12)
    assert found >= least - 0.05
