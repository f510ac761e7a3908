"""Table I as it is read: on the own map, over many by arm, and by kind of map."""

from collections.abc import Callable, Sequence

import numpy as np

from dynastar.bench.families import KINDS
from dynastar.bench.pairs import interval_in_words, median_in_words
from dynastar.bench.statistics import bootstrap
from dynastar.bench.table1 import LARGE, SIZE, Row, ratios, summary
from dynastar.bench.tables import Cell, Table

# As printed: cells, length, milliseconds.
PRINTED = {"traditional": (765, 71, 131), "improved": (382, 69, 40)}
PRINTED_RATIOS = {"expanded_ratio": 0.499, "search_time_ratio": 0.305, "grid_length_ratio": 0.972}

# Each row's words, its search, and the smoothing after it.
ARMS: dict[str, tuple[str, str | None]] = {
    "traditional A* (Euclidean)": ("traditional", None),
    "traditional A* (octile)": ("traditional, octile", None),
    "weighted A*, w = 2": ("weighted, w = 2", None),
    "traditional, fast smoothing": ("traditional", "traditional, smoothed"),
    "weighted, fast smoothing": ("weighted, w = 2", "weighted, smoothed"),
    "improved A*, grid path": ("improved", None),
    "improved, fast smoothing": ("improved", "improved, fast"),
    "improved, any angle": ("improved", "improved, any angle"),
}
BOUNDS = {
    "optimum over cells' centres": "optimum",
    "optimum over any points": "optimum, any point",
}
FIVE = ("lower quartile", "median", "upper quartile", "p95", "worst")
WORDS = {
    "expanded_ratio": "cells expanded, Euclidean",
    "expanded_ratio_octile": "cells expanded, octile",
    "expanded_ratio_weighted": "cells expanded, Euclidean: weighted A*, w = 2",
    "search_time_ratio": "time of the search",
    "search_time_ratio_weighted": "time of the search: weighted A*, w = 2",
    "total_time_ratio": "time with fast smoothing / search alone",
    "grid_length_ratio": "length, grid path",
    "length_ratio": "length, any angle",
    "length_ratio_fast": "length, fast smoothing",
    "length_ratio_fast_weighted": "length, fast smoothing: weighted A*, w = 2",
    "length_ratio_same_smoothing": "length, both smoothed fast",
    "any_angle_ratio": "any angle / optimum over centres",
    "fast_ratio": "fast / optimum over centres",
    "fast_ratio_any_point": "fast / optimum over any points",
}


def tables(rows: Sequence[Row], own: Row, large: Sequence[Row] = ()) -> list[Table]:
    """The own map's table in the paper's form, medians by kind, the pool by arm, and large maps."""
    found = [
        _own(own),
        _by_kind("table1-kinds", rows, SIZE),
        _by_arm("cells", "cells expanded", rows, _cells),
        _by_arm("length", "length", rows, _length),
        _by_arm("time", "time, search and smoothing", rows, _seconds),
    ]
    return [*found, _by_kind(f"table1-{LARGE}", large, LARGE)] if large else found


def _own(row: Row) -> Table:
    lines: list[tuple[Cell, ...]] = []
    for words, arm in ARMS.items():
        printed = PRINTED.get(arm[0], (None,) * 3) if arm[1] is None else (None,) * 3
        mine = (_cells(row, *arm), _length(row, *arm), 1e3 * _seconds(row, *arm))
        lines.append((words, *mine, *(printed if "octile" not in words else (None,) * 3)))
    lines += [(words, None, row[bound]["length"], *(None,) * 4) for words, bound in BOUNDS.items()]
    return Table(
        "table1-own",
        f"Table I on the own {SIZE} x {SIZE} map",
        (
            ("", ""),
            ("cells", ".0f"),
            ("length", ".2f"),
            ("time ms", ".3f"),
            *((f"paper's {what}", "d") for what in ("cells", "length", "ms")),
        ),
        lines,
        "Cells expanded, length in cells, time of search and smoothing; the paper's are of its map.",
    )


def _by_arm(
    name: str, words: str, rows: Sequence[Row], figure: Callable[[Row, str, str | None], float]
) -> Table:
    """Each arm's figure over the traditional A*'s of the same map."""
    shown = [(arm, of) for arm, of in ARMS.items() if not (name == "cells" and of[1])]
    lines: list[tuple[Cell, ...]] = [
        (
            arm,
            *_spread([figure(row, *of) / figure(row, "traditional", None) for row in rows]),
        )
        for arm, of in shown[1:]
    ]
    if name == "length":
        lines += [
            (bound, *_spread([row[of]["length"] / row["traditional"]["length"] for row in rows]))
            for bound, of in BOUNDS.items()
        ]
    return Table(
        f"table1-{name}",
        f"Table I over {len(rows)} maps: {words}, over the traditional A* (Euclidean)",
        (("", ""), *((what, ".3f") for what in FIVE), ("95 % of the median", "")),
        lines,
        "Intervals are bootstrap intervals of the median over maps of all kinds.",
    )


def _by_kind(name: str, rows: Sequence[Row], size: int) -> Table:
    """Medians of the ratios for each kind of map with their intervals, and then over all of them."""
    found = summary(rows)
    kinds = [kind for kind in (*KINDS, "all") if kind in found]
    values = {kind: ratios([row for row in rows if kind in (row["kind"], "all")]) for kind in kinds}
    lines: list[tuple[Cell, ...]] = [
        (
            words,
            *(median_in_words(values[kind][ratio]) for kind in kinds),
            *(found["all"][ratio][what] for what in ("p95", "worst")),
            PRINTED_RATIOS.get(ratio) if size == SIZE else None,
        )
        for ratio, words in WORDS.items()
        if ratio in found["all"]
    ]
    notes = ["In brackets: 95 % bootstrap intervals of the median."]
    if "fast_ratio" in found["all"]:
        notes.append(
            "A smoothed path below the optimum over centres passes nearer to corners than those are."
        )
    return Table(
        name,
        f"Improved over traditional A*, {len(rows)} maps of {size} x {size} cells: medians by kind",
        (
            ("", ""),
            *((kind, "") for kind in kinds),
            *((f"all: {what}", ".3f") for what in ("p95", "worst")),
            ("paper", ".3f"),
        ),
        lines,
        " ".join(notes),
    )


def _cells(row: Row, search: str, smoothing: str | None) -> float:
    del smoothing
    return float(row[search]["expanded"])


def _length(row: Row, search: str, smoothing: str | None) -> float:
    return float(row[smoothing or search]["length"])


def _seconds(row: Row, search: str, smoothing: str | None) -> float:
    more = row[smoothing]["seconds"] if smoothing else 0.0
    return float(row[search]["seconds"] + more)


def _spread(values: Sequence[float]) -> tuple[Cell, ...]:
    """The quantiles of ``FIVE``, and the interval of the median."""
    quantiles = np.quantile(values, (0.25, 0.5, 0.75, 0.95, 1.0))
    return (*map(float, quantiles), interval_in_words(bootstrap(values, np.median), 1.0, ".3f"))
