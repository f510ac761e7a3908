"""Suite irsim: missions in ir-sim (extra ``irsim``) among its RVO walkers and its clutter.

Mission n has the (n mod 4)-th of ``KINDS``, in a hall of 12 m by 12 m that the robot crosses at 1 m/s.
ir-sim places clutter and walkers, from the seed ``1000 * seed + n``. Walkers wander from one random place
to the next and avoid each other, the clutter and the robot by RVO. The robot has ir-sim's lidar alone.

ir-sim steps at 0.1 s, moves by explicit Euler steps, gives scans without delay and executes commands at
once. Its own collision flag decides on contacts: shapes that overlap at the end of a step. Walkers that
touch something stop for good. A mission whose clutter leaves no way is left out.
"""

import contextlib
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from dynastar.bench import driven
from dynastar.bench.bound import time_bound
from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Mission, Options, endless
from dynastar.geometry import Goal
from dynastar.simulation import Scenario, run

with contextlib.redirect_stdout(sys.stderr):  # ir-sim prints which windows it cannot open
    import irsim

    from dynastar.adapters.irsim import DEVIATIONS, map_of, robot_of
    from dynastar.bench.suites.irsim_world import IrSimWorld

DEFAULT_MISSIONS = 40
QUICK_MISSIONS = 8

COMPARABLE = "The worlds are this suite's own: no published figure is comparable."


@dataclass(frozen=True)
class Kind:
    """How many walkers and how many pieces of clutter a world has."""

    walkers: int
    clutter: int


KINDS = {
    "walkers": Kind(8, 0),
    "crowd": Kind(16, 0),
    "clutter": Kind(0, 20),
    "mixed": Kind(8, 10),
}
SIDE = 12.0  # m
START, GOAL = (1.0, 6.0, 0.0), (11.0, 6.0)
PLACES = {"range_low": [2.5, 1.0, -3.14], "range_high": [9.5, 11.0, 3.14]}
STEP = 0.1  # s
NOISE = 0.01  # m, standard deviation of a range
TOLERANCE, TIME_LIMIT = 0.3, 90.0  # m, s

missions = endless


def kind_of(mission: Mission) -> str:
    """The name of the kind of a mission's world."""
    return list(KINDS)[mission.number % len(KINDS)]


def leave_out(mission: Mission, options: Options) -> str:
    """Clutter that leaves the robot no way."""
    return "" if time_bound(scenario(mission, options, 0)) else "the clutter leaves no way"


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission as dynastar has it: walkers aside, which ir-sim moves."""
    del repeat
    return _scenario(mission, options, make_env(mission, options))


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission in ir-sim."""
    env = make_env(mission, options)
    asked = driven.asked(_scenario(mission, options, env), options, repeat)
    episode = run(
        asked,
        navigator=controller_named(options.controller),
        trace=options.observe is not None,
        make_world=partial(IrSimWorld, env=env),
    )
    row = driven.row_of_episode(episode, asked, group=kind_of(mission))
    if options.observe is not None:
        options.observe(mission, repeat, episode, row)
    return row


def _scenario(mission: Mission, options: Options, env: Any) -> Scenario:
    return Scenario(
        name=f"irsim {mission.number}: {kind_of(mission)}",
        grid=map_of(env),
        robot=robot_of(env.robot),
        start=START,
        goals=(Goal(*GOAL),),
        obstacles=tuple(np.array(thing.vertices.T) for thing in env.obstacle_list if thing.static),
        seed=mission.number,
        goal_tolerance=TOLERANCE,
        time_limit=TIME_LIMIT,
        navigator={"period": STEP, "range_error": 0.01 if options.ideal else DEVIATIONS * NOISE},
    )


def make_env(mission: Mission, options: Options) -> Any:
    """The ir-sim world of a mission, its clutter in places where nothing overlaps."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "world.yaml"
        file.write_text(yaml.safe_dump(world_of(KINDS[kind_of(mission)], options.ideal)))
        seed = 1000 * options.seed + mission.number
        env = irsim.make(str(file), headless=True, log_level="ERROR", seed=seed)
    env.random_obstacle_position(**PLACES, non_overlapping=True)
    env.refresh()
    return env


def world_of(kind: Kind, ideal: bool = False) -> dict[str, Any]:
    """The contents of an ir-sim world file."""
    lidar = {"name": "lidar2d", "range_max": 8.0, "angle_range": 6.2831853, "number": 361}
    robot = {
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": 0.25},
        "state": list(START),
        "goal": [*GOAL, 0.0],
        "goal_threshold": TOLERANCE,
        "vel_min": [-0.3, -1.5],
        "vel_max": [1.0, 1.5],
        "acce": [1.0, 3.0],
        "sensors": [{**lidar, "noise": not ideal, "std": NOISE}],
    }
    return {
        "world": {"width": SIDE, "height": SIDE, "step_time": STEP, "collision_mode": "stop"},
        "robot": [robot],
        "obstacle": [*_walkers(kind.walkers), *_clutter(kind.clutter)],
    }


def _walkers(number: int) -> Iterator[dict[str, Any]]:
    wander = {"name": "rvo", "wander": True, "vxmax": 1.0, "vymax": 1.0}
    area = {"range_low": [1.0, 1.0, -3.14], "range_high": [SIDE - 1.0, SIDE - 1.0, 3.14]}
    for _ in range(number):
        yield {
            "kinematics": {"name": "omni"},
            "shape": {"name": "circle", "radius": 0.3},
            "behavior": {**wander, **area},
            "vel_min": [-1.0, -1.0],
            "vel_max": [1.0, 1.0],
        }


def _clutter(number: int) -> Iterator[dict[str, Any]]:
    for n in range(number):
        box = {"name": "rectangle", "length": 0.4 + 0.1 * (n % 7), "width": 0.4}
        yield {"shape": box if n % 2 else {"name": "circle", "radius": 0.2 + 0.05 * (n % 5)}}
