"""The tables of the scoreboard in docs/benchmarks.md, and a picture of each kind of failure.

A picture is that of a mission which is run again: `dynastar bench SUITE --replay N`.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image
from results_targets import with_interval

from dynastar.bench.scoreboard_tables import MOST_GROUPS
from dynastar.bench.selection import REPORT_SEEDS
from dynastar.bench.statistics import succeeded, totals

DOCS = Path(__file__).parent.parent / "docs"
PICTURES = DOCS / "media" / "benchmarks"
KINDS = {
    "moving": "contact while moving",
    "resting": "contact while standing still",
    "no progress": 'says "gave up: no progress"',
    "no way": "says that no way is left or leads to the goal",
    "timeout": "the time is up",
    "not right": "arrives, but not as it should",
    "wrong": "a wrong result of the search",
    "error": "an error",
}
NOT_DRAWN = ("wrong", "error")  # there is no drive to draw

Row = dict[str, Any]


def kind_of(row: Row) -> str:
    """Which kind of failure a row is, or "" where it is none."""
    if row.get("outcome") is None or succeeded(row):
        return ""
    if row["outcome"] in ("error", "wrong"):
        return row["outcome"]
    if row.get("contacts_moving") or row.get("contacts_resting"):
        return "moving" if row.get("contacts_moving") else "resting"
    if row["outcome"] == "arrived":
        return "not right"
    if row["outcome"] == "blocked":
        return "no progress" if "no progress" in row["reason"] else "no way"
    return "timeout"


def failures(suites: dict[str, Any]) -> dict[str, dict[str, list[int]]]:
    """Numbers of the missions that failed, by kind and suite."""
    found: dict[str, dict[str, list[int]]] = {}
    for name, suite in suites.items():
        for row in suite["rows"]:
            kind = kind_of(row)
            if kind:
                found.setdefault(kind, {}).setdefault(name, []).append(row["number"])
    return found


def failures_table(found: dict[str, dict[str, list[int]]]) -> str:
    """A line for each kind of failure, with its missions."""
    lines = ["| failures | missions | which |", "|---|---|---|"]
    for kind, words in KINDS.items():
        of = found.get(kind, {})
        if of:
            which = "; ".join(f"`{suite}` {', '.join(map(str, n))}" for suite, n in of.items())
            lines.append(f"| {words} | {sum(map(len, of.values()))} | {which} |")
    return "\n".join(lines)


def scoreboard(suites: dict[str, Any]) -> str:
    """A line for each suite and group, in columns that fit the site's width."""
    titles = ("", "succeeded", "95 %", "contacts", "timeouts", "score", "time ratio", "tick, ms")
    lines = [f"| {' | '.join(titles)} |", f"|:--{'|--:' * (len(titles) - 1)}|"]
    for name, suite in suites.items():
        lines.append(counts(f"`{name}`", suite))
        if 1 < len(suite["groups"]) <= MOST_GROUPS:
            lines += [
                counts(f"*{group.replace('_', ' ')}*", of) for group, of in suite["groups"].items()
            ]
    return "\n".join(lines)


def counts(name: str, of: dict[str, Any]) -> str:
    """A line of the scoreboard."""
    low, high = of["succeeded_interval"] or (0.0, 1.0)
    ticks = of["tick_ms_median"], of["tick_ms_p99"]
    cells = (
        name,
        f"{of['succeeded']} of {of['missions']}",
        f"{100 * low:.0f} to {100 * high:.0f}",
        f"{of['contacts_moving']}, {of['contacts_resting']}",
        f"{of['timeouts']}",
        "" if of["score"] is None else f"{of['score']:.3f}",
        "" if of["time_ratio"] is None else f"{of['time_ratio']:.2f}",
        "" if None in ticks else f"{ticks[0]:.1f}, {ticks[1]:.1f}",
    )
    return f"| {' | '.join(cells)} |"


