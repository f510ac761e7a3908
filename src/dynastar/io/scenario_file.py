"""Scenario files: TOML, checked key by key, so that a typo names the key and the nearest right one.

The keys are those of ``scenario_tables``; ``[sensor]`` holds those of ``Lidar`` and of ``Noise``.
"""

import math
import os
import re
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dynastar import simulation
from dynastar.config import checked, choose, nearest, shown
from dynastar.episode import Episode
from dynastar.errors import ConfigError, InputError, MapError, OutOfMap, ScenarioError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.io.examples import example_scenarios
from dynastar.io.files import MAX_TABLE_BYTES, read_bytes
from dynastar.io.maps import load_map
from dynastar.io.scenario_tables import MapTable, PlaceTable, RobotTable, ScenarioTable
from dynastar.io.scenario_things import contains, read_mover, read_obstacle
from dynastar.masks import SpeedScale, with_keepout, with_speed_limits
from dynastar.navigator import NavigatorConfig
from dynastar.paths import local_path
from dynastar.planning import ALGORITHMS
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.simulation.run import effective_config
from dynastar.simulation.scenario import Noise, Scenario
from dynastar.simulation.start import check_start

_STRING = (  # or what is left of one that has no end
    r'"""(?:\\.|[^\\])*?(?:"""|\Z)' r"|'{3}.*?(?:'{3}|\Z)" r'|"(?:\\.|[^"\\\n])*+"?' r"|'[^'\n]*+'?"
)
_PART = rf"(?>[\w-]+|{_STRING})[ \t]*+"
_DEEP = rf"{_PART}(?:\.[ \t]*{_PART}){{32}}"
_TOKEN = re.compile(rf"(?P<deep>{_DEEP})|{_STRING}|#[^\n]*|[\w-]+|.", re.DOTALL)

DATA_VARIABLE = "DYNASTAR_DATA"
# A map and a mission for a file that tells of a robot alone, and the keys that such a file can lack.
NOWHERE: Mapping[str, Any] = {"map": {"rows": ["."]}, "start": [0.5, 0.5, 0.0], "goal": [0.5, 0.5]}
OF_A_PLACE = {
    *NOWHERE, "goals", "world", "keepout", "speed_limit", "obstacles", "movers",
}  # fmt: skip
# Tables of what a robot does otherwise than declared.
FAULTS = "drive", "odometry", "lidar", "loop"


def load_scenario(path: str | Path) -> Scenario:
    """The scenario in a TOML file, or the example of that name, such as ``office``.

    A map's name is relative to the file, and may start with ``${DYNASTAR_DATA}``. Raises
    ScenarioError, led by the file's name, for whatever is missing, misspelt or contradictory.
    """
    path = local_path(path, ScenarioError)
    if path.suffix == "" and len(path.parts) == 1 and not path.is_file():
        try:
            path = choose(str(path), example_scenarios(), "scenario")
        except ConfigError as error:
            raise ScenarioError(str(error)) from None
    source = _read_toml(path)
    try:
        return read_scenario(source, path.parent, path.stem)
    except InputError as error:
        raise ScenarioError(f"{path}: {error}") from None


def load_robot(path: str | Path) -> tuple[Robot, NavigatorConfig]:
    """The robot in a TOML file, and the navigator's settings for it.

    The file has the keys of a scenario; what tells of a place or a mission is not needed and is not
    read. Raises ScenarioError, led by the file's name.
    """
    scenario = _load_robot(path)
    return scenario.robot, effective_config(scenario)


def load_faults(path: str | Path) -> dict[str, Any]:
    """The tables [drive], [odometry], [lidar] and [loop] of a robot's file, for its simulation."""
    source = _load_robot(path).source
    return {key: source[key] for key in FAULTS if key in source}


def _load_robot(path: str | Path) -> Scenario:
    """The robot in a TOML file, nowhere."""
    path = local_path(path, ScenarioError)
    source = _read_toml(path)
    try:
        checked(ScenarioTable, {**NOWHERE, **source})
        told = {key: value for key, value in source.items() if key not in OF_A_PLACE}
        return read_scenario({**told, **NOWHERE}, path.parent, path.stem)
    except InputError as error:
        raise ScenarioError(f"{path}: {error}") from None


