"""What is minimised: failures first, then time, then smoothness.

The loss of a mission is relative to the default settings in the same world::

    loss = 1000 [failed] + time / time of the default + 0.02 smoothness / smoothness of the default

with both ratios at most 5, and 1 where one of both failed. A search drives at most ``MOST_WORLDS``, so
no gain in time outweighs a failure; the third term moves the loss by 0.1 at most.
"""

from collections.abc import Mapping
from typing import Any

from dynastar.bench.statistics import rightly_blocked, succeeded

Row = Mapping[str, Any]

FAILURE = 1000.0
SMOOTHNESS = 0.02
LARGEST_RATIO = 5.0
MOST_WORLDS = 190


def loss(row: Row, default: Row) -> float:
    """The loss of a mission, given the row of the default settings in the same world."""
    failed = not succeeded(row)
    if failed or not succeeded(default):
        return FAILURE * failed + 1.0 + SMOOTHNESS
    time, smoothness = (_ratio(row, default, key) for key in ("time", "smoothness"))
    return (1.0 if rightly_blocked(row) else time) + SMOOTHNESS * smoothness


def _ratio(row: Row, default: Row, key: str) -> float:
    """A quantity over that of the default settings; 1 where it is not known."""
    own, other = row.get(key), default.get(key)
    return min(own / other, LARGEST_RATIO) if own is not None and other else 1.0
