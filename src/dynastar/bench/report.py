"""What ``dynastar paper`` makes: each experiment's figures, tables, rows and picture, and its files."""

import csv
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dynastar.bench import (
    ablation,
    clutter,
    ladder,
    presets,
    table1,
    table1_tables,
    table3,
    table3_tables,
    targets,
    terms,
)
from dynastar.bench.arms import BASE
from dynastar.bench.families import KINDS
from dynastar.bench.figures import SUFFIXES, draw_all
from dynastar.bench.tables import Table, as_markdown
from dynastar.viewer.sheet import save
from dynastar.viewer.spread import Column, Spread, draw_columns, draw_parts, draw_spreads
from dynastar.writing import written_aside

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Rows = Sequence[Mapping[str, Any]]


class Asked(NamedTuple):
    """Extent of a report: number of maps and worlds, seed, folder, processes.

    Without ``worlds`` each report has its own number of them. ``settings`` of the navigator are over
    those of each preset, but below those of an arm.
    """

    maps: int
    worlds: int | None
    seed: int
    folder: Path
    workers: int = 1
    progress: bool = False
    settings: Mapping[str, Any] = {}

    def worlds_or(self, usual: int) -> int:
        """The number of worlds asked for, else the ``usual`` one, and no more than maps."""
        return min(self.worlds or usual, self.maps)


class Report(NamedTuple):
    """One experiment's outcome.

    ``found`` are its figures for JSON, ``rows`` its rows by the name of the file they go to.
    """

    name: str
    found: dict[str, Any]
    tables: Sequence[Table] = ()
    rows: Mapping[str, Rows] = {}
    picture: "Figure | None" = None


