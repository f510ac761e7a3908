"""Table III: the improved A* alone against the hybrid, over many worlds and on the own one."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench import paper
from dynastar.bench.arms import ARMS, BASE, PLAIN_ASTAR, run_mission
from dynastar.bench.missions import Options
from dynastar.bench.rows import collect
from dynastar.bench.selection import choose_missions
from dynastar.bench.versions import code_version
from dynastar.grid import OccupancyGrid
from dynastar.planning import GridPlanner, plan
from dynastar.simulation import Scenario

# As printed: path length, turning points.
PRINTED = {"improved": (33, 7), "hybrid": (29, 4)}
FIVE = (0.5, 0.25, 0.75, 0.95, 1.0)  # the quantiles that are shown


class Driver(NamedTuple):
    """What drives: an arm of the ablation, its name in the tables, in one of how many worlds."""

    arm: str
    name: str
    share: int = 1


DRIVERS = {
    "default": Driver(BASE, "default"),
    "paper": Driver("paper", "preset paper"),
    "printed": Driver("printed", "printed", 10),
    "plain": Driver(PLAIN_ASTAR, "plain A* and the default's DWA", 5),
    "alone": Driver("DWA alone", "the default's DWA alone", 5),
}

Row = dict[str, Any]


def run(
    missions: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    driver: str = "default",
    settings: Mapping[str, Any] | None = None,
) -> list[Row]:
    """The rows of the suite's first ``missions`` worlds that its rule does not leave out.

    ``driver`` is a key of ``DRIVERS``; ``settings`` of the navigator are over those of its preset. The
    rows are kept in ``folder`` and gone on with from there, by the same version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    chosen, _ = choose_missions(paper, Options(missions=missions, seed=seed))
    jobs = [mission.number for mission in chosen]
    run_of: Row = {"table": 3, "seed": seed, "arm": driver, "version": code_version()}
    run_of |= {"settings": settings} if settings else {}
    work = partial(_row, seed=seed, arm=DRIVERS[driver].arm, settings=settings)
    file = folder / f"table3-{driver}.jsonl"
    return collect(f"table3, {driver}", work, jobs, file, run_of, workers, progress)


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
    found = plan(scenario.grid, scenario.start[:2], (goal.x, goal.y), "improved")
    way, smoothed = found.grid_path, found.path
    true = GridPlanner(_with_blocks(scenario), 0.0)
    radius = scenario.robot.footprint.circumscribed
    return {
        "grid_length": way.length,
        "grid_turning_points": way.turns,
        "grid_free": true.path_blocked_at(way.points) is None,
        "grid_free_disc": true.path_blocked_at(way.points, radius) is None,
        "smoothed_length": smoothed.length,
        "smoothed_turning_points": smoothed.turns,
    }


def length_ratio(row: Row) -> float:
    """The driven length over the improved A*'s grid path's; infinite if it did not arrive."""
    return driven(row, "length") / float(row["grid_length"])


def turning_ratio(row: Row) -> float:
    """The same of turning points; over one where the grid path has none."""
    return driven(row, "turning_points") / max(1.0, float(row["grid_turning_points"]))


def driven(row: Row, what: str) -> float:
    """A figure of a mission; infinite if it did not arrive."""
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
        found = quantiles([figure(row) for row in rows], (0.5, 0.95, 1.0))
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
        "time": over_all(lambda row: driven(row, "time")),
        "grid_hits": sum(not row["grid_free"] for row in rows),
        "grid_hits_disc": sum(not row["grid_free_disc"] for row in rows),
    }


def quantiles(values: Sequence[float], at: Sequence[float]) -> list[float | None]:
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
    mission = run_mission(replace(scenario, seed=seed), ARMS[arm], settings)
    return {**mission, **grid_way(scenario)}


def _with_blocks(scenario: Scenario) -> OccupancyGrid:
    """The map with the unknown blocks in it, which are whole cells."""
    grid = scenario.grid
    occupied = grid.occupied.copy()
    for ring in scenario.obstacles:
        row, column = grid.frame.to_grid(*np.mean(ring, axis=0))
        occupied[int(row), int(column)] = True
    return OccupancyGrid.from_occupied(occupied, grid.resolution, grid.frame.x, grid.frame.y)
