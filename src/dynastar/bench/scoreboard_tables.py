"""What the result of all suites comes to in tables: counts, and how each controller drove."""

from collections.abc import Mapping
from typing import Any

from dynastar.bench.statistics import QUALITY
from dynastar.bench.tables import Cell, Table

MOST_GROUPS = 12  # lines of a suite's groups in the table

Result = Mapping[str, Any]


def table(result: Result) -> Table:
    """A line for each suite, for each of its groups, and for each other controller."""
    lines: list[tuple[Cell, ...]] = []
    for name, suite in result["suites"].items():
        lines.append(_line(name, suite))
        groups = suite["groups"]
        if 1 < len(groups) <= MOST_GROUPS:
            lines += [_line(f"  {group}", of) for group, of in groups.items()]
        lines += [_line(f"  by {controller}", of) for controller, of in _others(result, name)]
    left = "".join(f"\n{name} was left out: {why}" for name, why in result["left_out"].items())
    return Table(
        "scoreboard",
        "All suites" + (", quick" if result["quick"] else ""),
        (
            ("", ""),
            ("missions", "d"),
            ("succeeded", "d"),
            ("95 %", ""),
            ("moving", "d"),
            ("resting", "d"),
            ("bumps", "d"),
            ("stops", "d"),
            ("timeouts", "d"),
            ("score", ".3f"),
            ("time ratio", ".2f"),
            ("tick ms", ".1f"),
            ("p99 ms", ".1f"),
            ("CPU s", ".0f"),
        ),
        lines,
        "Succeeded: arrived, or rightly said that there is no way, without contact; with Wilson's interval "
        "in per cent. Moving, resting: contacts by the robot's motion. Bumps: touches by walkers while the "
        "robot did not move towards them; stops: walkers who stopped for it; both end no mission. Time "
        "ratio: mean over arrivals of the time over the time bound. Ticks: medians over the missions. By: "
        "another controller in the same missions." + left,
    )


def quality_table(result: Result) -> Table:
    """How smoothly each controller drove in each suite, and how near to moving obstacles."""
    lines: list[tuple[Cell, ...]] = []
    for name, suite in result["suites"].items():
        both = [(name, suite), *((f"  by {other}", of) for other, of in _others(result, name))]
        lines += [_quality(label, of) for label, of in both if of["mean_smoothness"] is not None]
    return Table(
        "quality",
        "Smoothness, and gaps to moving obstacles",
        (
            ("", ""),
            ("rad/s/m", ".2f"),
            ("rad/s2", ".2f"),
            ("swings/m", ".2f"),
            ("jerk m/s3", ".2f"),
            ("circles", ".2f"),
            ("turned rad", ".1f"),
            ("nearest m", ".2f"),
            ("< 0.2 m %", ".1f"),
            ("< 0.45 m %", ".1f"),
        ),
        lines,
        "Means over arrivals. rad/s/m: variation of the turning rate per metre. rad/s2: RMS of the angular "
        "acceleration. Swings: sign changes of the turning rate. Jerk: RMS. Circles: turns by 270 degrees "
        "in a mission. Turned: all that the heading has turned. Nearest: the smallest gap to a moving "
        "obstacle, and per cent of the time with a gap under 0.2 m and 0.45 m.",
    )


def _others(result: Result, suite: str) -> list[tuple[str, Result]]:
    """Results of the other controllers in a suite, by controller."""
    return [(name, of[suite]) for name, of in result["others"].items() if suite in of]


def _quality(label: str, of: Result) -> tuple[Cell, ...]:
    *means, close, less_close = (of[f"mean_{key}"] for key in QUALITY)
    return (label, *means, *(None if f is None else 100.0 * f for f in (close, less_close)))


def _line(name: str, of: Result) -> tuple[Cell, ...]:
    low, high = of["succeeded_interval"] or (0.0, 1.0)
    return (
        name,
        of["missions"],
        of["succeeded"],
        f"{100 * low:.0f}-{100 * high:.0f}",
        of["contacts_moving"],
        of["contacts_resting"],
        of["bumps"] or None,
        of["stops"] or None,
        of["timeouts"],
        *(of[key] for key in ("score", "time_ratio", "tick_ms_median", "tick_ms_p99")),
        of.get("cpu_s"),
    )
