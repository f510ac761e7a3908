"""A mission with a limit of wall time."""

import os
import time

from dynastar.bench.bounded import row_within


def test_a_row_comes_back():
    assert row_within(600.0, lambda: {"outcome": "arrived", "x": 1}) == {
        "outcome": "arrived",
        "x": 1,
    }


def test_what_raises_is_an_error():
    row = row_within(600.0, lambda: {"outcome": 1 / 0})
    assert row["outcome"] == "error"
    assert "ZeroDivisionError" in row["reason"]


def test_what_hangs_is_an_error():
    row = row_within(0.3, lambda: time.sleep(60.0) or {})
    assert row == {"outcome": "error", "reason": "no answer within 0.3 s of wall time"}


def test_a_process_that_dies_is_an_error():
    row = row_within(600.0, lambda: os._exit(3))
    assert row == {"outcome": "error", "reason": "the process ended without an answer"}
