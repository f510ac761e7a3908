"""The table of the targets in docs/benchmarks.md."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from results_parts import Part

from dynastar.bench.statistics import wilson

Result = Mapping[str, Any]
Measured = tuple[str, bool]  # in words, and whether the target is met

CHALLENGE = {"easy": (0.98, 0.01), "medium": (0.96, 0.02), "hard": (0.80, 0.06)}  # of DynaBARN
PUBLISHED = {
    "easy": 0.78,
    "medium": 0.60,
    "hard": 0.28,
}  # the best on DynaBARN at 0.5 m/s, of a DWA and of TD3, as [DynaBARN] quotes them
NEAR = 0.05  # share of the time


class Target(NamedTuple):
    """A line of the table: the part that measures it, the target in words, and what is measured."""

    what: str
    part: str
    target: str
    measured: Callable[[Result], Measured]


def counted(result: Result) -> str:
    """Successes of missions, with Wilson's interval in per cent."""
    return with_interval(result["succeeded"], result["missions"])


def with_interval(succeeded: int, missions: int) -> str:
    """Successes of missions with Wilson's interval in per cent."""
    interval = wilson(succeeded, missions)
    assert interval is not None
    low, high = (round(100.0 * end) for end in interval)
    return f"{succeeded} of {missions} ({low}-{high})"


def contacts_of(result: Result) -> str:
    """Contacts while moving and at rest, in words; "" if there are none."""
    moving, resting = result["contacts_moving"], result["contacts_resting"]
    words = [f"{moving} moving contact{'' if moving == 1 else 's'}"] if moving else []
    words += [f"{resting} contact{'' if resting == 1 else 's'} at rest"] if resting else []
    return ", ".join(words)


def missions(
    share: float, ratio: float | None = None, contacts: int | None = None
) -> Callable[[Result], Measured]:
    """At least a ``share`` of successes, with the time ratio and the contacts at most as given."""

    def measured(result: Result) -> Measured:
        words = [counted(result)]
        met = result["succeeded"] >= share * result["missions"]
        if ratio is not None:
            words.append(f"{result['time_ratio']:.2f}")
            met = met and result["time_ratio"] <= ratio
        touched = contacts_of(result)
        if contacts is not None:
            touched = touched or "no contact"
            met = met and result["contacts_moving"] + result["contacts_resting"] <= contacts
        return ", ".join([*words, touched] if touched else words), met

    return measured


def among_people(
    share: float, moving: float, ratio: float | None = None, time: float | None = None
) -> Callable[[Result], Measured]:
    """At least a ``share`` of successes, with contacts while moving in at most a ``moving`` share.

    And with the time ratio, or the mean time (s), at most as given; with that also the share of the time
    that is nearer than 0.2 m to somebody, at most ``NEAR``.
    """

    def measured(result: Result) -> Measured:
        touched = result["contacts_moving"] <= moving * result["missions"]
        met = touched and result["succeeded"] >= share * result["missions"]
        words = [counted(result), contacts_of(result) or "no contact"]
        if ratio is not None:
            words.append(f"{result['time_ratio']:.2f}")
            met = met and result["time_ratio"] <= ratio
        if time is not None:
            near = result["mean_within_0_2"]
            words.append(f"{result['mean_time']:.1f} s, {100.0 * near:.1f} %")
            met = met and result["mean_time"] <= time and near <= NEAR
        return ", ".join(words), met

    return measured


def variant(name: str, share: float) -> Callable[[Result], Measured]:
    """The same of a variant of crowdnav."""

    def measured(result: Result) -> Measured:
        return among_people(share, 0.005)(result["groups"][name])

    return measured


def barn(result: Result) -> Measured:
    """Successes and score."""
    met = result["succeeded"] >= 0.99 * result["missions"] and result["score"] >= 0.495
    return f"{counted(result)}, {result['score']:.3f}", met


def dynabarn(result: Result) -> Measured:
    """Successes and contacts while moving by difficulty."""
    words, met = [], True
    for name, (share, moving) in CHALLENGE.items():
        of = result["groups"][name]
        words.append(f"{counted(of)}, {of['contacts_moving']}")
        met = met and of["succeeded"] >= share * of["missions"]
        met = met and of["contacts_moving"] <= moving * of["missions"]
    return "; ".join(words), met


def dynabarn_slow(result: Result) -> Measured:
    """Successes by difficulty."""
    groups = {name: result["groups"][f"{name} 0.5 m/s"] for name in PUBLISHED}
    met = all(of["succeeded"] > PUBLISHED[name] * of["missions"] for name, of in groups.items())
    return "; ".join(map(counted, groups.values())), met


def office(result: Result) -> Measured:
    """Successes, contacts, the mean time and the longest of those that arrived."""
    longest = max(row["time"] for row in result["rows"] if row["outcome"] == "arrived")
    touched = contacts_of(result) or "no contact"
    words = (
        f"{counted(result)}, {touched}, {result['mean_time']:.1f} s, the slowest {longest:.1f} s"
    )
    met = result["succeeded"] == result["missions"] and longest <= 110.0
    return words, met and result["mean_time"] <= 90.0


