"""The tables and pictures of other simulators in docs/benchmarks.md."""

from collections.abc import Iterable, Sequence
from statistics import fmean
from typing import Any

from results_targets import with_interval
from scoreboard_page import DOCS, draw

SIZE, COLOURS = 900, 200

Row = dict[str, Any]


def cell(rows: Sequence[Row]) -> str:
    """Arrivals with their interval, contacts by the robot's motion, and the mean time of arrivals."""
    times = [row["time"] for row in rows if row["outcome"] == "arrived"]
    moving, resting = (
        sum(row[f"contacts_{kind}"] for row in rows) for kind in ("moving", "resting")
    )
    mean = f", {fmean(times):.1f} s" if times else ""
    return f"{with_interval(len(times), len(rows))}, {moving}, {resting}{mean}"


def by_group(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Rows by group, in the order of the groups, and all of them."""
    names = dict.fromkeys(row["group"] for row in rows)
    return {name: [row for row in rows if row["group"] == name] for name in names} | {
        "all": list(rows)
    }


def table(head: str, columns: Iterable[str], lines: dict[str, list[str]]) -> str:
    """A table of Markdown."""
    parts = [[head, *columns], ["---"] * (1 + len(next(iter(lines.values()))))]
    parts += [[name, *cells] for name, cells in lines.items()]
    return "\n".join(f"| {' | '.join(part)} |" for part in parts)


def irsim_table(rows: Sequence[Row]) -> str:
    """A line for each kind of world."""
    lines = {}
    for name, of in by_group(rows).items():
        ratios = [row["time_ratio"] for row in of if row["time_ratio"]]
        clearance = min(row["min_clearance"] for row in of)
        lines[name] = [cell(of), f"{fmean(ratios):.2f}", f"{clearance:.2f} m"]
    return table("world", ("arrived", "time ratio", "smallest clearance"), lines)


def navground_table(rows: Sequence[Row]) -> str:
    """A line for each behavior in the robot's place."""
    groups = by_group(rows)
    lines = {}
    for behavior in ("dynastar", *rows[0]["beside"]):
        cells = []
        for of in groups.values():
            found = of if behavior == "dynastar" else [row["beside"][behavior] for row in of]
            cells.append(cell(found))
        efficacy = fmean(row["efficacy"] for row in found)
        deadlocks = sum(row["deadlock"] for row in found)
        lines[behavior] = [*cells, f"{efficacy:.2f}", str(deadlocks)]
    return table("behavior", (*groups, "efficacy", "deadlocks"), lines)


def irsim(result: Row) -> str:
    """The table of ir-sim; draws its picture."""
    draw("irsim", 3, DOCS / "media" / "ir-sim.png", SIZE, COLOURS)
    return irsim_table(result["rows"])


def navground(result: Row) -> str:
    """The table of navground and what it says of times; draws its picture."""
    draw("navground", 5, DOCS / "media" / "navground.png", SIZE, COLOURS)
    return f"{navground_table(result['rows'])}\n\n{navground_times(result['rows'])}"


def navground_times(rows: Sequence[Row]) -> str:
    """A sentence with the mean time of dynastar, and those of the behaviors."""
    means = []
    for of in (rows, *([row["beside"][name] for row in rows] for name in rows[0]["beside"])):
        means.append(fmean(row["time"] for row in of if row["outcome"] == "arrived"))
    return (
        f"dynastar takes {means[0]:.1f} s and these behaviors {min(means[1:]):.1f} to "
        f"{max(means[1:]):.1f} s in the mean: it plans for agents who do not give way."
    )
