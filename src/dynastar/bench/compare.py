"""Two results of the same missions side by side.

The verdict on a suite, in words, follows a rule:

1. Success is an arrival (or a right word that there is no way) without contact. If McNemar's exact test
   on the missions that only one of both succeeded in has p < 0.05, the one with more is better.
2. Otherwise, if both arrived in at least ``FEWEST`` missions and the 95 % bootstrap interval of the mean
   difference of their times leaves out 0, the faster one is better, unless it succeeded in fewer: a gain
   in time may be one of risk.
3. Otherwise the difference may be chance, and the number of missions is told that would show a
   difference of that size.

A change to the navigator counts by the first rule over all suites together.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from dynastar.bench.statistics import bootstrap, lost_and_gained, mcnemar, pairs_needed
from dynastar.config import shown
from dynastar.errors import DataError, InputError
from dynastar.io.files import MAX_TEXT_BYTES, jsonable, read_bytes

Row = Mapping[str, Any]
Result = Mapping[str, Any]

SIGNIFICANT = 0.05
FEWEST = 6  # pairs that say anything about time: 2 / 2^6 < 0.05
CONDITIONS = ("preset", "controller", "settings", "ideal", "attention", "legs")
COUNTS = (
    "missions",
    "succeeded",
    "contacts_moving",
    "contacts_resting",
    "bumps",
    "stops",
    "score",
    "time_ratio",
)
# Of results that do not name a condition.
EARLIER: Mapping[str, Any] = {"attention": "none", "legs": False}
SHOWN = 10  # numbers in a message
LARGEST = 1e12  # s or m in a row


def load_result(file: str | Path) -> dict[str, Result]:
    """The results in a JSON file of ``bench SUITE`` or ``bench all``, by suite; InputError."""
    path = Path(file)
    try:
        data = jsonable(json.loads(read_bytes(path, MAX_TEXT_BYTES, InputError)))
    except ValueError:
        raise InputError(f"{path}: this is not JSON") from None
    except RecursionError:
        raise DataError(
            f"{path}: is nested too deeply; expected the --json-out of `dynastar bench`"
        ) from None
    suites = data.get("suites", {str(data.get("suite")): data}) if isinstance(data, dict) else {}
    whole = isinstance(suites, dict) and all(
        isinstance(result, dict) and _is_rows(result.get("rows")) for result in suites.values()
    )
    if not (suites and whole):
        raise InputError(
            f"{path}: expected the --json-out of `dynastar bench SUITE` or `bench all`"
        )
    return suites


def compare(first: Mapping[str, Result], second: Mapping[str, Result]) -> dict[str, Any]:
    """The comparison of each suite that both have, of all, and the names of those that one lacks.

    Raises InputError if they share no suite, or if the missions of a suite differ.
    """
    shared = [name for name in first if name in second]
    if not shared:
        raise InputError(
            f"no suite is in both files: {', '.join(first)} in the first, {', '.join(second)} in the "
            "second"
        )
    alone = sorted(set(first).symmetric_difference(second))
    compared = {name: compare_suite(name, first[name], second[name]) for name in shared}
    return {"suites": compared, "together": _together(compared.values()), "not_compared": alone}


def _together(suites: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """The verdict on success over the missions of all suites."""
    missions, lost, gained = (
        sum(counts)
        for counts in zip(
            *((s["missions"], len(s["lost"]), len(s["gained"])) for s in suites), strict=True
        )
    )
    p = mcnemar(lost, gained)
    nothing = {"mean": None, "interval": None, "pairs": 0}
    return {
        "missions": missions,
        "p_success": p,
        "verdict": verdict((lost, gained, missions), p, nothing),
    }


def compare_suite(name: str, first: Result, second: Result) -> dict[str, Any]:
    """Changed outcomes, paired differences (second less first) and the verdict on one suite."""
    pairs = _paired(name, first["rows"], second["rows"])
    changed = [
        {
            "number": a["number"],
            "repeat": a.get("repeat", 0),
            "from": a["outcome"],
            "to": b["outcome"],
        }
        for a, b in pairs
        if a["outcome"] != b["outcome"]
    ]
    lost, gained = lost_and_gained(pairs)
    p, missions = mcnemar(len(lost), len(gained)), len({a["number"] for a, _ in pairs})
    time, length = _difference(pairs, "time"), _difference(pairs, "length")
    return {
        "missions": missions,
        "conditions": {
            key: [a, b]
            for key in CONDITIONS
            for a, b in [[of.get(key, EARLIER.get(key)) for of in (first, second)]]
            if a != b
        },
        "totals": {key: [first.get(key), second.get(key)] for key in COUNTS},
        "changed": changed,
        "lost": lost,
        "gained": gained,
        "p_success": p,
        "time": time,
        "length": length,
        "verdict": verdict((len(lost), len(gained), missions), p, time),
    }


def verdict(counts: tuple[int, int, int], p: float, time: Mapping[str, Any]) -> str:
    """Compare the second result with the first by the rule of this module, as a sentence.

    ``counts`` are the missions lost and gained, and all missions.
    """
    lost, gained, missions = counts
    changed = f"{gained} missions gained, {lost} lost (p = {p:.2g})"
    if p < SIGNIFICANT:
        return f"{'better' if gained > lost else 'worse'}: {changed}"
    interval = time["interval"]
    if time["pairs"] >= FEWEST and interval is not None and not interval[0] <= 0.0 <= interval[1]:
        word, how = ("better", "faster") if time["mean"] < 0.0 else ("worse", "slower")
        differ = f"{abs(time['mean']):.2f} s {how} on average"
        if (lost > gained) if word == "better" else (gained > lost):
            return f"undecided: {differ}, but {changed}"
        return f"{word}: {differ}, success alike (p = {p:.2g})"
    needed = pairs_needed(lost, gained, missions)
    if needed is None:
        return f"no difference: {changed}"
    return f"may be chance: {changed}; about {needed} missions would show a difference of that size"


def _paired(name: str, first: Sequence[Row], second: Sequence[Row]) -> list[tuple[Row, Row]]:
    """The rows of the same mission; InputError if a mission is in one of both alone."""
    left, right = ({_mission(row): row for row in rows} for rows in (first, second))
    for these, others, which in ((left, right, "first"), (right, left, "second")):
        missing = [mission for mission in these if mission not in others]
        if missing:
            named = ", ".join(map(_words, missing[:SHOWN]))
            more = f" and {len(missing) - SHOWN} more" if len(missing) > SHOWN else ""
            raise InputError(
                f"the missions of {name} do not match: only the {which} file has {named}{more}; run "
                "both with the same --missions, --select, --repeat and --seed"
            )
    pairs = [(left[mission], right[mission]) for mission in left]
    for a, b in pairs:
        for key in ("file", "group"):
            if a.get(key) != b.get(key):
                raise InputError(
                    f"the missions of {name} do not match: {_words(_mission(a))} is of {shown(a.get(key))} "
                    f"in the first file and of {shown(b.get(key))} in the second"
                )
    return pairs


def _mission(row: Row) -> tuple[int, int, int]:
    return row["number"], row.get("repeat", 0), row.get("seed", 0)


def _words(mission: tuple[int, int, int]) -> str:
    number, repeat, seed = mission
    return f"{number} (repeat {repeat}, seed {seed})"


def _difference(pairs: Sequence[tuple[Row, Row]], key: str) -> dict[str, Any]:
    """Second less first, where both arrived: mean, its 95 % interval, and the number of pairs.

    Of the repeats of a mission their mean counts.
    """
    found: dict[int, list[float]] = {}
    for a, b in pairs:
        both = a["outcome"] == b["outcome"] == "arrived"
        if both and a.get(key) is not None and b.get(key) is not None:
            found.setdefault(a["number"], []).append(b[key] - a[key])
    differences = [sum(one) / len(one) for one in found.values()]
    mean = sum(differences) / len(differences) if differences else None
    return {"mean": mean, "interval": bootstrap(differences), "pairs": len(differences)}


def _is_rows(rows: Any) -> bool:
    return isinstance(rows, list) and all(isinstance(row, dict) and _is_row(row) for row in rows)


def _is_row(row: Row) -> bool:
    counts = (row.get(key, 0) for key in ("number", "repeat", "seed"))
    values = (row.get(key) for key in ("time", "length"))
    return (
        "number" in row
        and isinstance(row.get("outcome"), str)
        and all(type(count) is int for count in counts)
        and all(value is None or _is_size(value) for value in values)
    )


def _is_size(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= LARGEST


def as_lines(compared: Mapping[str, Any]) -> list[str]:
    """The comparison as lines of text."""
    lines = []
    for name, suite in compared["suites"].items():
        lines += [f"{name}: {suite['verdict']}", *_suite_lines(suite), ""]
    if len(compared["suites"]) > 1:
        together = compared["together"]
        lines += [f"all suites, {together['missions']} missions: {together['verdict']}", ""]
    if compared["not_compared"]:
        lines += [f"in one file only, not compared: {', '.join(compared['not_compared'])}", ""]
    return lines[:-1]


def _suite_lines(suite: Mapping[str, Any]) -> list[str]:
    lines = [f"  {key}: {a} -> {b}" for key, (a, b) in suite["conditions"].items()]
    for key, (a, b) in suite["totals"].items():
        if a is not None or b is not None:
            lines.append(f"  {key}: {_number(a)} -> {_number(b)}")
    for key, unit in (("time", "s"), ("length", "m")):
        of = suite[key]
        if of["mean"] is not None:
            low, high = of["interval"] or (None, None)
            interval = f" [{_number(low, '+')}, {_number(high, '+')}]" if of["interval"] else ""
            lines.append(
                f"  {key}, where both arrived ({of['pairs']}): {_number(of['mean'], '+')} {unit}{interval}"
            )
    changes: dict[str, list[str]] = {}
    for change in suite["changed"]:
        repeat = f":{change['repeat']}" if change["repeat"] else ""
        changes.setdefault(f"{change['from']} -> {change['to']}", []).append(
            f"{change['number']}{repeat}"
        )
    return lines + [f"  {what}: {', '.join(numbers)}" for what, numbers in sorted(changes.items())]


def _number(value: float | None, sign: str = "") -> str:
    if value is None:
        return "-"
    return f"{value:{sign}.3f}" if isinstance(value, float) else str(value)
