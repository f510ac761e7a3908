"""Table III: the improved A* alone against the hybrid, over many worlds and on the own one."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench import paper
from dynastar.bench.arms import ARMS, SOURCES, run_mission
from dynastar.bench.missions import Options
from dynastar.bench.rows import collect
from dynastar.bench.selection import choose_missions
from dynastar.bench.statistics import wilson
from dynastar.bench.tables import Cell, Table
from dynastar.bench.versions import version
from dynastar.grid import OccupancyGrid
from dynastar.planning import GridPlanner, plan
from dynastar.simulation import Scenario

# As printed: path length, turning points.
PRINTED = {"improved": (33, 7), "hybrid": (29, 4)}
FIVE = (0.5, 0.25, 0.75, 0.95, 1.0)  # the quantiles that are shown

Row = dict[str, Any]


def run(
    missions: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    arm: str = "default",
    settings: Mapping[str, Any] | None = None,
) -> list[Row]:
    """The rows of the suite's first ``missions`` worlds that its rule does not leave out.

    ``arm`` is one of the ablation's; ``settings`` of the navigator are over those of its preset. The
    rows are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    chosen, _ = choose_missions(paper, Options(missions=missions, seed=seed))
    jobs = [mission.number for mission in chosen]
    run_of: Row = {"table": 3, "seed": seed, "arm": arm, "version": version("table3", *SOURCES)}
    run_of |= {"settings": settings} if settings else {}
    work = partial(_row, seed=seed, arm=arm, settings=settings)
    file = folder / f"table3-{arm}.jsonl"
    return collect(f"table3, {arm}", work, jobs, file, run_of, workers, progress)


def own_row(settings: Mapping[str, Any] | None = None) -> Row:
    """The row of the project's own world; it has no number."""
    return {"number": None, **_both(paper.own_world(), 0, "default", settings)}


def grid_way(scenario: Scenario) -> Row:
    """The improved A* alone on the map as it is known: its way over cells, and what it would hit.

    The robot is a point to it, as the paper's is. ``grid_free`` and ``grid_free_disc`` say whether
    that point, and the robot, could follow it past what no map has, were the walker not there.
    Where it turns every bend counts: next to a cell's metre the tolerance of ``turning_points``,
    0.25 m, takes none away.
    """
    goal = scenario.goals[0]
    way = plan(scenario.grid, scenario.start[:2], (goal.x, goal.y), "improved").grid_path
    true = GridPlanner(_with_blocks(scenario), 0.0)
    radius = scenario.robot.footprint.circumscribed
    return {
        "grid_length": way.length,
        "grid_turning_points": way.turns,
        "grid_free": true.path_blocked_at(way.points) is None,
        "grid_free_disc": true.path_blocked_at(way.points, radius) is None,
    }


def length_ratio(row: Row) -> float:
    """The driven length over the improved A*'s grid path's; infinite if it did not arrive."""
    return _driven(row, "length") / float(row["grid_length"])


def turning_ratio(row: Row) -> float:
    """The same of turning points; over one where the grid path has none."""
    return _driven(row, "turning_points") / max(1.0, float(row["grid_turning_points"]))


def _driven(row: Row, what: str) -> float:
    return float(row[what]) if row["outcome"] == "arrived" else math.inf


def summary(rows: Sequence[Row]) -> dict[str, Any]:
    """Totals of the rows: outcomes of all missions, and the hybrid over the improved A*'s path.

    Ratios and time are over all worlds; one in which the robot did not arrive counts as longer than
    any, and a quantile that lies there is None.
    """

    def counted(outcome: str) -> int:
        return sum(row["outcome"] == outcome for row in rows)

    def contacts(kind: str) -> int:
        return sum(bool(row.get(f"contacts_{kind}")) for row in rows)

    def over_all(figure: Callable[[Row], float]) -> dict[str, float | None]:
        found = _quantiles([figure(row) for row in rows], (0.5, 0.95, 1.0))
        return dict(zip(("median", "p95", "worst"), found, strict=True))

    return {
        "missions": len(rows),
        "arrived": counted("arrived"),
        "contacts_moving": contacts("moving"),
        "contacts_resting": contacts("resting"),
        "timeouts": counted("timeout"),
        "blocked": counted("blocked"),
        "errors": counted("error"),
        "length_ratio": over_all(length_ratio),
        "turning_ratio": over_all(turning_ratio),
        "time": over_all(lambda row: _driven(row, "time")),
        "grid_hits": sum(not row["grid_free"] for row in rows),
        "grid_hits_disc": sum(not row["grid_free_disc"] for row in rows),
    }


