"""Suite crowd: a robot crosses recorded pedestrians [Pellegrini2009], [Lerner2007].

Every recording has eight start times, spread evenly from its begin to 60 s before its end, and six
pairs of entries: west to east, east to west, south to north, north to south, and two diagonals.
Mission number = 100 * recording (by name) + 10 * pair + time. See ``crowd_worlds`` for the rules that
say where entries are and when exactly a mission starts.

The pedestrians are discs of 0.25 m that follow their tracks and do not react to each other; they are
gone after their last key. They notice the robot late (``simulation.attention``), with ``--attention
none`` never. ``contact_on_appearing`` of a row tells that the pedestrian who was touched had appeared
within 1 s before.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options, data_folder
from dynastar.bench.robots import CROWD_ROBOT
from dynastar.bench.suites.common import touched_mover
from dynastar.bench.suites.crowd_worlds import (
    Point,
    clear_start,
    entries,
    pedestrians,
    start_times,
    way_exists,
    with_walk_in,
)
from dynastar.episode import Episode
from dynastar.errors import DataError
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.io.maps import load_map
from dynastar.io.pedestrians import Recording, load_recording
from dynastar.simulation import Mover, Scenario
from dynastar.simulation.scenario import Attention

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 20
ATTENTION: Attention = "late"

COMPARABLE = (
    "The recordings are public, the missions are this suite's: no published figure compares."
)

PAIRS = (("W", "E"), ("E", "W"), ("S", "N"), ("N", "S"), ("SW", "NE"), ("NE", "SW"))
TIMES = 8
GOAL_TOLERANCE = 0.5  # m
TIME_LIMIT = 120.0  # s
JUST_APPEARED = 1.0  # s


class _Place(NamedTuple):
    """A recording, with its walk-ins, its map and its entries by name."""

    recording: Recording
    grid: OccupancyGrid
    entries: dict[str, Point]


def missions(options: Options) -> Iterator[Mission]:
    """Recordings, pairs and times in that order; ``spec`` is (file's name, pair, time)."""
    folder = _folder(options)
    for index, path in enumerate(sorted(folder.glob("*.csv"))):
        for pair in range(len(PAIRS)):
            for time in range(TIMES):
                yield Mission(100 * index + 10 * pair + time, (path.name, pair, time))


def leave_out(mission: Mission, options: Options) -> str:
    """Pairs without a way for the robot, and times without a clear moment to start at."""
    place, start, goal = _crossing(mission, options)
    if not way_exists(place.grid, CROWD_ROBOT, start, goal):
        return "no way for the robot between the entries"
    if _begin(mission, options) is None:
        return "the start is never clear for long enough"
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """A crossing; raises DataError for one that ``leave_out`` leaves out."""
    del repeat
    place, start, goal = _crossing(mission, options)
    begin = _begin(mission, options)
    if begin is None:
        raise DataError(f"crowd {mission.number}: the start is never clear for long enough")
    made = Scenario(
        name=f"crowd {mission.number}: {place.recording.name}, {'-'.join(PAIRS[mission.spec[1]])}",
        grid=place.grid,
        robot=CROWD_ROBOT,
        start=(*start, None),
        goals=(Goal(*goal),),
        movers=pedestrians(place.recording, begin, begin + TIME_LIMIT),
        attention=ATTENTION,
        seed=mission.number,
        goal_tolerance=GOAL_TOLERANCE,
        time_limit=TIME_LIMIT,
    )
    return driven.realistic(made, options)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a crossing; adds ``start_time`` (s) and ``contact_on_appearing`` to the row."""
    made = scenario(mission, options, repeat)

    def extra(episode: Episode) -> dict[str, Any]:
        return {
            "start_time": _begin(mission, options),
            "contact_on_appearing": contact_on_appearing(episode, made.movers),
        }

    group = Path(mission.spec[0]).stem
    return driven.run_mission(made, options, mission, repeat, group=group, extra=extra)


def contact_on_appearing(episode: Episode, movers: tuple[Mover, ...]) -> bool:
    """Whether the robot was touched by a mover that had appeared within 1 s before."""
    touched = touched_mover(episode)
    if touched is None:
        return False
    appeared = float(movers[touched].times[0])
    return appeared > 0.0 and float(episode.trajectory.times[-1]) - appeared <= JUST_APPEARED


def _folder(options: Options) -> Path:
    return data_folder(options, "crowd", "*_map.yaml", "pedestrians")


@lru_cache(maxsize=4)
def _place(path: Path) -> _Place:
    recording = load_recording(path)
    grid = load_map(path.with_name(f"{path.stem}_map.yaml"))
    found = entries(recording, grid, CROWD_ROBOT)
    return _Place(with_walk_in(recording, grid), grid, found)


def _crossing(mission: Mission, options: Options) -> tuple[_Place, Point, Point]:
    name, pair, _ = mission.spec
    place = _place(_folder(options) / name)
    start, goal = PAIRS[pair]
    return place, place.entries[start], place.entries[goal]


def _begin(mission: Mission, options: Options) -> float | None:
    place, start, _ = _crossing(mission, options)
    nominal = start_times(place.recording, TIMES)[mission.spec[2]]
    return clear_start(place.recording, start, nominal)
