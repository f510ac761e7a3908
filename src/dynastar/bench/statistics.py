"""What the rows of a suite add up to, with intervals."""

import math
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

Row = Mapping[str, Any]
Interval = tuple[float, float]

RESAMPLES = 9_999
ALPHA, POWER = 0.05, 0.8  # of the sample size for a difference between pairs

QUALITY = (  # of a row, averaged over the missions that arrived
    *("smoothness", "angular_acceleration", "omega_changes", "jerk", "circles", "turning_angle"),
    *("nearest", "within_0_2", "within_0_45"),
)


def wilson(successes: int, trials: int) -> Interval | None:
    """Wilson's 95 % score interval of a proportion [Wilson1927]; None without trials."""
    if trials == 0:
        return None
    from scipy.stats import binomtest

    found = binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    return float(found.low), float(found.high)


def mcnemar(only_first: int, only_second: int) -> float:
    """Two-sided p of McNemar's exact test [McNemar1947].

    Of the pairs that differ, ``only_first`` are successes of the first alone, ``only_second`` of the
    second.
    """
    from scipy.stats import binomtest

    n = only_first + only_second
    return float(binomtest(only_first, n).pvalue) if n else 1.0


def lost_and_gained(pairs: Iterable[tuple[Row, Row]]) -> tuple[list[int], list[int]]:
    """Numbers of the missions in which the first, and the second, of two results succeeded more often.

    A pair is the rows of one run, as ``mcnemar`` compares them. The repeats of a mission are no missions of
    their own, and count together.
    """
    more: dict[int, int] = {}  # by number, the runs in which only the second succeeded
    for first, second in pairs:
        number = first["number"]
        more[number] = more.get(number, 0) + succeeded(second) - succeeded(first)
    lost = [number for number, by in more.items() if by < 0]
    return lost, [number for number, by in more.items() if by > 0]


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's correction of p values for the number of tests [Holm1979], in the order given."""
    order = sorted(range(len(p_values)), key=lambda at: p_values[at])
    corrected, largest = [1.0] * len(p_values), 0.0
    for rank, at in enumerate(order):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[at]))
        corrected[at] = largest
    return corrected


def pairs_needed(only_first: int, only_second: int, pairs: int) -> int | None:
    """How many pairs would show a difference of that size, by the sample size of [Connor1987].

    With p < 0.05, two-sided, in 80 % of samples; None where there is no difference.
    """
    if only_first == only_second:
        return None
    from scipy.stats import norm

    differ, by = (only_first + only_second) / pairs, abs(only_first - only_second) / pairs
    spread = norm.ppf(1.0 - 0.5 * ALPHA) * differ**0.5 + norm.ppf(POWER) * (differ - by**2) ** 0.5
    return math.ceil((spread / by) ** 2)


def bootstrap(values: Sequence[float], of: Callable[..., Any] = np.mean) -> Interval | None:
    """95 % interval of the mean by the percentiles of resampled means; None under two values.

    ``of`` is another function of the values than the mean, as NumPy has them.

    Seeded, so that the same values give the same interval.
    """
    if len(values) < 2:
        return None
    from scipy.stats import bootstrap as resample

    random = np.random.default_rng(0)
    found = resample(
        (values,), of, n_resamples=RESAMPLES, method="percentile", random_state=random
    ).confidence_interval
    return float(found.low), float(found.high)


def succeeded(row: Row) -> bool:
    """Whether a mission ended as it should: arrived, or rightly said that there is no way.

    Without contact, and ``right`` where the suite judges more than the end.
    """
    touched = row.get("contacts_moving") or row.get("contacts_resting")
    ended = row["outcome"] == "arrived" or rightly_blocked(row)
    return bool(ended and not touched and row.get("right", True))


def rightly_blocked(row: Row) -> bool:
    """Whether the robot said that there is no way, and that is true."""
    return row["outcome"] == "blocked_rightly" or bool(row.get("blocked_rightly"))


def totals(rows: Sequence[Row], skipped: int) -> dict[str, Any]:
    """Totals of a suite's rows, also for each group, and the ``rows`` themselves.

    Means and ``time_ratio`` are over the missions that arrived; None where there is nothing to
    average. ``score`` is over all missions, 0 for one that has none, and None for a suite without.
    Intervals are fractions of the missions. Ticks are medians over the missions. ``limited`` has
    seconds by cause.
    """
    names = dict.fromkeys(str(row["group"]) for row in rows if row.get("group"))
    groups = {
        name: _sums([row for row in rows if str(row.get("group", "")) == name]) for name in names
    }
    sums = _sums(rows)
    first = {"missions": sums.pop("missions"), "skipped": skipped}
    return {**first, **sums, "groups": groups, "rows": list(rows)}


def _sums(rows: Sequence[Row]) -> dict[str, Any]:
    arrived = [row for row in rows if row["outcome"] == "arrived"]
    moving, resting = (
        _count(rows, lambda row, kind=kind: bool(row.get(f"contacts_{kind}")))  # type: ignore[misc]
        for kind in ("moving", "resting")
    )
    success = _count(rows, succeeded)
    scores = [row.get("score") for row in rows]
    has_score = any(score is not None for score in scores)
    return {
        "missions": len(rows),
        "arrived": len(arrived),
        "blocked_rightly": _count(rows, rightly_blocked),
        "succeeded": success,
        "contacts_moving": moving,
        "contacts_resting": resting,
        "bumps": sum(row.get("bumps") or 0 for row in rows),
        "stops": sum(row.get("stops") or 0 for row in rows),
        "timeouts": _count(rows, lambda row: row["outcome"] == "timeout"),
        "errors": _count(rows, lambda row: row["outcome"] == "error"),
        "arrived_interval": wilson(len(arrived), len(rows)),
        "succeeded_interval": wilson(success, len(rows)),
        "contacts_moving_interval": wilson(moving, len(rows)),
        "contacts_resting_interval": wilson(resting, len(rows)),
        "score": statistics.fmean(score or 0.0 for score in scores) if has_score else None,
        "mean_length": _mean(arrived, "length"),
        "mean_time": _mean(arrived, "time"),
        "time_ratio": _mean(arrived, "time_ratio"),
        **{f"mean_{key}": _mean(arrived, key) for key in QUALITY},
        "tick_ms_median": _median(rows, "tick_ms_median"),
        "tick_ms_p99": _median(rows, "tick_ms_p99"),
        "limited": seconds_by_cause(row.get("limited") or {} for row in rows),
    }


def seconds_by_cause(tables: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """The sum of tables of seconds by cause, the largest first."""
    total: dict[str, float] = {}
    for table in tables:
        for cause, seconds in table.items():
            total[cause] = total.get(cause, 0.0) + seconds
    ordered = sorted(total.items(), key=lambda item: (-item[1], item[0]))
    return {cause: round(seconds, 3) for cause, seconds in ordered}


def _count(rows: Sequence[Row], holds: Callable[[Row], bool]) -> int:
    return sum(map(holds, rows))


def _present(rows: Sequence[Row], key: str) -> list[float]:
    return [row[key] for row in rows if row.get(key) is not None]


def _mean(rows: Sequence[Row], key: str) -> float | None:
    values = _present(rows, key)
    return statistics.fmean(values) if values else None


def _median(rows: Sequence[Row], key: str) -> float | None:
    values = _present(rows, key)
    return statistics.median(values) if values else None
