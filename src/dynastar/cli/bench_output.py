"""The result of a suite, as ``dynastar bench`` prints it."""

import sys
from collections.abc import Mapping, Sequence
from typing import Any

from dynastar.bench.statistics import succeeded
from dynastar.bench.tables import Cell, Table, as_text
from dynastar.cli.show import as_json, as_table
from dynastar.terminal import printable

SHOWN_FAILURES = 20
SHOWN_REASONS = 5
NOT_SHOWN = ("rows", "groups", "published", "comparable", "settings", "limited", "skip_reasons")
OF_GROUPS = {
    "missions": "d",
    "succeeded": "d",
    "contacts_moving": "d",
    "contacts_resting": "d",
    "score": ".3f",
    "time_ratio": ".2f",
}
LATE = ("bumps", "stops")  # of walkers who notice the robot late


def print_result(result: Mapping[str, Any]) -> None:
    """Print the totals of a suite, its groups, the published figures and the missions that failed."""
    shown = {name: value for name, value in result.items() if name not in NOT_SHOWN}
    for name, value in shown.items():
        if name.endswith("_interval"):
            shown[name] = None if value is None else f"{value[0]:.3f} to {value[1]:.3f}"
    if result["settings"]:
        shown["settings"] = as_json(result["settings"])
    print(as_table(shown))
    print("An interval has the true fraction of missions in it with 95 % confidence (Wilson).")
    for reason, count in list(result["skip_reasons"].items())[:SHOWN_REASONS]:
        print(f"skipped, not counted as missions: {count}: {printable(reason)}")
    if len(result["skip_reasons"]) > SHOWN_REASONS:
        print(f"and {len(result['skip_reasons']) - SHOWN_REASONS} more reasons")
    if result["limited"]:
        seconds = (f"{cause} {spent:.0f} s" for cause, spent in result["limited"].items())
        print(f"limited by: {', '.join(seconds)}")
    if len(result["groups"]) > 1:
        keys = {**OF_GROUPS, **{key: "d" for key in LATE if result[key]}}
        lines: list[tuple[Cell, ...]] = [
            (name, *(of[key] for key in keys)) for name, of in result["groups"].items()
        ]
        columns = (("group", ""), *keys.items())
        print(f"\n{as_text(Table('groups', '', columns, lines))}")
    for published in result["published"]:
        print(f"published: {published['label']}: {published['figure']} [{published['source']}]")
    if result["comparable"]:
        print(result["comparable"])
    _print_failures(result["rows"])


def _print_failures(rows: Sequence[Mapping[str, Any]]) -> None:
    failed = [row for row in rows if not succeeded(row)]
    for row in failed[:SHOWN_FAILURES]:
        reason = (row.get("reason") or "no reason given").partition("\n")[0]
        repeat = f":{row['repeat']}" if row.get("repeat") else ""
        judged = ", but not as the suite asks" if row.get("right") is False else ""
        print(f"mission {row['number']}{repeat}: {row['outcome']}{judged}, {reason}")
    if len(failed) > SHOWN_FAILURES:
        print(f"and {len(failed) - SHOWN_FAILURES} more that failed")
    if failed:
        print("run one again with --replay and its number", file=sys.stderr)
