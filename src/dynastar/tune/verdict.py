"""The final word on a setting: better than the default in worlds that the search has not seen, or not.

The statistics are those of ``bench compare``: McNemar's test on successes first, then the bootstrap
interval of the mean difference of times.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from dynastar.bench.compare import verdict
from dynastar.bench.statistics import bootstrap, mcnemar, succeeded
from dynastar.config import counted
from dynastar.tune.state import Row, State


@dataclass(frozen=True)
class Verdict:
    """The comparison of the best setting with the default in the worlds of the report seeds.

    ``ratio`` is the mean ratio of times where both arrived, and ``interval`` its 95 % interval.
    """

    better: bool
    words: str
    worlds: int = 0
    lost: int = 0
    gained: int = 0
    ratio: float | None = None
    interval: tuple[float, float] | None = None


def judged(state: State, again: Sequence[str] = ()) -> Verdict:
    """The verdict on the best setting of a search.

    ``again`` are the suites whose worlds are those of the search again, which the words then say.
    """
    tried = len(state.finished) - 1
    best = state.best
    if best is None or best is state.trials[0]:
        settings = counted(tried, "setting") or "0 settings"
        return Verdict(False, f"nothing better than the default was found in {settings}")
    found = compared(state.report_default, state.report_tuned)
    if not again:
        return found
    which = f"; the worlds of {', '.join(again)} are those of the search again, with other noise"
    return replace(found, words=found.words + which)


def compared(default: Sequence[Row], tuned: Sequence[Row]) -> Verdict:
    """The verdict on rows of the same worlds."""
    pairs = list(zip(default, tuned, strict=True))
    lost = sum(succeeded(a) and not succeeded(b) for a, b in pairs)
    gained = sum(succeeded(b) and not succeeded(a) for a, b in pairs)
    both = [(a, b) for a, b in pairs if a["outcome"] == b["outcome"] == "arrived"]
    differences = [b["time"] - a["time"] for a, b in both]
    ratios = [b["time"] / a["time"] for a, b in both]
    time: dict[str, Any] = {
        "mean": sum(differences) / len(differences) if differences else None,
        "interval": bootstrap(differences),
        "pairs": len(differences),
    }
    words = verdict((lost, gained, len(pairs)), mcnemar(lost, gained), time)
    ratio = sum(ratios) / len(ratios) if ratios else None
    interval = bootstrap(ratios)
    better = words.startswith("better")
    heading = "better than the default" if better else "not shown to be better than the default"
    shown = ""
    if ratio is not None and interval is not None:
        low, high = (100.0 * (end - 1.0) for end in interval)
        shown = (
            f"; time {100.0 * (ratio - 1.0):+.1f} %, 95 % interval {low:+.1f} to {high:+.1f} %, "
            f"in the {len(both)} worlds in which both arrived"
        )
    why = words.removeprefix("better: ")
    text = f"{heading}, in {len(pairs)} worlds of report seeds: {why}{shown}"
    return Verdict(better, text, len(pairs), lost, gained, ratio, interval)
