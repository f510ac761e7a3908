"""Poor settings are stopped early, good ones never for chance; failures go before time."""

import numpy as np
import pytest

from dynastar.tune.objective import FAILURE, MOST_WORLDS, loss
from dynastar.tune.racing import Raced, race

WORLDS, BATCH = 40, 4


def arrived(time, smoothness=2.0, **more):
    return {"outcome": "arrived", "time": time, "smoothness": smoothness, **more}


def raced(losses, best):
    return race(WORLDS, BATCH, lambda count: losses[:count], best)


def test_a_failure_outweighs_any_time_and_time_any_smoothness():
    default = arrived(10.0)
    blocked, touched = {"outcome": "blocked"}, arrived(5.0, contacts_moving=1)
    slow = [loss(arrived(1e9, 1e9), default)] * MOST_WORLDS
    for failure in (blocked, touched):
        assert loss(failure, default) >= FAILURE
        one_failed = [
            loss(failure, default),
            *[loss(arrived(0.1, 0.0), default)] * (MOST_WORLDS - 1),
        ]
        assert sum(one_failed) > sum(slow)
    assert loss(arrived(11.0, 0.0), default) > loss(arrived(10.0, 5.0), default)
    assert loss(arrived(10.0, 1.0), default) < loss(default, default) == pytest.approx(1.02)


def test_a_world_in_which_one_of_both_failed_says_nothing_about_time():
    assert loss(arrived(99.0), {"outcome": "timeout"}) == pytest.approx(1.02)
    right = {"outcome": "blocked_rightly", "time": 50.0}
    assert loss(right, {"outcome": "blocked_rightly", "time": 10.0}) == pytest.approx(1.02)


def test_a_setting_that_is_clearly_slower_is_stopped_early():
    random = np.random.default_rng(0)
    best = list(random.uniform(0.9, 1.1, WORLDS))
    slow = [1.1 * one for one in best]
    found = raced(slow, best)
    assert len(found.losses) == 8
    assert "worse in 8 worlds" in found.stopped
    assert found.mean == pytest.approx(np.mean(slow[:8]))


def test_a_setting_that_failed_too_often_cannot_win_and_is_stopped():
    best = [1.0] * (WORLDS - 1) + [FAILURE + 1.0]
    assert raced([FAILURE + 1.0] + [0.5] * (WORLDS - 1), best).stopped == ""
    found = raced([FAILURE + 1.0] * 2 + [0.5] * (WORLDS - 2), best)
    assert found.stopped == "2 failures, the best setting has 1 in all worlds"
    assert len(found.losses) == BATCH


def test_settings_that_differ_by_chance_mostly_come_to_the_end():
    random = np.random.default_rng(1)
    best = list(random.normal(1.0, 0.1, WORLDS))
    others = [list(random.normal(1.0, 0.1, WORLDS)) for _ in range(100)]
    ends = [raced(losses, best) for losses in others]
    assert sum(not found.stopped for found in ends) > 60
    better = [[one - abs(random.normal(0.05, 0.02)) for one in best] for _ in range(100)]
    assert all(len(raced(losses, best).losses) == WORLDS for losses in better)


def test_the_first_setting_drives_all_worlds_and_equal_ones_are_not_stopped():
    assert raced([FAILURE] * WORLDS, None) == Raced((FAILURE,) * WORLDS, "")
    assert raced([1.0] * WORLDS, [1.0] * WORLDS).stopped == ""
