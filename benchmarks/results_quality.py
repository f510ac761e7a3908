"""Tables of docs/benchmarks.md of how smoothly the robot drives, and how near to people."""

from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Any

import numpy as np
from results_parts import MAPS_BESIDE
from results_tables import table

from dynastar.bench.pairs import interval_in_words
from dynastar.bench.statistics import bootstrap

Found = Mapping[str, Any]  # the result of each part

QUALITY = {
    "smoothness": "rad/s/m",
    "angular_acceleration": "rad/s2",
    "omega_changes": "1/m",
    "jerk": "m/s3",
    "circles": "in a mission",
    "nearest": "m",
    "turning_angle": "rad",
    "min_clearance": "m",
    "within_0_2": "of the time",
    "within_0_45": "of the time",
    "time": "s",
}
SMOOTH = ("smoothness", "angular_acceleration", "omega_changes")
SMOOTHEST = 1.2  # times pure_pursuit's, at most
NEAR = {  # of docs/benchmarks.md: factor and format of each figure
    "nearest": (1.0, ".2f"),
    "within_0_2": (100.0, ".1f"),
    "within_0_45": (100.0, ".1f"),
    "turning_angle": (1.0, ".1f"),
    "omega_changes": (1.0, ".2f"),
    "angular_acceleration": (1.0, ".2f"),
    "jerk": (1.0, ".2f"),
    "circles": (1.0, ".2f"),
}
AMONG_PEOPLE = (
    "people_late",
    "people_none",
    "people_reactive",
    "crowd_late",
    "crowd_none",
    "crowdnav",
)


def quality_table(found: Found) -> str:
    """Means of the navigator and of `pure_pursuit` in `maps`, over missions in which both arrived."""
    pairs = [
        pair
        for pair in zip(found["maps"]["rows"], found[MAPS_BESIDE]["rows"], strict=True)
        if all(row["outcome"] == "arrived" for row in pair)
    ]
    lines = []
    for key, unit in QUALITY.items():
        known = [[row[key] for row in pair] for pair in pairs]
        known = [pair for pair in known if None not in pair]
        if not known:
            lines.append((f"`{key}`, {unit}", "", "", "", ""))
            continue
        ours, other = (fmean(values) for values in zip(*known, strict=True))
        met = f"{'met' if ours <= SMOOTHEST * other else 'missed'}" if key in SMOOTH else ""
        lines.append((f"`{key}`, {unit}", f"{ours:.2f}", f"{other:.2f}", _ratio(known), met))
    head = (f"means of {len(pairs)} missions", "`navigator`", "`pure_pursuit`", "ratio (95 %)")
    return table((*head, f"at most {SMOOTHEST}"), lines)


def _ratio(pairs: Sequence[Sequence[float]]) -> str:
    """The ratio of the means of pairs, with its bootstrap interval over the missions."""
    ours, other = np.array(pairs, dtype=np.float64).T
    if other.mean() <= 0.0:
        return ""

    def of_means(drawn: Any, axis: int) -> Any:
        missions = drawn.astype(int)
        below = other[missions].mean(axis)
        infinite = np.full(below.shape, np.inf)
        return np.divide(ours[missions].mean(axis), below, out=infinite, where=below > 0.0)

    ratio = f"{ours.mean() / other.mean():.2f}"
    with np.errstate(invalid="ignore"):  # of scipy's standard error, which is not used
        ends = bootstrap(range(len(ours)), of_means)
    return ratio if ends is None else f"{ratio} ({ends[0]:.2f} to {ends[1]:.2f})"


def near_table(found: Found) -> str:
    """How near to people, and how smoothly, with intervals: means over the missions that arrived."""
    lines = []
    for part in (part for part in AMONG_PEOPLE if part in found):
        rows = [row for row in found[part]["rows"] if row["outcome"] == "arrived"]
        cells = []
        for key, (times, format_) in NEAR.items():
            values = [times * row[key] for row in rows if row.get(key) is not None]
            interval = interval_in_words(bootstrap(values), 1.0, format_)
            cells.append(f"{fmean(values):{format_}}" + (f" ({interval})" if interval else ""))
        lines.append((f"`{part}`", str(len(rows)), *cells))
    head = ("part", "missions", "nearest, m", "under 0.2 m, %", "under 0.45 m, %", "turned, rad")
    return table((*head, "sign changes, 1/m", "rad/s2, RMS", "jerk, m/s3", "circles"), lines)
