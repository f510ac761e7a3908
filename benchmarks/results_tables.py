"""Tables of docs/benchmarks.md and README.md that are made of the results of several parts."""

import re
from collections.abc import Iterable, Mapping, Sequence
from statistics import fmean
from typing import Any

from contact_causes import CAUSES, PARTS, rows_of
from results_parts import INDIFFERENT
from results_targets import contacts_of, counted, with_interval
from scoreboard_page import beside

from dynastar.bench.pairs import interval_in_words
from dynastar.bench.statistics import totals, wilson

Result = Mapping[str, Any]
Found = Mapping[str, Any]  # the result of each part

LABELS = {"pure_pursuit": "pure pursuit", "kompass_dwa": "kompass DWA", "orca": "ORCA"}
CROWDNAV = """\
| ORCA [Chen2019] | 0.43 | | 0.57 | 10.9 |
{orca}
| CADRL [Chen2019] | 0.78 | | 0.22 | 10.8 |
| LSTM-RL [Chen2019] | 0.95 | | 0.03 | 11.8 |
| SARL [Chen2019] | 0.99 | | 0.01 | 10.6 |
| OM-SARL [Chen2019] | 1.00 | | 0.00 | 10.5 |
{navigator}
{told}"""
VARIANTS = {
    "circle": "",
    "square": ": a square of 10 m",
    "visible": ": people see the robot",
    "ten": ": ten people",
    "some_see": ": each sees it with probability 0.2",
    "told": ": `circle`, positions and velocities told",
    "orca": ": ORCA in the robot's place, on the circle",
}
SLOW = """\
| | easy | medium | hard | all |
|---|---|---|---|---|
| DWA [DynaBARN] | 0.78 | 0.43 | 0.17 | |
| TD3 [DynaBARN] | 0.74 | 0.60 | 0.28 | |
| Dyna-LfLH [DynaLfLH] | | | | 0.225 |
| LfH-CP [DynaLfLH] | | | | 0.308 |
"""
MOTIONS = ("moving", "resting")
COMPARED = {  # lines of the README: its suite of the scoreboard
    "BARN: static clutter (1)": "barn",
    "DynaBARN: fast discs (1)": "dynabarn",
    "real maps, unmapped boxes, walkers (1)": "maps",
    "people who notice the robot late, or react (1)": "people",
}
WHOLE = {  # the parts that drove all missions of a suite of the scoreboard
    "barn": ("barn",),
    "dynabarn": ("dynabarn",),
    "maps": ("maps",),
    "people": ("people_late", "people_reactive"),
}


def table(head: Sequence[str], lines: Iterable[Sequence[str]], left: bool = False) -> str:
    """A table of Markdown."""
    rule = [":--" if left else "---"] * len(head)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *lines))


def attention_table(found: Found) -> str:
    """The same missions with both models of what people do about the robot."""
    lines = []
    for suite in ("people", "crowd"):
        for attention in ("none", "late"):
            of = found[f"{suite}_{attention}"]
            counts = [str(of[f"contacts_{kind}"]) for kind in ("moving", "resting")]
            noticed = [str(of[key]) if attention == "late" else "" for key in ("bumps", "stops")]
            ratio = f"{of['time_ratio']:.2f}"
            lines.append((f"`{suite}`", f"`{attention}`", counted(of), *counts, *noticed, ratio))
    if reactive := found.get("people_reactive"):
        moving, resting = (str(reactive[f"contacts_{kind}"]) for kind in MOTIONS)
        ratio = f"{reactive['time_ratio']:.2f}"
        lines.append(("`people`", "they react", counted(reactive), moving, resting, "", "", ratio))
    titles = ["suite", "attention", "succeeded (95 %)", "moving"]
    return table([*titles, "at rest", "bumps", "stops", "time ratio"], lines)


