"""Suite dynabarn: worlds of the DynaBARN data set [DynaBARN], each from four start times.

Mission number = 4 * world + phase. Phase 0 begins with the recording; phases 1 to 3 begin at times
drawn from 0 to 60 s by the world's number, the phase and the seed. A Jackal crosses the arena from
(11, 0) to (-9, 0): it knows the walls, and finds the discs of 0.5 m with its lidar alone. They follow
their keys in a loop and react to nobody.

At the end of a loop most discs jump back to their first key. A jump onto the robot cannot be avoided:
``contact_after_jump`` of the row tells that the disc that was touched had jumped within 0.2 s before.

Published runs are of robots that drive at 0.5 m/s at most. The missions from 1000 on are those from 0 on
with that top speed; they are run with ``--select`` only (``1000::2``: two phases of each).
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options, data_folder
from dynastar.bench.suites.challenge import (
    ARRIVED_WITHIN,
    FULL_SPEED,
    TIME_LIMIT,
    challenge_keys,
    challenge_score,
)
from dynastar.bench.suites.common import empty_map, touched_mover
from dynastar.episode import Episode
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.io.dynabarn import FILE, DynaBarn, load_dynabarn
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Scenario

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 24

PUBLISHED = (
    ("DWA at 0.5 m/s", "success 0.78 easy, 0.43 medium, 0.17 hard", "DynaBARN"),
    ("TD3 at 0.5 m/s", "success 0.74 easy, 0.60 medium, 0.28 hard", "DynaBARN"),
    ("Dyna-LfLH at 0.5 m/s", "success 0.225", "DynaLfLH"),
    ("LfH-CP at 0.5 m/s", "success 0.308", "DynaLfLH"),
)
COMPARABLE = (
    "Worlds and robot are those of DynaBARN, the score's formula that of the BARN challenge with the "
    "straight line of 20 m as its path. The published figures, which are quoted from secondary sources, "
    "are of runs in Gazebo at 0.5 m/s; they compare with the missions from 1000 on (--select 1000::2)."
)

PHASES = 4
SLOW_FROM, SLOW = 1000, 0.5  # first number of the slow missions, and their top speed, m/s
LATEST_START = 60.0  # s
JUST_JUMPED = 0.2  # s
SMALLEST_JUMP = 0.05  # m
RESOLUTION = 0.1  # m, of the map
MARGIN = 2.0  # m of the map round the walls and the start


def missions(options: Options) -> Iterator[Mission]:
    """Every world four times; ``spec`` is (world, phase). With ``select`` again, slow."""
    for first in (0, SLOW_FROM) if options.select is not None else (0,):
        for world in _data(options).worlds:
            for phase in range(PHASES):
                yield Mission(first + PHASES * world + phase, (world, phase))


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves nothing out."""
    del mission, options
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """A world from one of its start times."""
    del repeat
    data, robot = _data(options), ROBOTS["jackal"]
    if _is_slow(mission):
        robot = replace(robot, limits=robot.limits._replace(v_max=SLOW))
    world, _ = mission.spec
    start_time = _start_time(mission, options)
    made = Scenario(
        name=f"dynabarn {mission.number}",
        grid=_arena(data),
        robot=robot,
        start=data.start,
        goals=(Goal(*data.goal),),
        movers=tuple(
            Mover(data.radius, keys[:, 0] - start_time, keys[:, 1:], "loop")
            for keys in data.worlds[world].tracks
        ),
        seed=mission.number,
        goal_tolerance=ARRIVED_WITHIN,
        time_limit=TIME_LIMIT,
    )
    return driven.realistic(made, options)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission; adds ``start_time``, ``challenge_time``, ``contact_after_jump`` to the row."""
    data, made = _data(options), scenario(mission, options, repeat)
    optimal_time = float(np.hypot(*np.subtract(data.goal, data.start[:2]))) / FULL_SPEED

    def extra(episode: Episode) -> dict[str, Any]:
        return {
            **challenge_keys(episode, optimal_time),
            "start_time": _start_time(mission, options),
            "contact_after_jump": contact_after_jump(episode, made.movers),
        }

    return driven.run_mission(
        made,
        options,
        mission,
        repeat,
        score=lambda episode: challenge_score(episode, optimal_time),
        group=data.worlds[mission.spec[0]].difficulty + (" 0.5 m/s" if _is_slow(mission) else ""),
        extra=extra,
    )


def contact_after_jump(episode: Episode, movers: tuple[Mover, ...]) -> bool:
    """Whether the robot was touched by a mover that had jumped to its first key within 0.2 s before."""
    touched = touched_mover(episode)
    if touched is None:
        return False
    mover = movers[touched]
    span = float(mover.times[-1] - mover.times[0])
    driven_for = float(episode.trajectory.times[-1] - mover.times[0])
    jump = float(np.hypot(*(mover.points[0] - mover.points[-1])))
    return jump > SMALLEST_JUMP and driven_for >= span and driven_for % span <= JUST_JUMPED


def _is_slow(mission: Mission) -> bool:
    return mission.number >= SLOW_FROM


def _data(options: Options) -> DynaBarn:
    return load_dynabarn(data_folder(options, "dynabarn", FILE))


def _start_time(mission: Mission, options: Options) -> float:
    world, phase = mission.spec
    if phase == 0:
        return 0.0
    random = np.random.default_rng([options.seed, world, phase])
    return round(float(random.uniform(0.0, LATEST_START)), 2)


def _arena(data: DynaBarn) -> OccupancyGrid:
    """The map with the walls on it; a cell is occupied where it overlaps a wall."""
    corners = np.vstack([*data.walls, [data.start[:2]], [data.goal]])
    (x0, y0), (x1, y1) = corners.min(axis=0) - MARGIN, corners.max(axis=0) + MARGIN
    grid = empty_map((float(x0), float(x1)), (float(y0), float(y1)), RESOLUTION)
    occupied = np.zeros((grid.rows, grid.columns), bool)
    for wall in data.walls:
        cells = grid.frame.points_to_grid([wall.min(axis=0), wall.max(axis=0)])
        (top, left), (bottom, right) = np.floor(cells[0] + 1e-6), np.ceil(cells[1] - 1e-6)
        occupied[int(top) : int(bottom), int(left) : int(right)] = True
    return OccupancyGrid.from_occupied(occupied, RESOLUTION, grid.frame.x, grid.frame.y)
