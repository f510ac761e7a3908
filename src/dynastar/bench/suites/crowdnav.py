"""Suite crowdnav: the published task of crossing a circle of people [Chen2019] (extra ``crowdnav``).

People start near a circle of 4 m, avoid each other by ORCA and cross it; the robot crosses it from
(0, -4) to (0, 4) within 24 s. Radii are 0.3 m, speeds 1 m/s at most, decisions fall every 0.25 s. Mission
number = 10000 * variant + numpy seed of the case; without ``--select`` it runs the 500 published test
cases of the first variant, seeds 1000 to 1499. Seeds 0 to 99, which ``--quick`` uses, and from 2000 on are
for development. Variants, which are the row's ``group``:

0. ``circle``: five people who do not see the robot, as in the table in print
1. ``square``: they cross a square of 10 m instead
2. ``visible``: they see the robot, as they see each other
3. ``ten``: ten people
4. ``some_see``: each person sees the robot with probability 0.2
5. ``told``: the navigator is told the true positions and last velocities
6. ``orca``: ORCA moves the robot, which checks this suite against print

The robot is a unicycle that does not back up. It finds people by lidar, and comes to rest at the goal.
"""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench import driven
from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites.common import empty_map
from dynastar.bench.suites.crowdnav_people import (
    ENDS,
    RADIUS,
    SPEED,
    STEP,
    OrcaPeople,
    draw_walks,
)
from dynastar.bench.suites.crowdnav_robots import OrcaWorld, Passenger, ToldNavigator
from dynastar.footprint import Footprint
from dynastar.geometry import Goal
from dynastar.robot import Lidar, Limits, Robot
from dynastar.simulation import Noise, Scenario, World, run

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 24

PUBLISHED = (
    ("ORCA", "success 0.43, collisions 0.57, 10.9 s", "Chen2019"),
    ("CADRL", "success 0.78, collisions 0.22, 10.8 s", "Chen2019"),
    ("LSTM-RL", "success 0.95, collisions 0.03, 11.8 s", "Chen2019"),
    ("SARL", "success 0.99, collisions 0.01, 10.6 s", "Chen2019"),
    ("OM-SARL", "success 1.00, collisions 0.00, 10.5 s", "Chen2019"),
)
COMPARABLE = (
    "Published figures are of 500 cases of the variant circle. In print a robot knows all positions and "
    "velocities, moves sideways and changes its velocity at once; here it does none of these."
)


class Variant(NamedTuple):
    """A kind of mission: its people, and what drives among them."""

    name: str
    people: int = 5
    square: bool = False
    seeing: float = 0.0  # probability that a person sees the robot
    told: bool = False
    by_orca: bool = False


VARIANTS: tuple[Variant, ...] = (
    Variant("circle"),
    Variant("square", square=True),
    Variant("visible", seeing=1.0),
    Variant("ten", people=10),
    Variant("some_see", seeing=0.2),
    Variant("told", told=True),
    Variant("orca", by_orca=True),
)
SEEDS = 10_000  # of a variant
DEVELOPMENT, REPORT = range(100), range(1000, 1500)
TIME_LIMIT = 24.0  # s
LIMITS = Limits(SPEED, math.pi, 8.0, 4.0 * math.pi, 8.0, 4.0 * math.pi, v_min=0.0)
ROBOT = Robot("crowdnav", LIMITS, Footprint.disc(RADIUS), Lidar(720, math.tau, 0.05, 15.0))
MAP = empty_map((-8.0, 8.0), (-8.0, 8.0), 0.1)


def missions(options: Options) -> Iterator[Mission]:
    """All seeds of all variants; of the published cases those of the first, without ``select``."""
    variants, seeds = VARIANTS, range(SEEDS)
    if options.quick:
        variants, seeds = tuple(v for v in VARIANTS if not v.by_orca), DEVELOPMENT
    elif options.select is None:
        variants, seeds = VARIANTS[:1], REPORT
    for variant in variants:
        for seed in seeds:
            yield Mission(SEEDS * VARIANTS.index(variant) + seed)


def development(options: Options) -> Iterator[Mission]:
    """The crossings on which settings may be tuned: none of the published cases."""
    del options
    for seed in DEVELOPMENT:
        yield Mission(seed)


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves out variants that say themselves what drives, for other controllers."""
    variant, _ = _case(mission)
    if options.controller != "navigator" and (variant.told or variant.by_orca):
        return f"the variant {variant.name} has a controller of its own"
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The crossing of a number; its people belong to the world."""
    del repeat
    variant, seed = _case(mission)
    return Scenario(
        name=f"crowdnav {mission.number}: {variant.name}, seed {seed}",
        grid=MAP,
        robot=ROBOT,
        start=(*ENDS[0], 0.5 * math.pi),
        goals=(Goal(*ENDS[1]),),
        noise=Noise() if options.ideal else Noise(driven.RANGE_NOISE),
        latency=0.0,
        seed=mission.number,
        goal_tolerance=RADIUS,
        time_limit=TIME_LIMIT,
        navigator={"period": STEP, "hidden_speed": 0.0},
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a crossing."""
    variant, seed = _case(mission)
    people = draw_people(variant, seed)
    asked = driven.asked(scenario(mission, options, repeat), options, repeat)
    controller = controller_named(options.controller)
    if variant.told:
        controller = partial(ToldNavigator, people=people)
    elif variant.by_orca:
        controller = Passenger
    episode = run(
        asked,
        navigator=controller,
        trace=options.observe is not None,
        make_world=partial(OrcaWorld if variant.by_orca else World, walkers=people),
    )
    row = driven.row_of_episode(episode, asked, group=variant.name)
    if options.observe is not None:
        options.observe(mission, repeat, episode, row)
    return row


def draw_people(variant: Variant, seed: int) -> OrcaPeople:
    """The people of a case, before their first step."""
    sees = np.random.default_rng(seed).random(variant.people) < variant.seeing
    return OrcaPeople(draw_walks(seed, variant.people, variant.square), sees)


def _case(mission: Mission) -> tuple[Variant, int]:
    variant, seed = divmod(mission.number, SEEDS)
    return VARIANTS[variant], seed
