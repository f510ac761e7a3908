"""Suite mrpb: the tests of MRPB 1.0 [MRPB], numbered in the order of its file.

A Pioneer 3-DX has the test's prior map and plans through what is unknown on it; the true map is what
it meets. People walk through their keys in a loop, linear between them, as discs of 0.3 m. The goal is
reached within 0.2 m and 0.1 rad. A test without maps is an empty world as large as its people's walks.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options, data_folder
from dynastar.bench.suites.common import empty_map
from dynastar.episode import Episode
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.io.maps import load_map
from dynastar.io.mrpb import FILE, MrpbTest, load_mrpb
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Scenario

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 12

COMPARABLE = (
    "Maps, starts, goals, robot and tolerances are MRPB's, its metrics are in the rows; its people walk "
    "on splines in Gazebo and on straight lines here. No figures of its planners come with the data."
)

WALKER_RADIUS = 0.3  # m
GOAL_TOLERANCE, HEADING_TOLERANCE = 0.2, 0.1  # m, rad
TIME_LIMIT = 300.0  # s; MRPB names none
SAFE_DISTANCE = 0.3  # m from the footprint; MRPB leaves d_safe to its user
RESOLUTION, MARGIN = 0.1, 5.0  # m, of an empty world's map and round its walks


def missions(options: Options) -> Iterator[Mission]:
    """The tests in the file's order."""
    for number, _ in enumerate(_tests(options)):
        yield Mission(number)


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves nothing out."""
    del mission, options
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """A test as a mission."""
    del repeat
    test = _tests(options)[mission.number]
    true = _empty(test) if test.true_map is None else _map(test.true_map)
    made = Scenario(
        name=f"mrpb {mission.number}: {test.scenario} {test.test}",
        grid=true if test.prior_map is None else _map(test.prior_map),
        world=true,
        robot=ROBOTS["pioneer3dx"],
        start=test.start,
        goals=(Goal(*test.goal),),
        movers=tuple(
            Mover(WALKER_RADIUS, keys[:, 0], keys[:, 1:], "loop") for keys in test.walkers
        ),
        seed=mission.number,
        goal_tolerance=GOAL_TOLERANCE,
        heading_tolerance=HEADING_TOLERANCE,
        time_limit=TIME_LIMIT,
        unknown="free",
    )
    return driven.realistic(made, options)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a test; adds ``time_near_obstacles`` and ``velocity_smoothness`` to the row."""
    test = _tests(options)[mission.number]
    return driven.run_mission(
        scenario(mission, options, repeat),
        options,
        mission,
        repeat,
        group=test.scenario,
        extra=mrpb_metrics,
    )


def mrpb_metrics(episode: Episode) -> dict[str, float | None]:
    """MRPB's metrics that ``Metrics`` does not have.

    ``time_near_obstacles`` is the fraction of ticks nearer than 0.3 m to something;
    ``velocity_smoothness`` (m/s2) is the mean of the forward acceleration's size.
    """
    steps = np.diff(episode.trajectory.times)
    changes = np.abs(np.diff(episode.trajectory.twists[:, 0]))
    near = episode.clearance[np.isfinite(episode.clearance)] < SAFE_DISTANCE
    return {
        "time_near_obstacles": float(near.mean()) if len(near) else None,
        "velocity_smoothness": float((changes / steps).mean()) if len(steps) else None,
    }


def _tests(options: Options) -> tuple[MrpbTest, ...]:
    return load_mrpb(data_folder(options, "mrpb", FILE))


@lru_cache(maxsize=4)
def _map(path: Path) -> OccupancyGrid:
    return load_map(path)


def _empty(test: MrpbTest) -> OccupancyGrid:
    points = np.vstack([[test.start[:2], test.goal[:2]], *(keys[:, 1:] for keys in test.walkers)])
    (x0, y0), (x1, y1) = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    return empty_map((float(x0), float(x1)), (float(y0), float(y1)), RESOLUTION)
