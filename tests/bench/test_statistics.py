import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.bench.statistics import (
    bootstrap,
    holm,
    lost_and_gained,
    mcnemar,
    pairs_needed,
    succeeded,
    totals,
    wilson,
)


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [(0, 10, 0.0, 0.2775), (10, 10, 0.7225, 1.0), (50, 100, 0.4038, 0.5962), (1, 1, 0.2065, 1.0)],
)
def test_wilson_as_in_tables(successes, trials, low, high):
    assert wilson(successes, trials) == pytest.approx((low, high), abs=1e-4)


@given(st.integers(1, 300), st.floats(0.0, 1.0))
def test_wilson_holds_the_proportion(trials, fraction):
    successes = round(fraction * trials)
    low, high = wilson(successes, trials)
    assert 0.0 <= low <= successes / trials + 1e-12
    assert successes / trials - 1e-12 <= high <= 1.0
    assert wilson(0, 0) is None


def test_mcnemar_counts_the_ways_of_a_coin():
    for n in range(1, 9):
        for k in range(n + 1):
            at_least_as_uneven = sum(
                abs(sum(flips) - n / 2) >= abs(k - n / 2) for flips in product((0, 1), repeat=n)
            )
            assert mcnemar(k, n - k) == pytest.approx(at_least_as_uneven / 2**n)
    assert mcnemar(0, 0) == 1.0


def test_bootstrap_is_about_the_normal_interval_and_repeats():
    values = [float(n % 17) for n in range(200)]
    low, high = bootstrap(values)
    mean = sum(values) / 200
    sd = math.sqrt(sum((v - mean) ** 2 for v in values) / 200)
    assert (low, high) == pytest.approx(
        (mean - 1.96 * sd / math.sqrt(200), mean + 1.96 * sd / math.sqrt(200)), abs=0.05
    )
    assert bootstrap(values) == (low, high)
    assert bootstrap([1.0]) is None
    assert bootstrap([0.0] * 99 + [1000.0], np.median) == (0.0, 0.0)
    assert bootstrap([2.0, 2.0]) == (2.0, 2.0)


def test_holm_by_hand():
    # Sorted: 0.01 x 4, 0.02 x 3, then 0.03 x 2 (not below the one before), 0.9 x 1.
    assert holm([0.9, 0.01, 0.03, 0.02]) == pytest.approx([0.9, 0.04, 0.06, 0.06])
    assert holm([0.6, 0.5]) == [1.0, 1.0]
    assert holm([]) == []


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_holm_rejects_as_its_steps_do(p_values):
    left = sorted(p_values)
    rejected = 0
    while rejected < len(left) and left[rejected] <= 0.05 / (len(left) - rejected):
        rejected += 1
    assert sum(p <= 0.05 for p in holm(p_values)) == rejected


def row(outcome, **more):
    return {"outcome": outcome, **more}


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (row("arrived"), True),
        (row("arrived", contacts_moving=0, contacts_resting=1), False),
        (row("blocked"), False),
        (row("blocked_rightly"), True),
        (row("blocked", blocked_rightly=True), True),
        (row("arrived", right=False), False),
        (row("timeout"), False),
        (row("error", reason="x"), False),
    ],
)
def test_success(made, expected):
    assert succeeded(made) is expected


def test_totals_by_hand():
    rows = [
        row("arrived", group="a", score=0.5, time=10.0, time_ratio=1.0, length=4.0, jerk=3.0)
        | {"tick_ms_median": 1.0, "tick_ms_p99": 3.0, "limited": {"risk": 2.0, "turn": 0.5}},
        row("arrived", group="b", score=0.3, time=20.0, time_ratio=2.0, length=6.0, jerk=4.0)
        | {"tick_ms_median": 2.0, "tick_ms_p99": 5.0, "limited": {"turn": 3.0}},
        row("timeout", group="b", score=0.0, time=99.0, tick_ms_median=9.0, tick_ms_p99=9.0)
        | {"jerk": 9.0},
        row("error", reason="x"),
        row("blocked_rightly", group="a"),
    ]
    found = totals(rows, 7)
    assert list(found)[:2] == ["missions", "skipped"]
    assert list(found)[-1] == "rows"
    expected = {"missions": 5, "skipped": 7, "arrived": 2, "blocked_rightly": 1, "succeeded": 3}
    expected |= {"timeouts": 1, "errors": 1, "contacts_moving": 0, "mean_length": 5.0}
    expected |= {"mean_jerk": 3.5, "mean_nearest": None}
    expected |= {"mean_time": 15.0, "time_ratio": 1.5, "tick_ms_median": 2.0, "tick_ms_p99": 5.0}
    assert {key: found[key] for key in expected} == expected
    assert found["score"] == pytest.approx(0.8 / 5)
    assert found["arrived_interval"] == wilson(2, 5)
    assert found["limited"] == {"turn": 3.5, "risk": 2.0}
    assert list(found["limited"]) == ["turn", "risk"]
    assert set(found["groups"]) == {"a", "b"}
    assert found["groups"]["a"]["missions"] == 2
    assert found["groups"]["b"]["score"] == pytest.approx(0.15)


def test_a_suite_without_a_score_has_none():
    found = totals([row("arrived"), row("timeout", score=None)], 0)
    assert found["score"] is found["time_ratio"] is found["tick_ms_median"] is None
    assert found["groups"] == {}


def test_totals_of_nothing() -> None:
    result = totals([], 3)
    assert result["mean_length"] is None
    assert result["skipped"] == 3


def test_totals_count_missions() -> None:
    rows = [
        {"outcome": "contact", "contacts_moving": 2, "contacts_resting": 0},
        {"outcome": "contact", "contacts_moving": 0, "contacts_resting": 1},
        {"outcome": "timeout", "length": 4.0, "time": 400.0},
        {"outcome": "arrived", "length": 2.0, "time": None},
    ]
    result = totals(rows, 0)
    assert (result["contacts_moving"], result["contacts_resting"], result["timeouts"]) == (1, 1, 1)
    assert (result["mean_length"], result["mean_time"]) == (2.0, None)


@pytest.mark.parametrize(
    ("counts", "needed"), [((45, 5, 100), 23), ((60, 30, 200), 155), ((4, 4, 50), None)]
)
def test_pairs_needed_are_those_of_published_examples(counts, needed):
    assert pairs_needed(*counts) == needed


def test_repeats_of_a_mission_are_one_mission():
    """Of mission 3 all five repeats are lost, of 4 as many are lost as gained, of 5 more gained."""
    outcomes = {3: ("aaaaa", "bbbbb"), 4: ("aabb", "bbaa"), 5: ("abb", "aab"), 6: ("a", "a")}
    pairs = [
        tuple({"number": number, "outcome": {"a": "arrived", "b": "blocked"}[one]} for one in two)
        for number, rows in outcomes.items()
        for two in zip(*rows, strict=True)
    ]
    assert lost_and_gained(pairs) == ([3], [5])