def table3(result: Result) -> Measured:
    """Shares of arrivals and of moving contacts."""
    of = result["table3"]
    arrived, moving = (
        with_interval(of[key], of["missions"]) for key in ("arrived", "contacts_moving")
    )
    met = of["arrived"] >= 0.99 * of["missions"] and of["contacts_moving"] <= 0.003 * of["missions"]
    return f"{arrived}, {moving} moving contacts", met


def ratio(name: str, **most: float) -> Callable[[Result], Measured]:
    """Quantiles of a ratio of Table I over all maps, each at most as given."""

    def measured(result: Result) -> Measured:
        of = result["table1"]["all"][name]
        words = ", ".join(f"{of[quantile]:.2f}" for quantile in most)
        return words, all(of[quantile] <= limit for quantile, limit in most.items())

    return measured


TARGETS = (
    Target("BARN, 150 worlds: arrived, score", "barn", "99 %, 0.495", barn),
    Target(
        "DynaBARN: easy, medium, hard: crossed, moving contacts",
        "dynabarn",
        "98, 96, 80 %; 1, 2, 6 %",
        dynabarn,
    ),
    Target(
        "the same at 0.5 m/s: ahead of the best published",
        "dynabarn_slow",
        "78, 60, 28 %",
        dynabarn_slow,
    ),
    Target("MRPB: arrived, time over the bound", "mrpb", "all, 1.3", missions(1.0, 1.3)),
    Target(
        "the published crowd, `crowdnav`: crossed, moving contacts, time, nearer than 0.2 m to somebody",
        "crowdnav",
        "99 %, 0.2 %, 11.0 s, 5 %",
        among_people(0.99, 0.002, time=11.0),
    ),
    *(
        Target(
            f"the same, {words}",
            "crowdnav_variants",
            f"{100.0 * share:.0f} %, 0.5 %",
            variant(name, share),
        )
        for name, words, share in (
            ("visible", "people see the robot", 0.99),
            ("square", "a square", 0.98),
            ("ten", "ten people", 0.95),
        )
    ),
    Target(
        "recorded crowds who notice the robot late: crossed, moving contacts, time over the bound",
        "crowd_late",
        "95 %, 2 %, 1.35",
        among_people(0.95, 0.02, ratio=1.35),
    ),
    Target(
        "recorded crowds who do not react",
        "crowd_none",
        "82 %, 5 %, 1.35",
        among_people(0.82, 0.05, ratio=1.35),
    ),
    Target("real maps with unmapped boxes and walkers", "maps", "99 %, 1.3", missions(0.99, 1.3)),
    Target(
        "the demo's office, 40 seeds: arrived, contacts, mean and longest time",
        "office",
        "all, 0, 90 s, 110 s",
        office,
    ),
    Target(
        "random static worlds: rightly ended, time over the bound",
        "random",
        "99 %, 1.35",
        missions(0.99, 1.35),
    ),
    Target(
        "eight robots: rightly ended, contacts",
        "robots",
        "98 %, 0",
        missions(0.98, contacts=0),
    ),
    Target("the same in MuJoCo", "physics", "98 %, 0", missions(0.98, contacts=0)),
    Target(
        "people who notice the robot late: arrived, moving contacts",
        "people_late",
        "88 %, 5 %",
        among_people(0.88, 0.05),
    ),
    Target("people who do not react", "people_none", "72 %, 10 %", among_people(0.72, 0.1)),
    Target("people who react", "people_reactive", "99 %, 0", among_people(0.99, 0.0)),
    Target("faults of sensors, odometry, clock, drive, map", "faults", "all", missions(1.0)),
    Target("worlds like the paper's: arrived, moving contacts", "table3", "99 %, 0.3 %", table3),
    Target("MovingAI: optimal length found", "movingai", "all", missions(1.0)),
    Target(
        "cells expanded over traditional A*, 1000 maps, median",
        "table1",
        "0.25",
        ratio("expanded_ratio", median=0.25),
    ),
    Target(
        "length, fast smoothing, over traditional A*, median and 95th percentile",
        "table1",
        "0.95, 1.05",
        ratio("length_ratio_fast", median=0.95, p95=1.05),
    ),
    Target(
        "search and fast smoothing over the traditional search, time",
        "table1",
        "1",
        ratio("total_time_ratio", median=1.0),
    ),
)


def targets_table(found: Mapping[str, Result], parts: Mapping[str, Part]) -> str:
    """A line for each target, with the command of its part."""
    lines = ["| what | command | target | measured |", "|:--|:--|:--|:--|"]
    for target in (target for target in TARGETS if target.part in parts):
        words, met = target.measured(found[target.part])
        shown = f"`{parts[target.part].shown}`"
        lines.append(
            f"| {target.what} | {shown} | {target.target} | {words}{'' if met else ': missed'} |"
        )
    return "\n".join(lines)
