"""Suite people: seeded worlds with one to ten people in them, numbered from 0 without end.

Number n has ``[seed, n]`` as its seed. Every fourth number (n mod 4 = 3, ``--select 3::4``) is
``reactive``: JuPedSim moves the people, and the robot is one of those whom they avoid; this needs the
extra ``pedestrians``, and without it these numbers are left out. All others are ``indifferent``: people
follow scripts and notice the robot late, if at all: they stop in front of a robot that rests or moves
away, and go round it (``simulation.attention``). With ``--attention none`` they walk on, whatever is
there. The row's ``group`` says which.

The place is the (n // 4 mod 5)-th of corridor, hall, crossing, doorway and office (``people_sites``); the
robot the (n mod 3)-th of Pioneer 3-DX, a Jackal at 1.2 m/s and a TurtleBot3 Burger at 0.5 m/s. The map is
known. People have radii of 0.2 to 0.5 m (reactive: 0.3 m) and walk at 0.3 to 1.6 m/s: oncoming,
overtaking, ahead, across, from behind a corner, alone or in pairs, on curved ways, some of them with
pauses, sudden reversals or changes of speed (``people_scripts``).

Nobody walks such that no robot with these limits could avoid it. That is checked, not assumed: each
indifferent world has a witness, a motion within the robot's limits that reaches the goal in time and
that nobody touches, driving or resting; it does not drive where somebody still out of sight could reach
it before it stops (``people_witness``). Nobody comes near the robot at its start in the first 3 s. In a
reactive world a robot that only stops for people ahead gets through, and one that stands is not touched
(``people_crowd``). Numbers for which this does not hold are left out, with the reason.

The time limit is 3 times the least time, of the robot's way at full speed, plus 60 s.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench import driven
from dynastar.bench.bound import least_time
from dynastar.bench.missions import Mission, Options, endless
from dynastar.bench.robots import CROWD_ROBOT, MAPS_ROBOT
from dynastar.bench.suites import people_crowd, people_scripts
from dynastar.bench.suites.people_sites import SITES, Site, draw_site, heading_of
from dynastar.bench.suites.people_witness import find_witness, lattice_heading
from dynastar.errors import DataError
from dynastar.extras import how_to_install
from dynastar.geometry import Goal
from dynastar.robot import ROBOTS, Robot
from dynastar.simulation import Mover, Pedestrian, Scenario
from dynastar.simulation.crowd import jupedsim_installed
from dynastar.simulation.scenario import Attention

DEFAULT_MISSIONS = 400
QUICK_MISSIONS = 24
ATTENTION: Attention = "late"

COMPARABLE = "The worlds are this suite's own: no published figure is comparable."

SUITE_ROBOTS = (ROBOTS["pioneer3dx"], CROWD_ROBOT, MAPS_ROBOT)
REACTIVE = 3  # of each four numbers
GOAL_TOLERANCE = 0.25  # m
PATIENCE, EXTRA_TIME = 3.0, 60.0  # times the least time, s
AFTERWARDS = 10.0  # s that scripts go on after the time limit
SITE_TRIES = 10


class Made(NamedTuple):
    """A drawn world: ``heading`` (rad) is the start's, ``seconds`` the time limit."""

    site: Site
    robot: Robot
    heading: float
    seconds: float
    walkers: tuple[Mover, ...] = ()
    crowd: tuple[Pedestrian, ...] = ()


missions = endless


def mode(number: int) -> str:
    """Whether the people of a number react: "reactive" or "indifferent"."""
    return "reactive" if number % 4 == REACTIVE else "indifferent"


def leave_out(mission: Mission, options: Options) -> str:
    """Worlds without a witness; reactive ones without JuPedSim."""
    if mode(mission.number) == "reactive" and not jupedsim_installed():
        return f"pedestrians who react need JuPedSim: {how_to_install('pedestrians')}"
    return judge(options.seed, mission.number)


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission of a number; raises DataError for one that could not be drawn."""
    del repeat
    made = make(options.seed, mission.number)
    if isinstance(made, str):
        raise DataError(f"people {mission.number}: {made}")
    kind = f"{made.site.kind}, {mode(mission.number)}"
    return driven.realistic(
        Scenario(
            name=f"people {mission.number}: {kind}, {made.robot.name}",
            grid=made.site.grid,
            robot=made.robot,
            start=(*made.site.start, made.heading),
            goals=(Goal(*made.site.goal),),
            movers=made.walkers,
            attention=ATTENTION,
            crowd=made.crowd,
            seed=mission.number,
            goal_tolerance=GOAL_TOLERANCE,
            time_limit=made.seconds,
        ),
        options,
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission."""
    made = scenario(mission, options, repeat)
    return driven.run_mission(made, options, mission, repeat, group=mode(mission.number))


@lru_cache(maxsize=8)
def make(seed: int, number: int) -> Made | str:
    """The world of a number as drawn, unjudged, or why nothing can be drawn."""
    random = np.random.default_rng([seed, number])
    kind = list(SITES)[number // 4 % len(SITES)]
    robot = SUITE_ROBOTS[number % len(SUITE_ROBOTS)]
    sites = (draw_site(kind, random, robot.footprint.circumscribed) for _ in range(SITE_TRIES))
    site = next((site for site in sites if site is not None), None)
    if site is None:
        return "no place with a way for the robot"
    heading = lattice_heading(heading_of(site.way))
    seconds = round(PATIENCE * least_time(site.way.length, robot.limits) + EXTRA_TIME, 1)
    made = Made(site, robot, heading, seconds)
    if mode(number) == "reactive":
        made = made._replace(crowd=people_crowd.draw_pedestrians(site, robot, random))
    else:
        duration = seconds + AFTERWARDS
        made = made._replace(walkers=people_scripts.draw_walkers(site, robot, random, duration))
    return made if made.walkers or made.crowd else "nobody finds room to walk"


@lru_cache(maxsize=4096)
def judge(seed: int, number: int) -> str:
    """Why the rules leave out the world of a number, or "" if they keep it."""
    made = make(seed, number)
    return made if isinstance(made, str) else judged(made, seed + number)


def judged(made: Made, seed: int = 0) -> str:
    """Why the rules leave out a world, or "" if they keep it."""
    site, robot = made.site, made.robot
    if made.crowd:
        if not people_crowd.stands(site, robot, made.crowd, made.heading, seed):
            return "pedestrians walk into a robot that stands at its start"
        if not people_crowd.gets_through(site, robot, made.crowd, seed, made.seconds):
            return "no witness: a robot that stops for pedestrians ahead does not get through"
        return ""
    ends = (site.start, site.goal)
    if find_witness(site.grid, robot, made.walkers, ends, made.heading, made.seconds) is None:
        return "no witness: no motion is found that nobody touches"
    return ""
