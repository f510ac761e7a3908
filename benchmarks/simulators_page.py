"""Fills the tables of other simulators in docs/benchmarks.md, and draws their pictures.

    dynastar bench irsim --json-out irsim.json
    dynastar bench navground --json-out navground.json
    python benchmarks/simulators_page.py irsim.json navground.json

A picture is that of a mission which is run again: `dynastar bench SUITE --replay N`.
"""

import argparse
import json
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

from PIL import Image
from scoreboard_page import DOCS, PAGE, bench, filled

SHOWN = {"irsim": (3, "ir-sim"), "navground": (5, "navground")}  # mission and name of the picture
SIZE, COLOURS = (900, 900), 200

Row = dict[str, Any]


def cell(rows: Sequence[Row]) -> str:
    """Arrivals, contacts by the robot's motion, and the mean time of arrivals."""
    times = [row["time"] for row in rows if row["outcome"] == "arrived"]
    moving, resting = (
        sum(row[f"contacts_{kind}"] for row in rows) for kind in ("moving", "resting")
    )
    mean = f", {fmean(times):.1f} s" if times else ""
    return f"{len(times)} of {len(rows)} ({moving}, {resting}){mean}"


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


def draw(suite: str) -> None:
    """Draws the picture of a suite, small."""
    number, name = SHOWN[suite]
    with tempfile.TemporaryDirectory() as folder:
        bench(suite, "--replay", str(number), "--out", folder, "--no-gif")
        with Image.open(Path(folder) / "figure.png") as picture:
            picture.thumbnail(SIZE)
            small = picture.convert("RGB").quantize(COLOURS)
    small.save(DOCS / "media" / f"{name}.png", optimize=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("irsim", type=Path, help="result of the suite irsim")
    parser.add_argument("navground", type=Path, help="result of the suite navground")
    arguments = parser.parse_args()
    page = PAGE.read_text(encoding="utf-8")
    for suite, write in (("irsim", irsim_table), ("navground", navground_table)):
        rows = json.loads(getattr(arguments, suite).read_text(encoding="utf-8"))["rows"]
        page = filled(page, suite, write(rows))
        draw(suite)
    PAGE.write_text(page, encoding="utf-8")