def limits_table(suites: dict[str, Any]) -> str:
    """What limited the speed, as shares of the time driven, by suite."""
    of = {name: suite.get("limited") or {} for name, suite in suites.items()}
    times = {
        name: sum(row.get("time") or 0.0 for row in suite["rows"]) for name, suite in suites.items()
    }
    shares = {
        name: {what: 100.0 * seconds / times[name] for what, seconds in limited.items()}
        for name, limited in of.items()
        if times[name] > 0.0
    }
    names = sorted({what for share in shares.values() for what in share if share[what] >= 0.5})
    titles = [name.removeprefix("state: ").replace("_", " ") for name in names]
    lines = [f"| suite | {' | '.join(titles)} |", f"|---{'|---' * len(names)}|"]
    for suite, share in shares.items():
        if share:
            cells = " | ".join(f"{share.get(name, 0.0):.1f}" for name in names)
            lines.append(f"| `{suite}` | {cells} |")
    return "\n".join(lines)


def told(suite: dict[str, Any]) -> str:
    """Arrivals with their interval, contacts while moving and at rest, and the suite's own figure."""
    contacts = f"{suite['contacts_moving']}, {suite['contacts_resting']}"
    own = f"time ratio {suite['time_ratio']:.2f}" if suite["time_ratio"] else ""
    if suite["score"] is not None:
        own = f"score {suite['score']:.3f}"
    arrived = with_interval(suite["succeeded"], suite["missions"])
    return f"{arrived}, {contacts}{f', {own}' if own else ''}"


def beside(found: dict[str, Any], name: str) -> tuple[Any, dict[str, Any]]:
    """What the navigator and the other controllers came to in a suite's missions that all of them drove."""
    others = {other: of[name] for other, of in found["others"].items() if name in of}
    rows = found["suites"][name]["rows"]
    for of in others.values():
        driven = {row["number"] for row in of["rows"]}
        rows = [row for row in rows if row["number"] in driven]
    return totals(rows, 0), others


def controllers_table(found: dict[str, Any]) -> str:
    """The navigator and the other controllers in the same missions."""
    others = found["others"]
    titles = " | ".join(f"`{name}`" for name in (found["controller"], *others))
    lines = [f"| suite | {titles} |", f"|---|---{'|---' * len(others)}|"]
    for name in found["suites"]:
        ours, theirs = beside(found, name)
        if theirs:
            cells = [told(theirs[other]) if other in theirs else "" for other in others]
            lines.append(f"| `{name}` | {' | '.join([told(ours), *cells])} |")
    return "\n".join(lines)


def draw(suite: str, number: int, file: Path, size: int, colours: int) -> None:
    """Runs a mission of the report seed again and draws it, small."""
    command = [sys.executable, "-m", "dynastar", "bench", suite, "--replay", str(number)]
    command += ["--seed", str(REPORT_SEEDS), "--no-gif", "--out"]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*command, folder], stdout=subprocess.DEVNULL, check=True)
        with Image.open(Path(folder) / "figure.png") as picture:
            picture.thumbnail((size, size))
            small = picture.convert("RGB").quantize(colours)
    small.save(file, optimize=True)


def pictures(found: dict[str, dict[str, list[int]]]) -> str:
    """Draws the first mission of each kind, of the suite with most of them; the lines of the page."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    shown, drawn = [], set()
    for kind, words in KINDS.items():
        of = found.get(kind)
        if not of or kind in NOT_DRAWN:
            continue
        suite = max(of, key=lambda name: len(of[name]))
        name = f"{suite}-{of[suite][0]}.png"
        draw(suite, of[suite][0], PICTURES / name, 1000, 96)
        drawn.add(PICTURES / name)
        title = f"`{suite}` {of[suite][0]}: {words}."
        shown.append(f"![{title.replace('`', '')}](media/benchmarks/{name})\n\n*{title}*")
    for old in set(PICTURES.glob("*.png")) - drawn:
        old.unlink()
    return "\n\n".join(shown)
