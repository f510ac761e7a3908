"""Scenarios as files: a TOML file with its maps beside it, which ``load_scenario`` reads back."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import ScenarioError
from dynastar.extras import require
from dynastar.grid import OccupancyGrid
from dynastar.io.files import written_aside
from dynastar.io.maps import save_map
from dynastar.io.paths import local_path
from dynastar.robot import ROBOTS, Robot
from dynastar.simulation.imperfections import PERFECT
from dynastar.simulation.scenario import Mover, Scenario

FILE = "scenario.toml"
Floats = npt.NDArray[np.float64]


def save_scenario(scenario: Scenario, folder: str | Path) -> Path:
    """Writes a scenario as ``scenario.toml`` and its maps into a folder; returns the TOML's path.

    Speed limits are kept to one part in a hundred of the robot's top speed. Raises ScenarioError for
    pedestrians who react and for faults, which no scenario file can have, and MissingPackage.
    """
    require("play", "writing scenarios needs")
    import tomli_w

    if scenario.crowd or scenario.faults:
        what = "pedestrians who react" if scenario.crowd else "faults"
        raise ScenarioError(f"a scenario file cannot have {what}")
    folder = local_path(folder, ScenarioError)
    table = _table(scenario, folder)
    with written_aside(folder / FILE, ScenarioError) as aside:
        aside.write_text(tomli_w.dumps(table), encoding="utf-8")
    return folder / FILE


def _table(scenario: Scenario, folder: Path) -> dict[str, Any]:
    """The scenario as TOML has it; writes the maps."""
    grid, robot = scenario.grid, scenario.robot
    table: dict[str, Any] = {"name": scenario.name, "map": _saved(grid, folder, "map")}
    if scenario.world is not None:
        table["world"] = _saved(scenario.world, folder, "world")
    if grid.keepout is not None:
        mask = OccupancyGrid(np.where(grid.keepout, 100, 0).astype(np.int8), grid.frame)
        table["keepout"] = _saved(mask, folder, "keepout")
    for key in ("time_limit", "latency", "goal_tolerance", "heading_tolerance", "seed"):
        table[key] = getattr(scenario, key)
    table |= {"unknown": scenario.unknown, "preset": scenario.preset}
    table |= {"attention": scenario.attention, "legs": scenario.legs}
    table["start"] = _place(*scenario.start)
    table["robot"] = _robot(robot)
    table["sensor"] = {**robot.lidar._asdict(), **scenario.noise._asdict()}
    for name, perfect in PERFECT.items():
        if getattr(scenario, name) != perfect:
            table[name] = _imperfections(getattr(scenario, name), perfect)
    if grid.speed_limit is not None:
        share = np.minimum(grid.speed_limit / robot.limits.v_max, 1.0)
        values = np.where(
            np.isfinite(grid.speed_limit), np.maximum(np.rint(100.0 * share), 1.0), 0.0
        )
        mask = OccupancyGrid(values.astype(np.int8), grid.frame)
        name = _saved(mask, folder, "speed_limit")
        table["speed_limit"] = {"mask": name, "base": 0.0, "multiplier": 1.0}
    if scenario.navigator:
        table["navigator"] = _plain(scenario.navigator)
    table["goals"] = [_place(goal.x, goal.y, goal.heading) for goal in scenario.goals]
    table["obstacles"] = [{"polygon": ring.tolist()} for ring in scenario.obstacles]
    table["movers"] = [_mover(mover) for mover in scenario.movers]
    return table


def _saved(grid: OccupancyGrid, folder: Path, name: str) -> str:
    """Writes a map's values; returns the name of its file."""
    bare = OccupancyGrid(grid.values, grid.frame)
    save_map(bare, folder / f"{name}.yaml")
    return f"{name}.yaml"


def _robot(robot: Robot) -> dict[str, Any]:
    base = robot.name if robot.name in ROBOTS else next(iter(ROBOTS))  # all of it is overridden
    table: dict[str, Any] = {"base": base, "limits": robot.limits._asdict()}
    if robot.footprint.is_disc:
        table["radius"] = robot.footprint.circumscribed
    else:
        table["polygon"] = robot.footprint.vertices.tolist()
    return table


def _imperfections(made: Any, perfect: Any) -> dict[str, Any]:
    """The fields of a NamedTuple that differ from those of a perfect robot."""
    table = {key: value for key, value in made._asdict().items() if value != getattr(perfect, key)}
    if "posts" in table:
        table["posts"] = [post._asdict() for post in table["posts"]]
    return table


def _place(x: float, y: float, heading: float | None) -> dict[str, float]:
    place = {"x": float(x), "y": float(y)}
    if heading is not None:
        place["heading"] = math.remainder(float(heading), math.tau)
    return place


def _mover(mover: Mover) -> dict[str, Any]:
    track = np.column_stack([mover.times, mover.points])
    return {"radius": float(mover.radius), "after": mover.after, "track": track.tolist()}


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    """Nested tables without what TOML has no word for."""
    table = {}
    for key, value in values.items():
        value = value._asdict() if hasattr(value, "_asdict") else value
        table[key] = _plain(value) if isinstance(value, Mapping) else value
    return table
