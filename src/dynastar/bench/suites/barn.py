"""Suite barn: the static worlds of the BARN challenge [BARN], numbered as there.

A Jackal crosses a field of cylinders from (-2.25, 3, pi/2) to (-2.25, 13). It has no map of the
field: the map is empty, and the lidar finds the cylinders and the row of them round the field. As in
the challenge a run ends within 1 m of the goal, so that is the mission's goal tolerance.
"""

from collections.abc import Iterator
from typing import Any

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options, data_folder
from dynastar.bench.suites.challenge import (
    ARRIVED_WITHIN,
    FULL_SPEED,
    TIME_LIMIT,
    challenge_keys,
    challenge_score,
)
from dynastar.bench.suites.common import disc_polygon, empty_map
from dynastar.geometry import Goal
from dynastar.io.barn import ARCHIVE, GOAL, START, load_barn_worlds, official_length
from dynastar.robot import ROBOTS
from dynastar.simulation import Scenario

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 40

PUBLISHED = (
    ("DWA baseline at 0.5 m/s", "success 0.850, score 0.159", "BARNChallenge"),
    ("LiCS-KI, winner of the simulation in 2024", "success 0.980, score 0.489, 7.7 s", "LiCS"),
    ("winner of the simulation in 2026", "score 0.4975", "BARNChallenge"),
)
COMPARABLE = (
    "Worlds, robot, time limit and score are the challenge's. The published runs are of 50 worlds, 10 "
    "times each, in Gazebo; these figures are of another simulator: indicative, never official."
)

RESOLUTION = 0.1  # m, of the empty map
MARGIN = 4.0  # m of the empty map round the field and the goal
GROUP = "static"


def missions(options: Options) -> Iterator[Mission]:
    """The worlds of the archive, by their numbers."""
    for number in load_barn_worlds(data_folder(options, "barn", ARCHIVE)):
        yield Mission(number)


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves nothing out."""
    del mission, options
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """A world as a mission; raises DataError for a number that the archive does not have."""
    del repeat
    cylinders = load_barn_worlds(data_folder(options, "barn", ARCHIVE))[mission.number]
    low, high = cylinders[:, :2].min(axis=0), cylinders[:, :2].max(axis=0)
    x = min(low[0], GOAL[0]) - MARGIN, max(high[0], GOAL[0]) + MARGIN
    y = min(low[1], START[1]) - MARGIN, max(high[1], GOAL[1]) + MARGIN
    made = Scenario(
        name=f"barn {mission.number}",
        grid=empty_map(_rounded(x), _rounded(y), RESOLUTION),
        robot=ROBOTS["jackal"],
        start=START,
        goals=(Goal(*GOAL),),
        obstacles=tuple(disc_polygon(*map(float, cylinder)) for cylinder in cylinders),
        seed=mission.number,
        goal_tolerance=ARRIVED_WITHIN,
        time_limit=TIME_LIMIT,
    )
    return driven.realistic(made, options)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a world; adds ``challenge_time`` and ``optimal_time``, s, to the row."""
    optimal_time = (
        official_length(data_folder(options, "barn", ARCHIVE), mission.number) / FULL_SPEED
    )
    return driven.run_mission(
        scenario(mission, options, repeat),
        options,
        mission,
        repeat,
        score=lambda episode: challenge_score(episode, optimal_time),
        group=GROUP,
        extra=lambda episode: challenge_keys(episode, optimal_time),
    )


def _rounded(span: tuple[float, float]) -> tuple[float, float]:
    return round(float(span[0]), 1), round(float(span[1]), 1)
