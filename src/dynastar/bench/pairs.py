"""What the missions of an arm add up to, alone and beside its base in the same worlds."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dynastar.bench.statistics import (
    Interval,
    bootstrap,
    holm,
    lost_and_gained,
    mcnemar,
    wilson,
)

Row = Mapping[str, Any]
ByNumber = Mapping[int, Row]

ALIKE = ("outcome", "length", "time")  # equal in every world: an arm is inert
ENDS = {"timeouts": "timeout", "blocked": "blocked", "errors": "error"}


def totals(driven: ByNumber) -> dict[str, Any]:
    """Outcomes and contacts of an arm, with Wilson's intervals of their share of the missions.

    Means are over the missions that arrived; None if none did.
    """
    rows = list(driven.values())
    arrived = [row for row in rows if row["outcome"] == "arrived"]
    moving, resting = (
        sum(bool(row.get(f"contacts_{kind}")) for row in rows) for kind in ("moving", "resting")
    )
    counts = {name: sum(row["outcome"] == end for row in rows) for name, end in ENDS.items()}
    means = {
        f"mean_{what}": float(np.mean([row[what] for row in arrived])) if arrived else None
        for what in ("length", "time")
    }
    return {
        "missions": len(rows),
        "arrived": len(arrived),
        "arrived_interval": wilson(len(arrived), len(rows)),
        "contacts_moving": moving,
        "contacts_moving_interval": wilson(moving, len(rows)),
        "contacts_resting": resting,
        "contacts_resting_interval": wilson(resting, len(rows)),
        "touched_interval": wilson(moving + resting, len(rows)),
        **counts,
        **means,
    }


def beside(driven: ByNumber, base: ByNumber) -> dict[str, Any]:
    """An arm beside its base, world by world.

    ``lost`` and ``gained`` count the worlds in which only the base, and only the arm, succeeded;
    ``p`` is McNemar's exact test of these. ``inert``: all outcomes, times and lengths are equal.
    ``common`` counts the worlds in which both arrived; ``length_ratio`` and ``time_ratio`` are means
    over these, with bootstrap intervals.
    """
    pairs = [(base[number], row) for number, row in driven.items() if number in base]
    lost, gained = map(len, lost_and_gained(pairs))
    common = [pair for pair in pairs if all(row["outcome"] == "arrived" for row in pair)]
    ratios = {what: [b[what] / a[what] for a, b in common] for what in ("length", "time")}
    return {
        "lost": lost,
        "gained": gained,
        "p": mcnemar(lost, gained),
        "inert": bool(pairs) and all(a.get(w) == b.get(w) for a, b in pairs for w in ALIKE),
        "common": len(common),
        **{f"{what}_ratio": float(np.mean(of)) if of else None for what, of in ratios.items()},
        **{f"{what}_ratio_interval": bootstrap(of) for what, of in ratios.items()},
    }


def correct(compared: Sequence[dict[str, Any]]) -> None:
    """Add ``p_holm`` to what ``beside`` found, corrected for all of the comparisons."""
    for found, p in zip(compared, holm([found["p"] for found in compared]), strict=True):
        found["p_holm"] = p


def p_in_words(p: float) -> str:
    """A p value as the tables have it."""
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def interval_in_words(interval: Interval | None, times: float, format_: str) -> str | None:
    """An interval as the tables have it, in a unit ``times`` as small."""
    if interval is None:
        return None
    low, high = (format(times * end, format_) for end in interval)
    return f"{low} to {high}"


def median_in_words(values: Sequence[float]) -> str:
    """A median with its bootstrap interval, as the tables have it."""
    interval = interval_in_words(bootstrap(values, np.median), 1.0, ".3f")
    return f"{np.median(values):.3f}" + (f" ({interval})" if interval else "")