def crowdnav_table(found: Found) -> str:
    """Published rows, and the navigator and ORCA on the published cases."""

    def line(name: str, of: Result) -> str:
        contacts = (of["contacts_moving"] + of["contacts_resting"]) / of["missions"]
        success = of["succeeded"] / of["missions"]
        interval = interval_in_words(wilson(of["succeeded"], of["missions"]), 1.0, ".3f")
        return f"| {name} | {success:.3f} | {interval} | {contacts:.3f} | {of['mean_time']:.1f} |"

    ours, orca = found["crowdnav"], found["crowdnav_orca"]
    told = totals([row for row in found["crowdnav_variants"]["rows"] if row["group"] == "told"], 0)
    cases = f"the same {ours['missions']} cases"
    lines = CROWDNAV.format(
        orca=line(f"ORCA, this suite, {cases}", orca),
        navigator=line(f"navigator, by lidar, {cases}", ours),
        told=line(f"navigator, told positions and velocities, {told['missions']} cases", told),
    )
    head = table(("", "success", "95 %", "collisions", "time, s"), ())
    return (
        f"{head}\n{lines}\n\nThe navigator succeeds in {counted(ours)}; "
        f"{contacts_of(ours) or 'no contact'}. It is nearer than 0.2 m to somebody for "
        f"{100.0 * ours['mean_within_0_2']:.1f} % of the time. These cases take {ours['cpu_s']:.0f} s "
        "of CPU time. There were "
        f"{sum(row['circles'] for row in ours['rows'])} turns by more than 270 degrees."
    )


def variants_table(found: Found) -> str:
    """A line for each variant of crowdnav, over its first published cases."""
    cases = [row for part in found.values() for row in part["rows"]]
    groups = {name: [row for row in cases if row["group"] == name] for name in VARIANTS}
    least = min(map(len, groups.values()))
    lines = []
    for name, rows in groups.items():
        first = sorted(rows, key=lambda row: row["number"])[:least]
        outcomes = [row["outcome"] for row in first]
        times = [row["time"] for row in first if row["outcome"] == "arrived"]
        moving, resting = (sum(row[f"contacts_{kind}"] for row in first) for kind in MOTIONS)
        lines.append(
            (
                f"`{name}`{VARIANTS[name]}",
                with_interval(outcomes.count("arrived"), len(first)),
                *map(str, (moving, resting, outcomes.count("timeout"))),
                f"{fmean(times):.1f}" if times else "",
                str(sum(row["circles"] for row in first)),
            )
        )
    head = ("variant", "crossed (95 %)", "moving", "at rest", "timeouts", "time, s", "circles")
    return table(head, lines)


def slow_table(found: Found) -> str:
    """DynaBARN at 0.5 m/s: published shares of success, and the navigator's."""
    of = found["dynabarn_slow"]
    groups = [of["groups"][f"{name} 0.5 m/s"] for name in ("easy", "medium", "hard")]
    shares = " | ".join(share_of(g) for g in [*groups, of])
    jumped = sum(bool(row.get("contact_after_jump")) for row in of["rows"])
    return (
        f"{SLOW}| navigator, {of['missions']} missions | {shares} |\n\n"
        f"The navigator had {contacts_of(of) or 'no contact'}; {jumped} of them with a disc that had just "
        "jumped."
    )


def share_of(of: Result) -> str:
    """The share of successes with its interval."""
    low, high = of["succeeded_interval"]
    return f"{of['succeeded'] / of['missions']:.2f} ({low:.2f}-{high:.2f})"


def speed(found: Found) -> str:
    """How much faster than real time a core drives BARN."""
    of = found["barn"]
    times = sum(row["time"] for row in of["rows"]) / of["cpu_s"]
    return (
        f"BARN runs {times:.0f} times faster than real time on one core, while a mission runs on every "
        "core (driven seconds over seconds of CPU time, the loading of kernels included; target "
        f"15{'' if times >= 15.0 else ': missed'})."
    )


def others_in_words(others: Mapping[str, Result]) -> str:
    """Successes of the other controllers, the best first."""
    order = sorted(others, key=lambda name: -others[name]["succeeded"] / others[name]["missions"])
    return ", ".join(
        f"{LABELS.get(name, name)} {with_interval(others[name]['succeeded'], others[name]['missions'])}"
        for name in order
    )