def _read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file; raises ScenarioError for what is none."""
    data = read_bytes(path, MAX_TABLE_BYTES, ScenarioError)
    try:
        text = data.decode("utf-8-sig")
        if any(token.lastgroup for token in _TOKEN.finditer(text)):
            raise ValueError("a key of more than 32 parts")  # tomllib takes their square
        return tomllib.loads(text)
    except UnicodeDecodeError:
        raise ScenarioError(f"{path}: this is not UTF-8 text: save it as UTF-8") from None
    except RecursionError:
        raise ScenarioError(f"{path}: this TOML is nested too deep") from None
    except ValueError as error:
        raise ScenarioError(f"{path}: this is not valid TOML: {error!s:.120}") from None


def read_scenario(source: Mapping[str, Any], folder: Path, name: str) -> Scenario:
    """The scenario in a parsed TOML file of ``folder``, by default called ``name``; InputError."""
    table = checked(ScenarioTable, source)
    robot, noise = _sensor(table.sensor, _robot(table.robot))
    start = _place(table.start, "start")
    scenario = Scenario(
        name=table.name or name,
        grid=_masked(table, folder, robot),
        world=None if table.world is None else _map(table.world, folder, "world"),
        robot=robot,
        noise=noise,
        start=(start.x, start.y, start.heading),
        goals=_goals(table),
        obstacles=tuple(
            read_obstacle(row, where) for where, row in _rows(table.obstacles, "obstacles")
        ),
        movers=tuple(
            read_mover(row, where, table.time_limit) for where, row in _rows(table.movers, "movers")
        ),
        attention=table.attention,
        legs=table.legs,
        drive=table.drive,
        odometry=table.odometry,
        lidar=table.lidar,
        loop=table.loop,
        latency=table.latency,
        goal_tolerance=table.goal_tolerance,
        heading_tolerance=table.heading_tolerance,
        time_limit=table.time_limit,
        unknown=table.unknown,
        seed=table.seed,
        preset=table.preset,
        navigator=_table(table.navigator, "navigator"),
        source=source,
    )
    _check_navigator(scenario)
    _check_places(scenario)
    return scenario


def run(
    scenario: Scenario | str | Path,
    progress: bool = False,
    seed: int | None = None,
    navigator: Callable[..., simulation.Controller] | None = None,
    trace: bool = False,
) -> Episode:
    """Drives a scenario, or the one in a file, in simulation: see ``simulation.run``.

    With ``trace`` the episode keeps what the navigator considered in each tick, and a notebook shows it.

    Raises StartOccupied, too, for a robot that overlaps a wall or an obstacle at its start.
    """
    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario)
    check_start(scenario)
    return simulation.run(scenario, progress, seed, navigator=navigator, trace=trace)


def _table(value: Any, where: str) -> dict[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise ConfigError(f"'{where}' is {shown(value)}: expected a table")
    return dict(value)


def _rows(value: Any, where: str) -> list[tuple[str, Any]]:
    if value is None:
        return []
    if not isinstance(value, list):
        raise ConfigError(f"'{where}' is {shown(value)}: expected tables headed [[{where}]]")
    return [(f"{where}[{number}]", row) for number, row in enumerate(value)]


def _map(value: Any, folder: Path, where: str) -> OccupancyGrid:
    if isinstance(value, str):
        return load_map(folder / local_path(_expanded(value, where), MapError))
    if not isinstance(value, Mapping):
        raise ConfigError(f"'{where}' is {shown(value)}: expected a file's name or a table")
    table = checked(MapTable, value, where)
    try:
        return OccupancyGrid.from_text(table.rows, table.resolution, *table.origin)
    except MapError as error:
        raise MapError(f"'{where}.rows': {error}") from None


def _masked(table: ScenarioTable, folder: Path, robot: Robot) -> OccupancyGrid:
    """The map, with keep-out zones and speed limits laid over it."""
    grid = _map(table.map, folder, "map")
    if table.keepout is not None:
        grid = with_keepout(grid, _map(table.keepout, folder, "keepout"))
    if table.speed_limit is not None:
        values = _table(table.speed_limit, "speed_limit")
        mask = _map(values.pop("mask", None), folder, "speed_limit.mask")
        scale = checked(SpeedScale, values, "speed_limit")
        grid = with_speed_limits(grid, mask, robot.limits.v_max, scale)
    return grid


def _expanded(name: str, where: str) -> str:
    for variable in re.findall(r"\$\{([^}]*)\}", name):
        if variable != DATA_VARIABLE:
            raise ConfigError(f"'{where}' has ${{{variable}}}: only ${{{DATA_VARIABLE}}} is known")
        if not os.environ.get(variable):
            raise ConfigError(
                f"'{where}' is {name!r}, and {variable} is not set in the environment"
            )
        name = name.replace(f"${{{variable}}}", os.environ[variable])
    return name


def _robot(value: Any) -> Robot:
    if isinstance(value, str):
        return choose(value, ROBOTS, "robot")
    table = checked(RobotTable, value, "robot")
    robot = choose(table.base, ROBOTS, "robot")
    limits = _overridden(Limits, robot.limits, _table(table.limits, "robot.limits"), "robot.limits")
    footprint = robot.footprint
    if table.radius is not None and table.polygon is not None:
        raise ConfigError("'robot' has a radius and a polygon: expected one of them")
    if table.radius is not None:
        footprint = Footprint.disc(table.radius)
    if table.polygon is not None:
        footprint = Footprint.polygon(table.polygon)
    return Robot(robot.name, limits, footprint, robot.lidar)


def _sensor(value: Any, robot: Robot) -> tuple[Robot, Noise]:
    table = _table(value, "sensor")
    legal = Lidar._fields + Noise._fields
    for key in table:
        if key not in legal:
            raise ConfigError(f"unknown key 'sensor.{key}'{nearest(key, legal)}")
    noise = {key: table.pop(key) for key in Noise._fields if key in table}
    lidar = _overridden(Lidar, robot.lidar, table, "sensor")
    return Robot(robot.name, robot.limits, robot.footprint, lidar), checked(Noise, noise, "sensor")


def _overridden(cls: Any, base: Any, overrides: Mapping[str, Any], where: str) -> Any:
    return checked(cls, {**base._asdict(), **overrides}, where)


def _place(value: Any, where: str) -> PlaceTable:
    if isinstance(value, list):
        if len(value) not in (2, 3):
            raise ConfigError(f"'{where}' is {shown(value)}: expected [x, y] or [x, y, heading]")
        value = dict(zip(PlaceTable._fields, value, strict=False))
    return checked(PlaceTable, value, where)


def _goals(table: ScenarioTable) -> tuple[Goal, ...]:
    if table.goal is not None and table.goals is not None:
        raise ConfigError("there is 'goal' and there is 'goals': expected one of them")
    rows = [("goal", table.goal)] if table.goal is not None else _rows(table.goals, "goals")
    if not rows:
        raise ConfigError("there is no goal: expected goal = [x, y] or tables headed [[goals]]")
    return tuple(Goal(*_place(row, where)) for where, row in rows)


def _check_navigator(scenario: Scenario) -> None:
    from dynastar.navigator.config import configured

    try:
        config = configured(scenario.preset, scenario.navigator)
        choose(config.planner.planner, ALGORITHMS, "planner")
    except ConfigError as error:
        raise ConfigError(f"in [navigator]: {error}") from None


def _check_places(scenario: Scenario) -> None:
    places = [("the start", scenario.start[0], scenario.start[1])]
    places += [(f"goals[{n}]", goal.x, goal.y) for n, goal in enumerate(scenario.goals)]
    for what, x, y in places:
        try:
            cell = scenario.grid.world_to_cell(x, y)
        except OutOfMap as error:
            raise OutOfMap(f"{what} {error}") from None
        if scenario.grid.occupied[cell]:
            raise ScenarioError(f"{what} ({x:g}, {y:g}) is in an occupied cell of the map")
    _, x, y = places[0]
    world = scenario.world
    if world is not None and not (world.contains(x, y) and _is_free(world, x, y)):
        raise ScenarioError(f"the start ({x:g}, {y:g}) is off the true map or occupied there")
    for number, polygon in enumerate(scenario.obstacles):
        if contains(polygon, x, y):
            raise ScenarioError(f"the start ({x:g}, {y:g}) is inside obstacles[{number}]")
    for number, mover in enumerate(scenario.movers):
        if mover.times[0] <= 0.0 and math.dist(mover.points[0], (x, y)) <= mover.radius:
            raise ScenarioError(f"the start ({x:g}, {y:g}) is inside movers[{number}]")


def _is_free(world: OccupancyGrid, x: float, y: float) -> bool:
    return not world.occupied[world.world_to_cell(x, y)]
