"""Suite navground: one robot among navground's agents (extra ``navground``) in its scenarios.

Mission n has the (n mod 3)-th of ``SCENARIOS``, agents with the (n // 3 mod 4)-th of ``BEHAVIORS``, and
navground's seed ``1000 * seed + n // 12``. The robot is a disc of 0.25 m that drives at 1 m/s and is one
of the scenario's agents. The others are as large and as fast, move in any direction, and are told where
everybody is and how fast. The robot has navground's lidar alone, and knows the corridor's walls.

navground steps at 0.1 s, moves by explicit Euler steps and executes commands at once. Its own record of
collisions decides on contacts. A mission ends at the scenario's first target; the corridor has none, and
there it ends 10 m ahead. ``beside`` of a row has the same world with each of navground's behaviors in the
robot's place: on the same wheels, without limits of acceleration, told all that the other agents are told.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from navground import sim

from dynastar.adapters.navground import robot_of
from dynastar.bench import driven
from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Mission, Options, endless
from dynastar.bench.suites.navground_world import NavgroundWorld, Watched, drive_agent
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.robot import Lidar
from dynastar.simulation import Scenario, run

DEFAULT_MISSIONS = 48
QUICK_MISSIONS = 12

COMPARABLE = "The settings are this suite's own: no published figure is comparable."


@dataclass(frozen=True)
class Place:
    """A scenario's settings in navground, the number of other agents, and the tolerance (m)."""

    settings: str
    others: int
    tolerance: float


SCENARIOS = {
    "Cross": Place("side: 10\ntolerance: 0.5", 11, 0.5),
    "Corridor": Place("width: 4\nlength: 14", 9, 1.0),
    "Antipodal": Place("radius: 5\ntolerance: 0.5\nposition_noise: 0.3", 11, 0.5),
}
BEHAVIORS = ("HL", "ORCA", "HRVO", "SocialForce")
ROBOT = "radius: 0.25, kinematics: {type: 2WDiff, max_speed: 1.4, wheel_axis: 0.5, max_backward_speed: 0.3}"
OTHER = "radius: 0.25, kinematics: {type: Omni, max_speed: 1.2}"
TOLD = "{type: Bounded, range: 8.0, update_static_obstacles: true}"
STEP, TIME_LIMIT = 0.1, 60.0  # s
RUN = 10.0  # m that a robot drives in the corridor
RANGE, DEVIATION = 8.0, 0.01  # m, of the lidar
ACCEL, OMEGA_ACCEL = 1.0, 3.0  # m/s2 and rad/s2 of the robot
BORDER, RESOLUTION = 8.0, 0.05  # m, of the map

missions = endless


def names_of(mission: Mission) -> tuple[str, str]:
    """The scenario of a mission and the behavior of its agents."""
    others, place = divmod(mission.number, len(SCENARIOS))
    return list(SCENARIOS)[place], BEHAVIORS[others % len(BEHAVIORS)]


def leave_out(mission: Mission, options: Options) -> str:
    """Nothing is left out."""
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission as dynastar has it: other agents aside, which navground moves."""
    del repeat
    return _scenario(mission, options, make_world(mission, options))


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission in navground, and the same with navground's behaviors."""
    watched = Watched(make_world(mission, options), STEP)
    asked = driven.asked(_scenario(mission, options, watched.world), options, repeat)
    episode = run(
        asked,
        navigator=controller_named(options.controller),
        trace=options.observe is not None,
        make_world=partial(NavgroundWorld, watched=watched),
    )
    name, others = names_of(mission)
    row = driven.row_of_episode(episode, asked, group=name)
    beside = {
        behavior: drive_agent(Watched(make_world(mission, options, behavior), STEP), asked)
        for behavior in BEHAVIORS
    }
    row |= {"others": others, **watched.facts(), "beside": beside}
    if options.observe is not None:
        options.observe(mission, repeat, episode, row)
    return row


def _scenario(mission: Mission, options: Options, world: Any) -> Scenario:
    agent, (name, others) = world.agents[0], names_of(mission)
    goal, (x, y) = goal_of(agent), agent.position.tolist()
    lidar = Lidar(360, math.tau, 0.0, RANGE)
    return Scenario(
        name=f"navground {mission.number}: {name}, {others}",
        grid=map_of(world, (x, y), goal),
        robot=robot_of(agent.behavior, lidar, ACCEL, OMEGA_ACCEL),
        start=(x, y, agent.orientation),
        goals=(goal,),
        seed=mission.number,
        goal_tolerance=SCENARIOS[name].tolerance,
        time_limit=TIME_LIMIT,
        navigator={"period": STEP, "range_error": 0.01 if options.ideal else 3.0 * DEVIATION},
    )


def goal_of(agent: Any) -> Goal:
    """An agent's first target; in the corridor, in its middle."""
    if hasattr(agent.task, "waypoints"):
        return Goal(*agent.task.waypoints[0].tolist())
    (x, _), (towards, _) = agent.position.tolist(), agent.task.direction.tolist()
    return Goal(x + towards * (RUN + SCENARIOS["Corridor"].tolerance), 2.0)


def map_of(world: Any, start: tuple[float, float], goal: Goal) -> OccupancyGrid:
    """The walls of the corridor, round start and goal, or nothing."""
    heights = [float(wall.line.p1[1]) for wall in world.walls]
    ends = np.array([start, goal[:2], *((start[0], y) for y in heights)])
    low, high = ends.min(axis=0) - BORDER, ends.max(axis=0) + BORDER
    occupied = np.zeros(np.ceil((high - low) / RESOLUTION).astype(int)[::-1], dtype=bool)
    for y in heights:  # a cell beside the way, not on it
        occupied[int((y - low[1]) / RESOLUTION) - (y <= goal.y)] = True
    return OccupancyGrid.from_occupied(occupied, RESOLUTION, *low.tolist())


def make_world(mission: Mission, options: Options, behavior: str = "") -> Any:
    """The navground world of a mission; without a behavior, the robot takes commands."""
    name, others = names_of(mission)
    place, error = SCENARIOS[name], 0.0 if options.ideal else DEVIATION
    lidar = f"{{type: Lidar, range: {RANGE}, resolution: 361, error_std_dev: {error}}}"
    groups = [
        _group(1, ROBOT, behavior or "Told", TOLD if behavior else lidar),
        _group(place.others, OTHER, others, TOLD),
    ]
    loaded = sim.Scenario.load(f"type: {name}\n{place.settings}\ngroups: [{', '.join(groups)}]")
    seed = 1000 * options.seed + mission.number // (len(SCENARIOS) * len(BEHAVIORS))
    return loaded.make_world(seed=seed)


def _group(number: int, body: str, behavior: str, senses: str) -> str:
    """Agents as navground's YAML has them."""
    acting = f"behavior: {{type: {behavior}, optimal_speed: 1.0, safety_margin: 0.05}}"
    return f"{{type: agents, number: {number}, {body}, {acting}, state_estimation: {senses}}}"
