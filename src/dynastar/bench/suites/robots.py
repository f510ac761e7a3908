"""Suite robots: robots as they are sold, whose hardware is not what the navigator is told.

Mission n has the (n mod 8)-th robot of ``robots_sold`` on the (n // 8 mod 12)-th map of
``robots_worlds``; the rest is drawn from ``[seed, n]``: start, goal, a goal heading in half of the
missions, unmapped boxes, and what drive, odometry, lidar and loop do (``robots_hardware``). Nothing
moves but the robot. In one of ten missions boards enclose the goal: the right end is ``blocked``, and the
row's outcome is then ``blocked_rightly``. The true pose and footprint decide on contacts and arrivals.

Numbers for which the rules find no mission are left out. The time limit is 4 times the least time of
the way on the map, plus 90 s. ``--ideal`` gives the same missions to perfect hardware.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench import driven
from dynastar.bench.bound import least_time
from dynastar.bench.missions import Mission, Options, endless
from dynastar.bench.suites.random_worlds import verdict
from dynastar.bench.suites.robots_hardware import Hardware, as_declared, draw_hardware
from dynastar.bench.suites.robots_sold import SOLD
from dynastar.bench.suites.robots_worlds import (
    GOAL_TOLERANCE,
    MAPS,
    RobotWorld,
    draw_map,
    draw_world,
    name_of,
)
from dynastar.episode import Episode
from dynastar.errors import DataError
from dynastar.robot import Robot
from dynastar.simulation import Scenario

DEFAULT_MISSIONS = 200
QUICK_MISSIONS = 16

COMPARABLE = "The missions are this suite's own: no published figure is comparable."

PATIENCE, EXTRA_TIME = 4.0, 90.0  # times the least time, s


class Made(NamedTuple):
    """A mission: its robot, its map by kind and seed, its world and what its hardware does."""

    robot: Robot
    place: tuple[str, int]
    world: RobotWorld
    hardware: Hardware


missions = endless


def leave_out(mission: Mission, options: Options) -> str:
    """Numbers for which the rules find no mission."""
    made = make(options.seed, mission.number)
    return made if isinstance(made, str) else ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission of a number; raises DataError for one that ``leave_out`` leaves out."""
    del repeat
    made = _made(mission, options)
    robot, world, hardware = made.robot, made.world, made.hardware
    perfect = Scenario(
        name=f"robots {mission.number}: {robot.name}, {name_of(made.place)}",
        grid=draw_map(*made.place),
        robot=robot,
        start=world.start,
        goals=(world.goal,),
        obstacles=world.obstacles,
        seed=mission.number,
        goal_tolerance=GOAL_TOLERANCE,
        time_limit=round(PATIENCE * least_time(world.length, robot.limits) + EXTRA_TIME, 1),
    )
    if options.ideal:
        return driven.realistic(perfect, options)
    return replace(
        perfect,
        robot=as_declared(robot, hardware),
        drive=hardware.drive,
        odometry=hardware.odometry,
        lidar=hardware.lidar,
        loop=hardware.loop,
        noise=hardware.noise,
        latency=hardware.latency,
        navigator=hardware.declared,
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission; a ``blocked`` that is right has the outcome ``blocked_rightly``."""
    made = _made(mission, options)

    def extra(episode: Episode) -> Mapping[str, Any]:
        facts = {"map": name_of(made.place), "goal_heading": made.world.goal.heading}
        return {**facts, **verdict(episode, made.world.reachable)}

    return driven.run_mission(
        scenario(mission, options, repeat),
        options,
        mission,
        repeat,
        group=made.robot.name,
        extra=extra,
    )


@lru_cache(maxsize=8)
def make(seed: int, number: int) -> Made | str:
    """The mission of a number, or why the rules leave it out."""
    random = np.random.default_rng([seed, number])
    sold = list(SOLD.values())[number % len(SOLD)]
    place = MAPS[number // len(SOLD) % len(MAPS)]
    hardware = draw_hardware(sold, random)
    world = draw_world(*place, sold.robot, random)
    return world if isinstance(world, str) else Made(sold.robot, place, world, hardware)


def _made(mission: Mission, options: Options) -> Made:
    made = make(options.seed, mission.number)
    if isinstance(made, str):
        raise DataError(f"robots {mission.number}: {made}")
    return made
