"""Suite maps: missions on ROS maps, seeded and numbered from 0 without end.

Mission number n is on map n mod k of the k maps (``*.yaml``) in the folder, in the order of their
names; a YAML file that is no map, such as named goals, is left out. A TurtleBot3 Burger at 0.5 m/s
knows the map, but neither the boxes that stand near its way nor the two people who walk there. See
``map_worlds`` for the rules by which a mission is drawn; a number for which the rules find none is left
out, and so is every number of a map too small for them.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options, data_folder
from dynastar.bench.robots import MAPS_ROBOT
from dynastar.bench.suites.map_worlds import MapWorld, draw_world
from dynastar.errors import DataError
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.io.maps import load_map, map_files
from dynastar.simulation import Scenario

DEFAULT_MISSIONS = 100
QUICK_MISSIONS = 12

COMPARABLE = "The maps are public, the missions are this suite's: no published figure compares."

MOST = 10_000  # missions; so that a folder without a map to use comes to an end
GOAL_TOLERANCE = 0.25  # m
PATIENCE, EXTRA_TIME = 3.0, 60.0  # time limit = 3 x path length / v_max + 60 s


def missions(options: Options) -> Iterator[Mission]:
    """Missions on the maps in turn; ``spec`` is the map's file name."""
    names = [path.name for path in map_files(_folder(options))]
    for number in range(MOST):
        yield Mission(number, names[number % len(names)])


def leave_out(mission: Mission, options: Options) -> str:
    """Numbers for which the rules find no mission."""
    made = _world(_folder(options) / mission.spec, options.seed, mission.number)
    return made if isinstance(made, str) else ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """A mission on its map; raises DataError for one that ``leave_out`` leaves out."""
    del repeat
    path = _folder(options) / mission.spec
    world = _world(path, options.seed, mission.number)
    if isinstance(world, str):
        raise DataError(f"maps {mission.number}: {world}")
    made = Scenario(
        name=f"maps {mission.number}: {path.stem}",
        grid=_map(path),
        robot=MAPS_ROBOT,
        start=(*world.start, None),
        goals=(Goal(*world.goal),),
        obstacles=world.boxes,
        movers=world.walkers,
        seed=mission.number,
        goal_tolerance=GOAL_TOLERANCE,
        time_limit=round(PATIENCE * world.length / MAPS_ROBOT.limits.v_max + EXTRA_TIME, 1),
    )
    return driven.realistic(made, options)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission."""
    made = scenario(mission, options, repeat)
    return driven.run_mission(made, options, mission, repeat, group=Path(mission.spec).stem)


def _folder(options: Options) -> Path:
    return data_folder(options, "maps", "*.yaml", "ros_maps")


@lru_cache(maxsize=8)
def _map(path: Path) -> OccupancyGrid:
    return load_map(path)


@lru_cache(maxsize=32)
def _world(path: Path, seed: int, number: int) -> MapWorld | str:
    return draw_world(_map(path), MAPS_ROBOT.footprint.circumscribed, [seed, number])
