"""Progress by cost-to-go: when the robot counts as stuck, and when the rounds start over."""

import pytest

from dynastar.navigator.progress import LEAP, STEP, Progress


def times_stuck(progress, values, period=1.0, start=0.0):
    """The times (s) at which a progress says that the robot is stuck."""
    ticks = [(start + period * k, value) for k, value in enumerate(values)]
    return [now for now, value in ticks if progress.stuck(now, value)]


def test_a_falling_cost_to_go_is_progress():
    assert times_stuck(Progress(3.0), [10.0 - 2.0 * STEP * k for k in range(40)]) == []


@pytest.mark.parametrize("drift", [0.0, 0.1 * STEP, -0.1])
def test_without_a_fall_for_the_patience_the_robot_is_stuck(drift):
    progress = Progress(3.0)
    assert times_stuck(progress, [10.0 - drift * k for k in range(5)]) == [4.0]
    assert progress.rounds == 1


def test_each_further_patience_is_another_round():
    progress = Progress(3.0)
    assert times_stuck(progress, [10.0] * 15) == [4.0, 9.0, 14.0]
    assert progress.rounds == 3


def test_the_rounds_start_over_after_a_leap():
    progress = Progress(3.0)
    times_stuck(progress, [10.0] * 5)
    assert not progress.stuck(5.0, 10.0 - 0.9 * LEAP)
    assert progress.rounds == 1
    assert not progress.stuck(6.0, 10.0 - 1.1 * LEAP)
    assert progress.rounds == 0


def test_a_new_path_is_compared_with_itself_and_keeps_the_rounds():
    progress = Progress(3.0)
    times_stuck(progress, [10.0] * 5)
    progress.restart(5.0)
    assert times_stuck(progress, [30.0, 29.0, 28.0, 28.0, 28.0], start=6.0) == []
    assert progress.rounds == 1
    progress.reset()
    assert progress.rounds == 0
    assert times_stuck(progress, [50.0] * 4, start=100.0) == []
