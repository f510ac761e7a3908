"""What Tables I and III should show, beside what they do."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from dynastar.bench.table1 import LARGE
from dynastar.bench.tables import Cell, Table

Found = Mapping[str, Any]


class Target(NamedTuple):
    """A figure that should be at most so large; ``of`` finds it in what the reports found."""

    what: str
    most: float
    of: Callable[[Found], float]


def _table1(kind: str, ratio: str, figure: str, table: str = "table1") -> Callable[[Found], float]:
    return lambda found: float(found[table][kind][ratio][figure])


def _table3(ratio: str, figure: str) -> Callable[[Found], float]:
    return lambda found: float(found["table3"][ratio][figure])


def _lost(found: Found) -> float:
    worlds = found["table3"]
    return float(worlds["missions"] - worlds["arrived"]) / float(worlds["missions"])


def _touched(driver: str) -> Callable[[Found], float]:
    def fraction(found: Found) -> float:
        worlds = found["table3_presets"][driver]
        return float(worlds["contacts_moving"]) / float(worlds["missions"])

    return fraction


TARGETS = (
    Target("cells, median, random", 0.13, _table1("random", "expanded_ratio", "median")),
    Target("cells, median, all", 0.25, _table1("all", "expanded_ratio", "median")),
    Target(
        "cells / octile, median, random", 0.20, _table1("random", "expanded_ratio_octile", "median")
    ),
    Target("cells / octile, median, all", 0.30, _table1("all", "expanded_ratio_octile", "median")),
    Target("any angle: length, median", 0.95, _table1("all", "length_ratio", "median")),
    Target("any angle: length, p95, random", 1.0, _table1("random", "length_ratio", "p95")),
    Target("any angle: length, p95, all", 1.05, _table1("all", "length_ratio", "p95")),
    Target("any angle / optimum, mean", 1.02, _table1("all", "any_angle_ratio", "mean")),
    Target("fast smoothing / optimum, mean", 1.05, _table1("all", "fast_ratio", "mean")),
    Target(
        "search and fast smoothing: time, median", 1.0, _table1("all", "total_time_ratio", "median")
    ),
    Target(
        f"the same at {LARGE} x {LARGE}",
        0.35,
        _table1("all", "total_time_ratio", "median", f"table1_{LARGE}"),
    ),
    Target("fraction that did not arrive", 0.01, _lost),
    Target("fraction with a contact while moving", 0.003, _touched("default")),
    Target("the same, preset paper", 0.003, _touched("paper")),
    Target("hybrid: length, median", 0.93, _table3("length_ratio", "median")),
    Target("hybrid: turning points, median", 0.57, _table3("turning_ratio", "median")),
)


def table(found: Found) -> Table:
    """Every target beside its figure; that is blank where nobody arrived."""
    rows: list[tuple[Cell, ...]] = []
    for what, most, of in TARGETS:
        try:
            value = of(found)
        except TypeError:  # there are no ratios
            rows.append((what, most, None, "missed"))
            continue
        rows.append((what, most, value, "met" if value <= most else "missed"))
    return Table(
        "targets",
        "Targets",
        (("", ""), ("at most", ".3g"), ("measured", ".4g"), ("", "")),
        rows,
        "Cells, lengths and times are over the traditional A* with the Euclidean estimate, or with the "
        "octile one where that is said; the hybrid's are over the improved A*'s grid path.",
    )
