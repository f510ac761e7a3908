"""Suite random: seeded static worlds, numbered from 0 without end.

The robot of number n is the (n mod 3)-th of TurtleBot3 Burger, Pioneer 3-DX and Jackal, the kind of
world the (n // 3 mod 6)-th of ``KINDS``; the rest is drawn from ``[seed, n]``:

- ``clutter``: boxes, polygons and cylinders at a random density, of which the map has some or none;
- ``narrow_ways``: doorways and corridors barely wider than the robot, as mapped or narrowed by boards;
- ``dead_end``: the robot stands nose first in a narrow pocket, or one opens on its way;
- ``u_trap``: unmapped U-shaped walls on the way that open towards the robot;
- ``blocked_way``: an unmapped board closes the door on the shorter way, another door is open;
- ``unreachable``: the goal is in an enclosure that boards close, or behind a wall whose doors all are
  closed. The right end is ``blocked``, and the row's outcome is then ``blocked_rightly``.

A narrow way is as wide as the footprint that drives straight (twice the inscribed radius) plus twice
the declared errors of ranges and position (1 cm each) plus 0.10 to 0.30 m; where the map has it, rounded
up to whole cells of 5 cm. So 7 cm or more are left on each side, and a planner that keeps the errors
and half a diagonal of such a cell on each side needs 5.5 cm.

Whether a way exists is not taken from the kind but checked in the true world (see ``random_truth``):
a way that keeps those 5.5 cm has to exist, or in ``unreachable`` none even for a disc 3 cm smaller than
the inscribed one. All other numbers are left out. So no mission is decided by a few centimetres.

The time limit is 4 times the least time, of the shortest way in the true world (in the map, where none
exists) at full speed, plus 60 s.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench import driven
from dynastar.bench.bound import least_time
from dynastar.bench.missions import Mission, Options, endless
from dynastar.bench.suites.random_kinds import KINDS
from dynastar.bench.suites.random_layout import StaticWorld
from dynastar.bench.suites.random_truth import TrueSpace
from dynastar.episode import Episode
from dynastar.errors import DataError, PlanningError
from dynastar.geometry import Goal, Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.planning import plan
from dynastar.robot import ROBOTS, Robot
from dynastar.simulation import Scenario
from dynastar.simulation.contact import Solids

DEFAULT_MISSIONS = 1000
QUICK_MISSIONS = 24

COMPARABLE = "The worlds are this suite's own: no published figure is comparable."

ROBOT_NAMES = ("turtlebot3_burger", "pioneer3dx", "jackal")
GOAL_TOLERANCE = 0.25  # m
PATIENCE, EXTRA_TIME = 4.0, 60.0  # times the least time, s
START_ROOM = 0.05  # m round the robot at the start
REACH_ROOM = 0.1  # m beyond the tolerance, out of reach of any robot where the goal is


class Made(NamedTuple):
    """A world that the rules keep, the robot in it, the start's heading and the way's length."""

    world: StaticWorld
    robot: Robot
    kind: str
    start: tuple[float, float, float]
    length: float


missions = endless


def leave_out(mission: Mission, options: Options) -> str:
    """Worlds in which it is not certain that a way exists, or that none does."""
    made = make(options.seed, mission.number)
    return made if isinstance(made, str) else ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission of a number; raises DataError for one that ``leave_out`` leaves out."""
    del repeat
    made = made_of(mission, options)
    return driven.realistic(
        Scenario(
            name=f"random {mission.number}: {made.kind.replace('_', ' ')}, {made.robot.name}",
            grid=made.world.grid,
            robot=made.robot,
            start=made.start,
            goals=(Goal(*made.world.goal),),
            obstacles=made.world.obstacles,
            seed=mission.number,
            goal_tolerance=GOAL_TOLERANCE,
            time_limit=round(PATIENCE * least_time(made.length, made.robot.limits) + EXTRA_TIME, 1),
        ),
        options,
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission; a ``blocked`` that is right has the outcome ``blocked_rightly``."""
    driven_scenario = scenario(mission, options, repeat)
    made = made_of(mission, options)
    reachable = made.world.reachable

    def extra(episode: Episode) -> Mapping[str, Any]:
        return verdict(episode, reachable)

    return driven.run_mission(
        driven_scenario, options, mission, repeat, group=made.kind, extra=extra
    )


def made_of(mission: Mission, options: Options) -> Made:
    """What a mission is made of; raises DataError for one that ``leave_out`` leaves out."""
    made = make(options.seed, mission.number)
    if isinstance(made, str):
        raise DataError(f"random {mission.number}: {made}")
    return made


def verdict(episode: Episode, reachable: bool) -> dict[str, Any]:
    """Row keys ``reachable`` and, where the robot rightly says that there is no way, the outcome.

    A robot that says "arrived" elsewhere ends as ``blocked``, too: it has not said so rightly.
    """
    said = len(episode.states) and str(episode.states[-1]) == "blocked"
    if not reachable and episode.outcome == "blocked" and said:
        return {"reachable": reachable, "outcome": "blocked_rightly"}
    return {"reachable": reachable}


def drawn(seed: int, number: int) -> tuple[StaticWorld, Robot, str]:
    """The world of a number as its kind draws it, unchecked, with its robot and its kind."""
    robot = ROBOTS[ROBOT_NAMES[number % len(ROBOT_NAMES)]]
    kind = list(KINDS)[number // len(ROBOT_NAMES) % len(KINDS)]
    return KINDS[kind](robot, np.random.default_rng([seed, number])), robot, kind


@lru_cache(maxsize=8)
def make(seed: int, number: int) -> Made | str:
    """The world of a number, or why the rules leave it out."""
    world, robot, kind = drawn(seed, number)
    checked = check(world, robot)
    return checked if isinstance(checked, str) else Made(world, robot, kind, *checked)


def check(world: StaticWorld, robot: Robot) -> tuple[tuple[float, float, float], float] | str:
    """The start's pose and the way's length, or why the rules leave the world out."""
    x, y, heading = world.start
    footprint, goal, space = robot.footprint, world.goal, TrueSpace(world)
    way = _way(world, robot, space)
    if way is None:
        return "no way on the map" if not world.reachable else "no way"
    length, bearing = way
    start = (x, y, bearing if heading is None else heading)
    solids = Solids(world.grid, world.obstacles)
    if solids.gap(Pose2D(*start), footprint) < START_ROOM:
        return "the robot does not fit at its start"
    if world.reachable:
        certain = space.careful(footprint, start, goal)
        return (start, length) if certain else "no way with room for a careful robot"
    reach = GOAL_TOLERANCE + REACH_ROOM
    if space.possible(footprint, (x, y), goal, reach):
        return "the goal may be reached"
    return start, length


def _way(world: StaticWorld, robot: Robot, space: TrueSpace) -> tuple[float, float] | None:
    """Length (m) and first bearing (rad) of the shortest way; None without one.

    Of the length the true world decides, of the bearing the map, for that is what the robot knows. If
    no way should exist, the map decides both.
    """
    ends = (world.start[0], world.start[1]), world.goal
    radius = robot.footprint.inscribed
    true = OccupancyGrid(space.gaps <= 0.0, GridFrame(space.cell))
    try:
        known = plan(world.grid, *ends, "auto", radius).path
        length = plan(true, *ends, "auto", radius).path.length if world.reachable else known.length
    except PlanningError:
        return None
    onward = known.points[known.arc > 1e-6]
    towards = onward[0] if len(onward) else np.asarray(world.goal)
    return length, math.atan2(towards[1] - ends[0][1], towards[0] - ends[0][0])
