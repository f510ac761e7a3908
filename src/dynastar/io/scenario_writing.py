"""Scenarios as files: a TOML file with its maps beside it, which ``load_scenario`` reads back."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import ScenarioError
from dynastar.extras import require
from dynastar.geometry import place
from dynastar.grid import OccupancyGrid
from dynastar.io.files import MAX_TABLE_BYTES
from dynastar.io.maps import save_map
from dynastar.paths import local_path
from dynastar.robot import ROBOTS, Robot
from dynastar.simulation.imperfections import PERFECT
from dynastar.simulation.scenario import Mover, Scenario
from dynastar.writing import written_aside

FILE = "scenario.toml"
Floats = npt.NDArray[np.float64]


def save_scenario(scenario: Scenario, folder: str | Path) -> Path:
    """Writes a scenario as ``scenario.toml`` and its maps into a folder; returns the TOML's path.

    Speed limits are kept to one part in a hundred of the robot's top speed. Raises ScenarioError for
    pedestrians who react and for faults, which no scenario file can have, and for one that would be
    too large to be read again; and MissingPackage.
    """
    require("play", "writing scenarios needs")
    import tomli_w

    if scenario.crowd or scenario.faults:
        what = "pedestrians who react" if scenario.crowd else "faults"
        raise ScenarioError(f"a scenario file cannot have {what}")
    folder = local_path(folder, ScenarioError)
    maps: dict[str, OccupancyGrid] = {}
    text = tomli_w.dumps(_table(scenario, maps)).encode(errors="replace")
    if len(text) > MAX_TABLE_BYTES:
        raise ScenarioError(
            f"the scenario file would have {len(text)} bytes, of which at most {MAX_TABLE_BYTES} are "
            "read: leave out obstacles, or walkers with long tracks"
        )
    for name, grid in maps.items():
        save_map(grid, folder / name)
    with written_aside(folder / FILE, ScenarioError) as aside:
        aside.write_bytes(text)
    return folder / FILE


def _table(scenario: Scenario, maps: dict[str, OccupancyGrid]) -> dict[str, Any]:
    """The scenario as TOML has it; its maps are added to ``maps`` by the names of their files."""
    grid, robot = scenario.grid, scenario.robot
    table: dict[str, Any] = {"name": scenario.name, "map": _named(grid, maps, "map")}
    if scenario.world is not None:
        table["world"] = _named(scenario.world, maps, "world")
    if grid.keepout is not None:
        mask = OccupancyGrid(np.where(grid.keepout, 100, 0).astype(np.int8), grid.frame)
        table["keepout"] = _named(mask, maps, "keepout")
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
        name = _named(mask, maps, "speed_limit")
        table["speed_limit"] = {"mask": name, "base": 0.0, "multiplier": 1.0}
    if scenario.navigator:
        table["navigator"] = _plain(scenario.navigator)
    table["goals"] = [_place(goal.x, goal.y, goal.heading) for goal in scenario.goals]
    table["obstacles"] = [{"polygon": ring.tolist()} for ring in scenario.obstacles]
    table["movers"] = [_mover(mover) for mover in scenario.movers]
    return table


def _named(grid: OccupancyGrid, maps: dict[str, OccupancyGrid], name: str) -> str:
    """Adds a map's values to ``maps``; returns the name of its file."""
    maps[f"{name}.yaml"] = OccupancyGrid(grid.values, grid.frame)
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
    stays = len(track) == 1 and mover.after != "vanish"  # whatever it would do after its last key
    if len(track) == 1 and not stays:
        x, y = mover.points[0]
        raise ScenarioError(
            f"a mover at {place(x, y)} is there for no time: expected two keys or more"
        )
    after = "stay" if stays else mover.after
    return {"radius": float(mover.radius), "after": after, "track": track.tolist()}


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    """Nested tables without what TOML has no word for."""
    table = {}
    for key, value in values.items():
        value = value._asdict() if hasattr(value, "_asdict") else value
        table[key] = _plain(value) if isinstance(value, Mapping) else value
    return table