def readme_table(found: Found) -> str:
    """The table of results in the README."""
    lines = []
    for title, name in COMPARED.items():
        of, others = beside(found["scoreboard"], name)
        whole = [found[part] for part in WHOLE[name]]
        succeeded, driven = (sum(one[key] for one in whole) for key in ("succeeded", "missions"))
        own = f"{ours(of)}; all missions: {succeeded} of {driven}"
        lines.append((title, own, others_in_words(others)))
    prefix = f"{INDIFFERENT}-"
    others = {n.removeprefix(prefix): of for n, of in found.items() if n.startswith(prefix)}
    lines.append(("indifferent people (1)", ours(found[INDIFFERENT]), others_in_words(others)))
    crowd, orca, ground = found["crowdnav"], found["crowdnav_orca"], found["navground"]
    words = f"ORCA {ours(orca)}, {orca['mean_time']:.1f} s; in print OM-SARL 1.00, 10.5 s"
    title = "crowdnav's circle, the published cases (2)"
    lines.append((title, f"{ours(crowd)}, {crowd['mean_time']:.1f} s", words))
    title = "navground, one agent among others (3)"
    lines.append((title, f"{ours(ground)}, {ground['mean_time']:.1f} s", behaviors(ground["rows"])))
    lines.append(("search, smoothed path: time, length (4)", *searches(found["table1"])))
    return table(("missions", "dynastar", "others"), lines, left=True)


def ours(of: Result) -> str:
    """Successes of a result, with their interval."""
    return with_interval(of["succeeded"], of["missions"])


def behaviors(rows: Sequence[Result]) -> str:
    """Arrivals and mean times of navground's behaviors in the robot's place."""
    words = []
    for name in rows[0]["beside"]:
        times = [
            row["beside"][name]["time"]
            for row in rows
            if row["beside"][name]["outcome"] == "arrived"
        ]
        words.append(f"{name} {with_interval(len(times), len(rows))}, {fmean(times):.1f} s")
    return "; ".join(words)


def searches(result: Result) -> tuple[str, str]:
    """Time and length of the improved A* with smoothing, and of the traditional one's."""
    words = []
    for arm in ("improved", "traditional"):
        cells = [
            cells_of(result["tables"][f"table1-{what}"])[f"{arm}, fast smoothing"]
            for what in ("time", "length")
        ]
        low, median, high = ([f"{float(row[at]):.2f}" for row in cells] for at in range(3))
        spans = [f"{m} ({a}-{b})" for a, m, b in zip(low, median, high, strict=True)]
        words.append(", ".join(spans))
    return words[0], f"traditional A* smoothed alike {words[1]}"


def cells_of(markdown: str) -> dict[str, list[str]]:
    """The rows of a table of Markdown: cells by the first one."""
    rows = (re.split(r" *\| *", line.strip("| ")) for line in markdown.splitlines() if "|" in line)
    return {first: cells for first, *cells in rows}


def causes_table(found: Found) -> str:
    """How many contacts while moving had which cause, by part, with the missions."""
    rows = found["contact_causes"]["rows"]
    parts = list(dict.fromkeys(row["part"] for row in rows))
    lines = []
    for cause, words in CAUSES.items():
        of = [row for row in rows if row["cause"] == cause]
        cells = [
            ", ".join(str(row["number"]) for row in of if row["part"] == part) for part in parts
        ]
        lines.append((words, str(len(of)), *cells))
    hit = table(("who was hit", "all", *(f"`{part}`" for part in parts)), lines)
    struck = []
    for part in (part for part in PARTS if part in found):
        which = [str(row["number"]) for row in rows_of(found[part]) if row["contacts_resting"]]
        struck += [(f"`{part}`", str(len(which)), ", ".join(which))] if which else []
    resting = table(("walked into while it stood", "all", "missions"), struck)
    return f"{hit}\n\n{resting}"
