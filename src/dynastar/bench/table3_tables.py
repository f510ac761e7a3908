"""The tables of Table III: the own world, the spread over many, and all that drive there."""

import math
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter

import numpy as np

from dynastar.bench.pairs import beside, correct, interval_in_words, p_in_words
from dynastar.bench.statistics import wilson
from dynastar.bench.table3 import (
    DRIVERS,
    FIVE,
    PRINTED,
    Row,
    driven,
    length_ratio,
    quantiles,
    summary,
    turning_ratio,
)
from dynastar.bench.tables import Cell, Table


def tables(rows: Mapping[str, Sequence[Row]], own_row: Row) -> list[Table]:
    """The own world's table in the paper's form, the default's spread over many, and all that drive.

    ``rows`` are by the keys of ``DRIVERS``.
    """
    return [
        _own_table(own_row),
        _spread_table(rows["default"]),
        _drivers_table(rows),
        _driving_table(rows),
    ]


def _drivers_table(rows: Mapping[str, Sequence[Row]]) -> Table:
    """How many arrive, beside the default in the same worlds, and beside the improved A*'s path."""
    by_number = {driver: {row["number"]: row for row in of} for driver, of in rows.items()}
    compared = {
        name: beside(of, by_number["default"])
        for name, of in by_number.items()
        if name != "default"
    }
    correct(list(compared.values()))
    lines: list[tuple[Cell, ...]] = []
    for driver, of in rows.items():
        found, pairs = summary(of), compared.get(driver)
        lines.append(
            (
                DRIVERS[driver].name,
                found["missions"],
                found["arrived"],
                interval_in_words(wilson(found["arrived"], found["missions"]), 100.0, ".1f"),
                found["contacts_moving"],
                found["contacts_resting"],
                found["timeouts"] + found["blocked"] + found["errors"],
                *(
                    (pairs["lost"], pairs["gained"], p_in_words(pairs["p_holm"]))
                    if pairs
                    else [None] * 3
                ),
                *(found[what]["median"] for what in ("length_ratio", "turning_ratio", "time")),
            )
        )
    lines.append(("in print", *([None] * 9), *_printed_ratios(), None))
    return Table(
        "table3-presets",
        "Table III by what drives",
        (
            ("", ""),
            ("worlds", "d"),
            ("arrived", "d"),
            ("95 %, %", ""),
            ("hit moving", "d"),
            ("at rest", "d"),
            ("late, blocked", "d"),
            ("lost", "d"),
            ("gained", "d"),
            ("p", ""),
            ("length ratio", ".3f"),
            ("turns ratio", ".3f"),
            ("median s", ".1f"),
        ),
        lines,
        "Lost and gained: of these worlds, those in which only the default, and only this one, arrived "
        "without contact; p is McNemar's exact test of these, corrected by Holm over all lines. Ratios to "
        "the improved A*'s grid path, and times, are medians over all worlds; one in which the robot did "
        "not arrive counts as longer than any. The intervals are Wilson's.",
    )


def _driving_table(rows: Mapping[str, Sequence[Row]]) -> Table:
    """How evenly and how near to things they drive."""
    figures = ("turning_angle", "smoothness", "jerk", "min_clearance", "mean_speed")
    beside = {row["number"]: row for row in rows["default"] if row["outcome"] == "arrived"}
    lines: list[tuple[Cell, ...]] = []
    for driver, of in rows.items():
        both = [row for row in of if row["outcome"] == "arrived" and row["number"] in beside]
        cells: list[Cell] = []
        for name in figures:
            if not both:
                cells.append(None)
                continue
            own = np.median([row[name] for row in both])
            default = np.median([beside[row["number"]][name] for row in both])
            cells.append(f"{own:.2f}" if driver == "default" else f"{own:.2f} ({default:.2f})")
        lines.append((DRIVERS[driver].name, len(both), *cells))
    return Table(
        "table3-driving",
        "How they drive in the worlds of Table III",
        (
            ("", ""),
            ("worlds", "d"),
            ("turned, rad", ""),
            ("smoothness, rad/s/m", ""),
            ("jerk, m/s3", ""),
            ("smallest clearance, m", ""),
            ("mean speed, m/s", ""),
        ),
        lines,
        "Medians over the worlds in which it and the default arrived, and in brackets the default's in the "
        "same worlds: all that the heading has turned, the variation "
        "of the turning rate over the length, the RMS of the jerk.",
    )


def _own_table(row: Row) -> Table:
    way = (row["grid_length"], row["grid_turning_points"])
    hybrid = (row.get("length"), row.get("turning_points"))
    lines: list[tuple[Cell, ...]] = [
        ("improved A*, grid path", *way, *PRINTED["improved"]),
        ("hybrid", *hybrid, *PRINTED["hybrid"]),
    ]
    if row["outcome"] == "arrived":
        ratios = (length_ratio(row), turning_ratio(row), *_printed_ratios())
        lines.append(("hybrid / improved A*", *(f"{ratio:.2f}" for ratio in ratios)))
    hits = "free as it is" if row["grid_free_disc"] else "blocked by what the map does not have"
    return Table(
        "table3-own",
        "Table III on the own 20 x 20 world",
        (("", ""), ("length m", ".1f"), ("turns", "d"), ("paper m", "d"), ("paper turns", "d")),
        lines,
        f"The hybrid {row['outcome']}. The grid path is {hits}. Turns are bends over 10 degrees after "
        "simplification at 0.25 m, for both.",
    )


def _spread_table(rows: Sequence[Row]) -> Table:
    found = summary(rows)
    alone, hybrid = PRINTED["improved"], PRINTED["hybrid"]
    ratios = _printed_ratios()
    figures: dict[str, tuple[Callable[[Row], float], float]] = {
        "improved A*, length m": (itemgetter("grid_length"), alone[0]),
        "smoothed, length m": (itemgetter("smoothed_length"), math.nan),
        "hybrid, length m": (lambda row: driven(row, "length"), hybrid[0]),
        "length, hybrid / improved A*": (length_ratio, ratios[0]),
        "improved A*, turns": (itemgetter("grid_turning_points"), alone[1]),
        "smoothed, turns": (itemgetter("smoothed_turning_points"), math.nan),
        "hybrid, turns": (lambda row: driven(row, "turning_points"), hybrid[1]),
        "turns, hybrid / improved A*": (turning_ratio, ratios[1]),
    }
    lines: list[tuple[Cell, ...]] = [
        (
            name,
            *quantiles([figure(row) for row in rows], FIVE),
            None if math.isnan(printed) else float(printed),
        )
        for name, (figure, printed) in figures.items()
    ]
    others = ", ".join(f"{found[name]} {name}" for name in ("timeouts", "blocked", "errors"))
    return Table(
        "table3",
        f"Table III over {found['missions']} worlds",
        (
            ("", ""),
            *(
                (name, ".2f")
                for name in ("median", "lower quartile", "upper", "p95", "worst", "paper")
            ),
        ),
        lines,
        f"{found['arrived']} of {found['missions']} arrived, {found['contacts_moving']} touched "
        f"something while moving, {found['contacts_resting']} at rest; {others}. Figures are over "
        f"all worlds; one in which the robot did not arrive counts as longer than any, and a quantile "
        f"there is blank. The improved A*'s path alone would hit something unknown in "
        f"{found['grid_hits']} worlds as a point, in {found['grid_hits_disc']} as the robot's disc.",
    )


def _printed_ratios() -> tuple[float, float]:
    (length, turns), (hybrid_length, hybrid_turns) = PRINTED["improved"], PRINTED["hybrid"]
    return hybrid_length / length, hybrid_turns / turns
