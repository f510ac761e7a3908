"""Suite physics: missions in another physics engine, MuJoCo (extra ``physics``).

Mission n has the (n mod 3)-th robot, the (n // 3 mod 2)-th floor, a payload if n // 6 is odd, and the
(n // 12 mod 4)-th map; start, goal, heading and unmapped boxes are drawn from ``[seed, n]`` as in the
suite ``robots``. Motors of limited torque turn two wheels, which slip; mass makes the robot slow to
follow. The engine's own contacts of the hull decide, and its own pose on arrivals. Masses, floors and
motors are assumptions. Accelerations are those that all floors allow. The navigator is told the latency
and, on top, the time constant of the motors with that payload.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from dynastar.bench import driven
from dynastar.bench.bound import least_time
from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Mission, Options, endless
from dynastar.bench.suites.physics_model import Body
from dynastar.bench.suites.physics_world import PhysicsWorld
from dynastar.bench.suites.random_worlds import verdict
from dynastar.bench.suites.robots_sold import CART, WAFFLE
from dynastar.bench.suites.robots_worlds import (
    GOAL_TOLERANCE,
    RobotWorld,
    draw_map,
    draw_world,
    name_of,
)
from dynastar.errors import DataError
from dynastar.robot import ROBOTS, Robot
from dynastar.simulation import Noise, Scenario, run

DEFAULT_MISSIONS = 50
QUICK_MISSIONS = 8

COMPARABLE = "The missions are this suite's own: no published figure is comparable."

GENTLE = {"v_accel": 1.0, "v_brake": 1.0, "omega_accel": 2.0, "omega_brake": 2.0}
PIONEER = ROBOTS["pioneer3dx"]
BODIES: tuple[tuple[Robot, Body], ...] = (
    (PIONEER, Body(9.0, 17.0, 0.32, 0.0975, ((0.18, 0.0), (-0.18, 0.0)))),
    (WAFFLE, Body(1.8, 10.0, 0.287, 0.033, ((-0.177, 0.064), (-0.177, -0.064)))),
    (CART, Body(40.0, 60.0, 0.44, 0.1, ((0.75, 0.2), (0.75, -0.2)))),
)
FLOORS = (0.9, 0.3)  # friction: rubber on dry concrete, a smooth floor
PLACES = (("hall", 1), ("doorway", 1), ("clutter", 1), ("office", 1))
LATENCY = 0.05  # s
PATIENCE, EXTRA_TIME = 4.0, 90.0  # times the least time, s


@dataclass(frozen=True)
class Made:
    """A mission: robot, its body, friction of the floor, with payload or not, map and world."""

    robot: Robot
    body: Body
    floor: float
    loaded: bool
    place: tuple[str, int]
    world: RobotWorld


missions = endless


def leave_out(mission: Mission, options: Options) -> str:
    """Numbers for which the rules find no mission."""
    made = make(options.seed, mission.number)
    return made if isinstance(made, str) else ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission of a number; raises DataError for one that ``leave_out`` leaves out."""
    del repeat
    made = _made(mission, options)
    late = 0.0 if options.ideal else LATENCY
    latency = driven.PERIOD * math.ceil((late + made.body.response(made.loaded)) / driven.PERIOD)
    return Scenario(
        name=f"physics {mission.number}: {made.robot.name}, {name_of(made.place)}",
        grid=draw_map(*made.place),
        robot=made.robot,
        start=made.world.start,
        goals=(made.world.goal,),
        obstacles=made.world.obstacles,
        noise=Noise() if options.ideal else Noise(0.01, 0.01),
        latency=late,
        seed=mission.number,
        goal_tolerance=GOAL_TOLERANCE,
        time_limit=round(
            PATIENCE * least_time(made.world.length, made.robot.limits) + EXTRA_TIME, 1
        ),
        navigator={"period": driven.PERIOD, "latency": round(latency, 6)},
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission in the engine."""
    made = _made(mission, options)
    asked = driven.asked(scenario(mission, options, repeat), options, repeat)
    episode = run(
        asked,
        navigator=controller_named(options.controller),
        trace=options.observe is not None,
        make_world=partial(PhysicsWorld, body=made.body, floor=made.floor, loaded=made.loaded),
    )
    facts = {"map": name_of(made.place), "floor": made.floor, "loaded": made.loaded}
    row = driven.row_of_episode(episode, asked, group=made.robot.name)
    row |= {**facts, **verdict(episode, made.world.reachable)}
    if options.observe is not None:
        options.observe(mission, repeat, episode, row)
    return row


@lru_cache(maxsize=8)
def make(seed: int, number: int) -> Made | str:
    """The mission of a number, or why the rules leave it out."""
    robot, body = BODIES[number % len(BODIES)]
    robot = replace(robot, limits=robot.limits._replace(**GENTLE))
    floor, loaded = FLOORS[number // 3 % 2], number // 6 % 2 == 1
    place = PLACES[number // 12 % len(PLACES)]
    world = draw_world(*place, robot, np.random.default_rng([seed, number, 1]))
    return world if isinstance(world, str) else Made(robot, body, floor, loaded, place, world)


def _made(mission: Mission, options: Options) -> Made:
    made = make(options.seed, mission.number)
    if isinstance(made, str):
        raise DataError(f"physics {mission.number}: {made}")
    return made
