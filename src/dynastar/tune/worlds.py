"""The worlds that every setting drives: those of the suites, or built for a robot of the user's.

``random`` and ``people`` draw their worlds for a robot, so they can be drawn for any. The other suites have
robots of their own: with them only the settings are tuned.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain, islice, zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench import driven
from dynastar.bench.bound import least_time
from dynastar.bench.missions import Mission, Options, Suite, endless
from dynastar.bench.selection import REPORT_SEEDS
from dynastar.bench.suites import load_suite, people, people_scripts, random_worlds
from dynastar.bench.suites.people_sites import SITES, draw_site, heading_of
from dynastar.bench.suites.people_witness import lattice_heading
from dynastar.bench.suites.random_kinds import KINDS
from dynastar.config import choose
from dynastar.episode import Episode
from dynastar.errors import DataError, InputError
from dynastar.geometry import Goal
from dynastar.io.scenario_file import FAULTS, NOWHERE, read_scenario
from dynastar.navigator import NavigatorConfig
from dynastar.robot import Robot
from dynastar.ros.settings import flat, nested, robot_from, robot_table
from dynastar.simulation import Noise, Scenario
from dynastar.tune.space import Values, limited

MOST_LEFT_OUT = 100  # worlds in a row, after which none is expected

DRAWN = ("random", "people")  # suites whose worlds can be drawn for any robot


@dataclass(frozen=True)
class World:
    """A mission of a suite and its seed; ``suite`` is its name again, or worlds for one robot."""

    name: str
    suite: "str | RobotWorlds"
    mission: Mission
    seed: int


@dataclass(frozen=True)
class RobotWorlds:
    """The suite ``random`` or ``people`` with its worlds drawn for one robot; a ``bench`` Suite.

    ``declared`` holds the robot and the navigator's settings for it as JSON; ``values`` may limit the
    speeds of the robot that drives, in worlds that are drawn for the robot itself.
    """

    name: str
    declared: str
    values: tuple[tuple[str, float], ...] = ()

    DEFAULT_MISSIONS = None

    @staticmethod
    def of(
        name: str, robot: Robot, config: NavigatorConfig, faults: Mapping[str, Any]
    ) -> "RobotWorlds":
        """The worlds of a suite for a robot, with what is declared of it, and ``faults`` of its file.

        A robot of another name than those of the suites has worlds that fit its size.
        """
        choose(name, dict.fromkeys(DRAWN), "suite for a robot of your own")
        table = {
            "robot": robot_table(replace(robot, name=f"own {robot.name}")),
            "navigator": nested(flat(config)),
            "faults": faults,
        }
        return RobotWorlds(name, json.dumps(table))

    def limited(self, values: Values) -> "RobotWorlds":
        """The same worlds with the limits of a setting."""
        return replace(self, values=tuple(values.items()))

    def missions(self, options: Options) -> Iterator[Mission]:
        """Missions without end."""
        return endless(options)

    def leave_out(self, mission: Mission, options: Options) -> str:
        """Worlds that the rules of the suite leave out."""
        made = _drawn(self.name, self.declared, options.seed, mission.number)
        return made if isinstance(made, str) else ""

    def scenario(self, mission: Mission, options: Options, repeat: int) -> Scenario:
        """The mission of a number; raises DataError for one that is left out."""
        del repeat
        made = _drawn(self.name, self.declared, options.seed, mission.number)
        if isinstance(made, str):
            raise DataError(f"{self.name} {mission.number}: {made}")
        scenario, _ = made
        return replace(scenario, robot=limited(scenario.robot, dict(self.values)))

    def run_mission(self, mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
        """Drives a mission; a ``blocked`` that is right has the outcome ``blocked_rightly``."""
        made = self.scenario(mission, options, repeat)
        reachable = _drawn(self.name, self.declared, options.seed, mission.number)[1]

        def extra(episode: Episode) -> Mapping[str, Any]:
            return random_worlds.verdict(episode, bool(reachable))

        return driven.run_mission(made, options, mission, repeat, extra=extra)


@lru_cache(maxsize=1024)
def _drawn(name: str, declared: str, seed: int, number: int) -> tuple[Scenario, bool] | str:
    """A world of a suite for a robot, and whether a way exists; or why it is left out."""
    table = json.loads(declared)
    robot, navigator = robot_from(table["robot"]), table["navigator"]
    made = (_random if name == "random" else _among_people)(robot, seed, number)
    if isinstance(made, str):
        return made
    scenario, reachable = made
    faults = read_scenario({**NOWHERE, "robot": "paper", **table["faults"]}, Path(), name)
    return replace(
        scenario,
        noise=Noise(max(0.0, navigator["range_error"] - 0.5 * faults.lidar.rounding)),
        latency=navigator["latency"],
        navigator=navigator,
        **{key: getattr(faults, key) for key in FAULTS},
    ), reachable


def _random(robot: Robot, seed: int, number: int) -> tuple[Scenario, bool] | str:
    kinds = list(KINDS)
    kind = kinds[number % len(kinds)]
    world = KINDS[kind](robot, np.random.default_rng([seed, number]))
    checked = random_worlds.check(world, robot)
    if isinstance(checked, str):
        return checked
    start, length = checked
    seconds = random_worlds.PATIENCE * least_time(length, robot.limits) + random_worlds.EXTRA_TIME
    return Scenario(
        name=f"random {number}: {kind.replace('_', ' ')}, {robot.name}",
        grid=world.grid,
        robot=robot,
        start=start,
        goals=(Goal(*world.goal),),
        obstacles=world.obstacles,
        seed=number,
        goal_tolerance=random_worlds.GOAL_TOLERANCE,
        time_limit=round(seconds, 1),
    ), world.reachable


def _among_people(robot: Robot, seed: int, number: int) -> tuple[Scenario, bool] | str:
    random = np.random.default_rng([seed, number])
    kind = list(SITES)[number % len(SITES)]
    radius = robot.footprint.circumscribed
    sites = (draw_site(kind, random, radius) for _ in range(people.SITE_TRIES))
    site = next((site for site in sites if site is not None), None)
    if site is None:
        return "no place with a way for the robot"
    seconds = people.PATIENCE * least_time(site.way.length, robot.limits) + people.EXTRA_TIME
    made = people.Made(site, robot, lattice_heading(heading_of(site.way)), round(seconds, 1))
    duration = made.seconds + people.AFTERWARDS
    made = made._replace(walkers=people_scripts.draw_walkers(site, robot, random, duration))
    why = people.judged(made) if made.walkers else "nobody finds room to walk"
    if why:
        return why
    return Scenario(
        name=f"people {number}: {kind}, {robot.name}",
        grid=site.grid,
        robot=robot,
        start=(*site.start, made.heading),
        goals=(Goal(*site.goal),),
        movers=made.walkers,
        attention=people.ATTENTION,
        seed=number,
        goal_tolerance=people.GOAL_TOLERANCE,
        time_limit=made.seconds,
    ), True


def suites_of(
    names: Sequence[str], robot: Robot | None, config: NavigatorConfig, faults: Mapping[str, Any]
) -> dict[str, "str | RobotWorlds"]:
    """The suites by name; ConfigError for an unknown one, InputError for one that drives nothing."""
    found: dict[str, str | RobotWorlds] = {}
    for name in names:
        if not hasattr(load_suite(name), "scenario"):
            raise InputError(f"--suite {name}: drives nothing, so there is nothing to tune")
        drawn = robot is not None and name in DRAWN
        found[name] = RobotWorlds.of(name, robot, config, faults) if drawn and robot else name
    return found


def worlds_of(
    suites: Mapping[str, "str | RobotWorlds"],
    options: Options,
    after: int = 0,
    count: int | None = None,
) -> Iterator[World]:
    """The worlds of suites in turn that their rules keep: ``count`` of each (None: all).

    The first ``after`` of each are left out, unless the suite has no more (``seen_before``).
    """
    ways = [_some(name, suite, options, after, count) for name, suite in suites.items()]
    return (world for turn in zip_longest(*ways) for world in turn if world is not None)


def seen_before(
    suites: Mapping[str, "str | RobotWorlds"], options: Options, after: int
) -> list[str]:
    """The suites that have no more than ``after`` worlds, so that the same ones are driven again."""
    others = {name: islice(_kept(name, one, options), after, None) for name, one in suites.items()}
    return [name for name, worlds in others.items() if next(worlds, None) is None]


def _some(
    name: str, suite: "str | RobotWorlds", options: Options, after: int, count: int | None
) -> Iterator[World]:
    stop = None if count is None else after + count
    others = islice(_kept(name, suite, options), after, stop)
    first = next(others, None)
    return islice(_kept(name, suite, options), count) if first is None else chain([first], others)


def _kept(name: str, known: "str | RobotWorlds", options: Options) -> Iterator[World]:
    suite: Suite = load_suite(known) if isinstance(known, str) else known
    left_out = 0  # in a row
    missions = suite.missions
    if options.seed < REPORT_SEEDS:  # of a suite whose cases do not depend on the seed
        missions = getattr(suite, "development", missions)
    for mission in missions(options):
        reason = suite.leave_out(mission, options)
        if not reason:
            yield World(name, known, mission, options.seed)
        left_out = left_out + 1 if reason else 0
        if left_out == MOST_LEFT_OUT:
            raise InputError(f"the suite {name} leaves out {left_out} worlds in a row: {reason}")