def report_table1(asked: Asked) -> Report:
    """Table I: on the own map, over many, and over a tenth as many large ones."""
    seed, folder, workers, progress, _ = asked[2:]
    rows = table1.run(asked.maps, seed, folder, workers, progress=progress)
    few = -(-asked.maps // table1.FEWER)
    large = table1.run(few, seed, folder, workers, table1.LARGE, progress)
    own = table1.own_row()
    shown = {
        "expanded_ratio": Spread("cells expanded", {}, 0.499, log=True, reference=1.0),
        "length_ratio_fast": Spread("length, fast smoothing", {}, reference=1.0),
        "search_time_ratio": Spread("time of the search", {}, 0.305, log=True, reference=1.0),
        "total_time_ratio": Spread("time with smoothing", {}, log=True, reference=1.0),
    }
    groups = {
        kind: table1.ratios([row for row in rows if kind in (row["kind"], "all")])
        for kind in (*KINDS, "all")
    }
    return Report(
        "table1",
        {
            "table1": table1.summary(rows),
            "table1_maps": len(rows),
            "table1_own": own,
            f"table1_{table1.LARGE}": table1.summary(large),
        },
        table1_tables.tables(rows, own, large),
        {"table1": rows, f"table1-{table1.LARGE}": large},
        draw_spreads(
            [
                spread._replace(values={kind: values[name] for kind, values in groups.items()})
                for name, spread in shown.items()
            ]
        ),
    )


def report_table3(asked: Asked) -> Report:
    """Table III: in the own world, and over many by all that drive there."""
    seed, folder, workers, progress, settings = asked[2:]
    by_driver = {
        name: table3.run(
            -(-asked.maps // of.share), seed, folder, workers, progress, name, settings
        )
        for name, of in table3.DRIVERS.items()
    }
    rows = by_driver["default"]
    own = table3.own_row(settings=settings)
    arrived = {
        arm: [row for row in of if row["outcome"] == "arrived"] for arm, of in by_driver.items()
    }
    names = {
        arm: f"{table3.DRIVERS[arm].name}: {len(arrived[arm])} of {len(of)} arrived"
        for arm, of in by_driver.items()
    }
    alone, hybrid = table3.PRINTED["improved"], table3.PRINTED["hybrid"]
    measures = {
        "length driven / improved A*'s grid path": (table3.length_ratio, hybrid[0] / alone[0]),
        "turning points driven / grid path's": (table3.turning_ratio, hybrid[1] / alone[1]),
    }
    spreads = [
        Spread(
            label,
            {name: [ratio(row) for row in arrived[arm]] for arm, name in names.items()},
            printed,
            log=True,
            reference=1.0,
        )
        for label, (ratio, printed) in measures.items()
    ]
    return Report(
        "table3",
        {
            "table3": table3.summary(rows),
            "table3_presets": {name: table3.summary(of) for name, of in by_driver.items()},
            "table3_own": own,
        },
        table3_tables.tables(by_driver, own),
        {f"table3-{name}": of for name, of in by_driver.items()},
        draw_spreads(spreads) if any(arrived.values()) else None,
    )


def report_ablation(asked: Asked) -> Report:
    """The ablation: on worlds, and the terms of Eq. 2 on maps, too."""
    seed, folder, workers, progress, settings = asked[2:]
    on_maps = terms.run(asked.maps, seed, folder, workers, progress=progress)
    worlds = asked.worlds_or(ablation.WORLDS)
    rows = ablation.run(worlds, seed, folder, workers, progress, settings)
    found = ablation.summary(rows)
    return Report(
        "ablation",
        {"ablation": found, "terms": terms.summary(on_maps)},
        [*terms.tables(on_maps), *ablation.tables(rows)],
        {"ablation": rows, "terms": on_maps},
        draw_columns(_columns(found), best=BASE),
    )


def _columns(found: Mapping[str, Mapping[str, Any]]) -> list[Column]:
    """Data of the ablation's picture: for each suite, the arms in the order of the first suite."""
    order = ablation.by_effect(next(iter(found.values())))
    percent = (0.0, 100.0)
    shown: dict[str, tuple[Callable[[Mapping[str, Any]], float | None], str, Any]] = {
        "arrived, %": (
            lambda of: 100.0 * of["arrived"] / of["missions"],
            "arrived_interval",
            percent,
        ),
        "contact, %": (
            lambda of: 100.0 * (of["contacts_moving"] + of["contacts_resting"]) / of["missions"],
            "touched_interval",
            percent,
        ),
        "time / base's": (lambda of: of["time_ratio"], "time_ratio_interval", None),
    }
    return [
        Column(
            f"{suite}\n{label}",
            {arm: of(arms[arm]) if arm in arms else None for arm in order},
            ".0f" if range_ else ".2f",
            range=range_,
            intervals={
                arm: _scaled(arms[arm].get(interval), 100.0 if range_ else 1.0)
                for arm in order
                if arm in arms
            },
        )
        for suite, arms in found.items()
        for label, (of, interval, range_) in shown.items()
    ]


def _scaled(interval: Sequence[float] | None, factor: float) -> tuple[float, float] | None:
    """An interval in another unit; None where there is none."""
    return None if interval is None else (factor * interval[0], factor * interval[1])


def report_clutter(asked: Asked) -> Report:
    """The controller ``printed``, in two readings, and the default over clutter and walkers' speeds."""
    seed, folder, workers, progress, _ = asked[2:]
    rows = clutter.run(asked.worlds_or(clutter.WORLDS), seed, folder, workers, progress)
    return Report(
        "clutter", {"clutter": clutter.summary(rows)}, clutter.tables(rows), {"clutter": rows}
    )


def report_ladder(asked: Asked) -> Report:
    """From the controller ``printed`` to the default navigator, a change at a time."""
    seed, folder, workers, progress, settings = asked[2:]
    rows = ladder.run(asked.worlds_or(ladder.WORLDS), seed, folder, workers, progress, settings)
    found = ladder.summary(rows)
    return Report(
        "ladder",
        {"ladder": found},
        [ladder.table(found)],
        {"ladder": rows},
        draw_parts("worlds, %", ladder.outcomes(found)),
    )


def report_presets(asked: Asked) -> Report:
    """The settings in which the presets differ."""
    del asked
    table = presets.table()
    names = "setting", *presets.ORDER, "what"
    found = [dict(zip(names, row, strict=True)) for row in table.rows]
    return Report("presets", {"presets": found}, [table])


def report_figures(asked: Asked) -> Report:
    """The figures, drawn into the folder."""
    asked.folder.mkdir(parents=True, exist_ok=True)
    files = draw_all(asked.folder, asked.progress)
    return Report("figures", {"figures": [file.name for file in files]})


def report_targets(found: Mapping[str, Any]) -> Report:
    """Results of the other reports beside their targets."""
    table = targets.table(found)
    names = "target", "at_most", "measured", "outcome"
    return Report(
        "targets",
        {"targets": [dict(zip(names, row, strict=True)) for row in table.rows]},
        [table],
    )


REPORTS: dict[str, Callable[[Asked], Report]] = {
    "presets": report_presets,
    "table1": report_table1,
    "table3": report_table3,
    "clutter": report_clutter,
    "ladder": report_ladder,
    "figures": report_figures,
    "ablation": report_ablation,
}


def write(report: Report, folder: Path) -> None:
    """The report's tables (.md), rows (.csv) and picture (.png, .svg)."""
    if report.tables:
        with written_aside(folder / f"{report.name}.md") as aside:
            text = "\n\n".join(as_markdown(table) for table in report.tables)
            aside.write_text(text + "\n", encoding="utf-8")
    for name, rows in report.rows.items():
        write_csv(folder / f"{name}.csv", rows)
    if report.picture is not None:
        for suffix in SUFFIXES:
            save(report.picture, folder / f"{report.name}{suffix}")


def write_csv(file: Path, rows: Rows) -> None:
    """A line for each row; what is nested in it has headings like "improved: length"."""
    flat = [
        {
            name if not isinstance(value, Mapping) else f"{name}: {what}": figure
            for name, value in row.items()
            for what, figure in (value.items() if isinstance(value, Mapping) else [("", value)])
        }
        for row in rows
    ]
    headings = list(dict.fromkeys(name for row in flat for name in row))
    with written_aside(file) as aside, aside.open("w", newline="", encoding="utf-8") as handle:
        writer = csv.DictWriter(handle, headings)
        writer.writeheader()
        writer.writerows(flat)