def tables(rows: Mapping[str, Sequence[Row]], own_row: Row) -> list[Table]:
    """The own world's table in the paper's form, the default's spread over many, and all presets."""
    return [_own_table(own_row), _spread_table(rows["default"]), _presets_table(rows)]


def _presets_table(rows: Mapping[str, Sequence[Row]]) -> Table:
    lines: list[tuple[Cell, ...]] = []
    for preset, of in rows.items():
        found = summary(of)
        interval = wilson(found["arrived"], found["missions"])
        assert interval is not None
        lines.append(
            (
                preset,
                found["missions"],
                found["arrived"],
                f"{100.0 * interval[0]:.1f} to {100.0 * interval[1]:.1f}",
                found["contacts_moving"],
                found["contacts_resting"],
                found["timeouts"] + found["blocked"] + found["errors"],
                *(found[what]["median"] for what in ("length_ratio", "turning_ratio", "time")),
            )
        )
    lines.append(("in print", *([None] * 6), *_printed_ratios(), None))
    return Table(
        "table3-presets",
        "Table III by preset",
        (
            ("", ""),
            ("worlds", "d"),
            ("arrived", "d"),
            ("95 %, %", ""),
            ("hit moving", "d"),
            ("at rest", "d"),
            ("late, blocked", "d"),
            ("length ratio", ".3f"),
            ("turns ratio", ".3f"),
            ("median s", ".1f"),
        ),
        lines,
        "Ratios to the improved A*'s grid path, and times, are medians over all worlds; one in which the "
        "robot did not arrive counts as longer than any.",
    )


def _own_table(row: Row) -> Table:
    way = (row["grid_length"], row["grid_turning_points"])
    driven = (row.get("length"), row.get("turning_points"))
    lines: list[tuple[Cell, ...]] = [
        ("improved A*, grid path", *way, *PRINTED["improved"]),
        ("hybrid", *driven, *PRINTED["hybrid"]),
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
        "hybrid, length m": (lambda row: _driven(row, "length"), hybrid[0]),
        "length, hybrid / improved A*": (length_ratio, ratios[0]),
        "improved A*, turns": (itemgetter("grid_turning_points"), alone[1]),
        "hybrid, turns": (lambda row: _driven(row, "turning_points"), hybrid[1]),
        "turns, hybrid / improved A*": (turning_ratio, ratios[1]),
    }
    lines: list[tuple[Cell, ...]] = [
        (name, *_quantiles([figure(row) for row in rows], FIVE), float(printed))
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


def _quantiles(values: Sequence[float], at: Sequence[float]) -> list[float | None]:
    """Values at some fractions of the sorted ones, the nearest below; None where that is infinite."""
    if not values:
        return [None] * len(at)
    found = np.quantile(values, at, method="inverted_cdf")
    return [float(value) if np.isfinite(value) else None for value in found]


def _row(number: int, seed: int, arm: str, settings: Mapping[str, Any] | None) -> Row:
    made = paper.world(seed, number)
    assert isinstance(made, Scenario)
    return {"number": number, **_both(made, seed, arm, settings)}


def _both(scenario: Scenario, seed: int, arm: str, settings: Mapping[str, Any] | None) -> Row:
    driven = run_mission(replace(scenario, seed=seed), ARMS[arm], settings)
    return {**driven, **grid_way(scenario)}


def _with_blocks(scenario: Scenario) -> OccupancyGrid:
    """The map with the unknown blocks in it, which are whole cells."""
    grid = scenario.grid
    occupied = grid.occupied.copy()
    for ring in scenario.obstacles:
        row, column = grid.frame.to_grid(*np.mean(ring, axis=0))
        occupied[int(row), int(column)] = True
    return OccupancyGrid.from_occupied(occupied, grid.resolution, grid.frame.x, grid.frame.y)
