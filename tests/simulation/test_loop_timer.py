"""When commands are given: at the navigator's period, slower, or with jitter."""

import numpy as np
import pytest

from dynastar.simulation import ControlLoop
from dynastar.simulation.loop_timer import LoopTimer


def periods(loop, seed=0):
    timer = LoopTimer(loop, 0.1, seed)
    return np.diff([0.0] + [timer.next() for _ in range(500)])


def test_a_perfect_loop_keeps_the_navigators_period():
    assert periods(ControlLoop()) == pytest.approx(0.1)


def test_a_slow_loop_keeps_its_own():
    assert periods(ControlLoop(0.25)) == pytest.approx(0.25)


def test_jitter_lengthens_periods_by_a_draw_of_the_seed():
    found = periods(ControlLoop(jitter=0.05), 3)
    assert 0.1 <= found.min() < 0.102
    assert 0.148 < found.max() <= 0.15
    np.testing.assert_array_equal(found, periods(ControlLoop(jitter=0.05), 3))
    assert (found != periods(ControlLoop(jitter=0.05), 4)).any()
