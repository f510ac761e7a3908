"""What an arm's missions add up to, alone and beside another arm's."""

import pytest

from dynastar.bench import pairs
from dynastar.bench.statistics import mcnemar, wilson


def row(number, outcome="arrived", length=30.0, time=60.0, **more):
    return {"number": number, "outcome": outcome, "length": length, "time": time, **more}


def by_number(*rows):
    return {row["number"]: row for row in rows}


BASE = by_number(
    row(0),
    row(2, length=40.0, time=100.0),
    row(4, "contact", contacts_moving=1),
    row(5, "timeout"),
    row(6, length=50.0, time=50.0),
)
ARM = by_number(
    row(0, length=33.0, time=90.0),
    row(2, "blocked", 5.0, 50.0),
    row(4, length=50.0, time=90.0),
    {"number": 5, "outcome": "error", "reason": "E: x"},
    row(6, length=50.0, time=100.0),
)


def test_totals_count_every_end_and_average_what_arrived():
    found = pairs.totals(ARM)
    assert (found["missions"], found["arrived"], found["blocked"], found["errors"]) == (5, 3, 1, 1)
    assert found["mean_time"] == pytest.approx(280.0 / 3)
    assert found["arrived_interval"] == wilson(3, 5)
    base = pairs.totals(BASE)
    assert (base["contacts_moving"], base["contacts_resting"], base["timeouts"]) == (1, 0, 1)
    assert base["touched_interval"] == base["contacts_moving_interval"] == wilson(1, 5)
    assert base["contacts_resting_interval"] == wilson(0, 5)
    assert pairs.totals(by_number(row(0, "error")))["mean_length"] is None


def test_an_arm_is_compared_in_the_worlds_of_its_base():
    found = pairs.beside(ARM, BASE)
    assert (found["lost"], found["gained"], found["common"]) == (1, 1, 2)
    assert found["p"] == mcnemar(1, 1)
    assert found["length_ratio"] == pytest.approx((1.1 + 1.0) / 2)
    assert found["time_ratio"] == pytest.approx((1.5 + 2.0) / 2)
    assert found["time_ratio_interval"] == pytest.approx((1.5, 2.0))
    assert not found["inert"]
    fewer = pairs.beside(ARM, by_number(BASE[2]))
    assert (fewer["lost"], fewer["gained"], fewer["length_ratio"]) == (1, 0, None)


def test_an_arrival_with_a_contact_is_no_success():
    touched = by_number(row(0, contacts_resting=1))
    assert pairs.beside(touched, BASE)["lost"] == 1


@pytest.mark.parametrize("change", [{"time": 60.1}, {"length": 30.1}, {"outcome": "timeout"}])
def test_an_arm_is_inert_if_no_outcome_length_or_time_differs(change):
    same = by_number(*({**row, "tick_ms_median": 1.0} for row in BASE.values()))
    assert pairs.beside(same, BASE)["inert"]
    assert not pairs.beside(same | {0: same[0] | change}, BASE)["inert"]
    assert not pairs.beside({}, BASE)["inert"]


def test_p_values_are_corrected_together():
    found = [{"p": 0.01}, {"p": 0.04}]
    pairs.correct(found)
    assert [of["p_holm"] for of in found] == pytest.approx([0.02, 0.04])


def test_numbers_in_words():
    assert [pairs.p_in_words(p) for p in (0.0004, 0.0316, 1.0)] == ["< 0.001", "0.032", "1.000"]
    assert pairs.interval_in_words((0.954, 0.999), 100.0, ".0f") == "95 to 100"
    assert pairs.interval_in_words(None, 1.0, ".2f") is None
