"""Progress by cost-to-go: when the robot counts as stuck, and when the rounds start over."""

import numpy as np
import pytest

from dynastar.navigator.progress import ADVANCE, RESTART, Progress


def towards(goal, offset=0.0):
    """A cost-to-go that is the distance along x, raised everywhere by ``offset`` (m)."""
    return lambda x, y: goal - x + offset


def times_stuck(progress, places, start=0.0, offset=lambda k: 0.0):
    """The times (s) at which a progress says that the robot is stuck, a place every second."""
    return [
        start + k
        for k, x in enumerate(places)
        if progress.stuck(start + k, (x, 0.0), towards(50.0, offset(k)))
    ]


def test_a_lower_cost_to_go_is_progress():
    assert times_stuck(Progress(3.0), [2.0 * ADVANCE * k for k in range(40)]) == []


def test_slow_progress_counts_once_it_adds_up():
    assert times_stuck(Progress(3.0), [0.4 * ADVANCE * k for k in range(40)]) == []


@pytest.mark.parametrize("drift", [0.0, 0.1 * ADVANCE, -0.1])
def test_without_progress_for_the_patience_the_robot_is_stuck(drift):
    progress = Progress(3.0)
    assert times_stuck(progress, [drift * k for k in range(5)]) == [4.0]
    assert progress.rounds == 1


def test_time_without_a_path_is_time_without_progress():
    progress = Progress(3.0)
    assert [k for k in range(9) if progress.stuck(float(k), (0.0, 0.0), None)] == [4, 8]
    shut = Progress(3.0)  # every other second, and the robot stands
    costs = [towards(50.0) if k % 2 else None for k in range(5)]
    assert [k for k in range(5) if shut.stuck(float(k), (0.0, 0.0), costs[k])] == [4]
    open_again = Progress(3.0)
    for k, cost in enumerate([None] * 3 + [towards(50.0)] * 9):
        assert not open_again.stuck(float(k), (max(0.0, k - 3.0), 0.0), cost)


@pytest.mark.parametrize("offset", [lambda k: 3.0 * (k % 2), lambda k: 0.5 * k, lambda k: -0.5 * k])
def test_a_cost_to_go_that_changes_everywhere_says_nothing(offset):
    assert times_stuck(Progress(3.0), [2.0 * ADVANCE * k for k in range(40)], offset=offset) == []
    assert times_stuck(Progress(3.0), [0.0] * 5, offset=offset) == [4.0]


def test_each_further_patience_is_another_round():
    progress = Progress(3.0)
    assert times_stuck(progress, [0.0] * 13) == [4.0, 8.0, 12.0]
    assert progress.rounds == 3


def test_the_rounds_start_over_after_a_leap():
    progress = Progress(3.0)
    times_stuck(progress, [0.0] * 5)
    assert not progress.stuck(5.0, (0.9 * RESTART, 0.0), towards(50.0))
    assert progress.rounds == 1
    assert not progress.stuck(6.0, (1.1 * RESTART, 0.0), towards(50.0))
    assert progress.rounds == 0


def test_a_restart_keeps_the_rounds_and_a_reset_does_not():
    progress = Progress(3.0)
    times_stuck(progress, [0.0] * 5)
    progress.restart(5.0)
    assert times_stuck(progress, [0.0] * 3, start=6.0) == []
    assert progress.rounds == 1
    progress.reset()
    assert progress.rounds == 0
    assert times_stuck(progress, [0.0] * 4, start=100.0) == []


def test_another_path_counts_as_no_progress_and_takes_none_away():
    """Half as fast as it needs a path a second to be: 0.05 m/s, and a path that is another each second."""
    progress = Progress(6.0)
    for second in range(60):
        progress.measure_anew()
        assert not progress.stuck(float(second), (-0.05 * second, 0.0), lambda x, y: x + 10.0)
    progress = Progress(6.0)
    stuck = []
    for second in range(20):  # at rest, while the way becomes longer and longer
        progress.measure_anew()
        stuck.append(progress.stuck(float(second), (0.0, 0.0), lambda x, y, t=second: 10.0 + t))
    assert any(stuck)


def test_where_another_path_leads_back_progress_is_measured_from_the_robot():
    progress = Progress(6.0)
    assert not progress.stuck(0.0, (0.0, 0.0), lambda x, y: 10.0 - x)
    assert not progress.stuck(1.0, (1.0, 0.0), lambda x, y: 10.0 - x)
    assert not progress.stuck(2.0, (2.0, 0.0), lambda x, y: 10.0 - x)
    progress.measure_anew()  # the goal is behind: 2 m are to be driven back before the old place
    for second in range(3, 20):
        x = 2.0 - 0.11 * (second - 2)
        assert not progress.stuck(float(second), (x, 0.0), lambda x, y: 10.0 + x)


def test_rounds_without_a_path_count_until_the_next_goal():
    progress = Progress(3.0)
    for k in range(9):
        progress.stuck(float(k), (0.0, 0.0), None)
    assert (progress.rounds, progress.pathless_rounds) == (2, 2)
    for k in range(9, 9 + round(3.0 * RESTART)):
        progress.stuck(float(k), (k - 9.0, 0.0), towards(50.0))
    assert (progress.rounds, progress.pathless_rounds) == (0, 2)
    progress.reset()
    assert progress.pathless_rounds == 0


def into_a_wall(x, y):
    """A cost-to-go that falls by 40 m a metre, as where the way leads through what cannot be driven."""
    return 40.0 * (1.0 - x)


def test_errors_of_the_pose_on_steep_ground_are_no_progress():
    """A robot at rest that gets another path each second."""
    progress, random, stuck = Progress(6.0), np.random.default_rng(0), []
    for second in range(20):
        progress.measure_anew()
        here = float(random.uniform(-0.04, 0.04)), 0.0
        stuck.append(progress.stuck(float(second), here, into_a_wall))
    assert stuck.count(True) == 2


def test_errors_of_the_pose_on_steep_ground_do_not_start_the_rounds_over():
    progress = Progress(3.0)
    for second in range(5):
        progress.stuck(float(second), (-0.04, 0.0), into_a_wall)
    assert not progress.stuck(5.0, (0.04, 0.0), into_a_wall)
    assert progress.rounds == 1
