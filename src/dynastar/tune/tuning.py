"""``tune``: a search from its options to its results."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from dynastar.bench.missions import Options
from dynastar.bench.runner import Job, run_job
from dynastar.bench.selection import REPORT_SEEDS
from dynastar.bench.versions import code_version
from dynastar.bench.workers import Workers, spread
from dynastar.config import shown
from dynastar.errors import InputError
from dynastar.navigator import NavigatorConfig
from dynastar.robot import Robot
from dynastar.ros.settings import flat
from dynastar.tune.objective import MOST_WORLDS
from dynastar.tune.results import write_results
from dynastar.tune.robot_file import declared_table
from dynastar.tune.search import Plan, Say, Search
from dynastar.tune.space import SPACE, Values, of_robot, settings_table, start_values, widened
from dynastar.tune.state import Row, alone_in, kept, load_state
from dynastar.tune.verdict import Verdict, judged
from dynastar.tune.worlds import RobotWorlds, World, seen_before, suites_of, worlds_of

FINAL = 4  # times the worlds of the search, at most, for the final comparison
BATCHES = 4  # of worlds at the least, after each of which a setting may be stopped
FEWEST = 4  # worlds of a batch, if that many are asked for


@dataclass(frozen=True)
class Task:
    """What is tuned: the suites, ``worlds`` of each, and the user's robot with its declared settings.

    ``faults`` has the tables [drive], [odometry], [lidar] and [loop] of its file.
    """

    suites: tuple[str, ...] = ("random", "people")
    worlds: int = 20
    robot: Robot | None = None
    config: NavigatorConfig = NavigatorConfig()
    data: Path | None = None
    seed: int = 0
    faults: Mapping[str, Any] = field(default_factory=dict)


def tune(task: Task, plan: Plan, folder: Path, workers: Workers = 1, say: Say = print) -> Verdict:
    """Searches better settings for a task, and writes state, tuned.toml and report.html to ``folder``.

    A search that was stopped goes on where it ended. Raises InputError for a folder with another search,
    or in which one is running, and MissingPackage without Optuna.
    """
    if not 0 <= task.seed < REPORT_SEEDS:
        raise InputError(f"the seed is {task.seed}: the search takes those below {REPORT_SEEDS}")
    if task.worlds * len(task.suites) > MOST_WORLDS:
        raise InputError(f"the search takes at most {MOST_WORLDS} worlds: fewer --worlds or suites")
    suites = suites_of(task.suites, task.robot, task.config, task.faults)
    space = SPACE
    drawn = any(isinstance(suite, RobotWorlds) for suite in suites.values())
    if task.robot is not None and drawn:  # the other suites have robots of their own
        space += of_robot(task.robot.limits)
    begin = start_values(space, task.config)
    space = widened(space, begin)
    with alone_in(folder):
        state = load_state(folder, _asked(task, suites))
        options = Options(seed=task.seed, data=task.data)
        worlds = list(worlds_of(suites, options, count=task.worlds))
        if not worlds:
            raise InputError("the suites have no world to drive")
        say(f"{len(worlds)} worlds of {', '.join(suites)}, {len(space)} parameters")
        plan = replace(plan, batch=min(plan.batch, max(FEWEST, len(worlds) // BATCHES)))
        drive = partial(driven, options, workers)
        search = Search(state, folder, begin, plan, drive, say)
        search.run(space, worlds)
        final = options._replace(seed=REPORT_SEEDS + task.seed)
        search.judge(worlds_of(suites, final, after=task.worlds), FINAL * len(worlds))
        again = seen_before(suites, final, task.worlds) if state.report_tuned else []
        found = judged(state, again)
        declared = declared_table(task.robot, task.config, task.faults)
        write_results(folder, state, space, found, declared)
        return found


def driven(
    options: Options, workers: Workers, worlds: Sequence[World], values: Values
) -> list[Row]:
    """The rows of a setting in worlds of one seed, in their order."""
    options = options._replace(settings=settings_table(values), seed=worlds[0].seed)
    jobs = []
    for world in worlds:
        suite = world.suite
        if isinstance(suite, RobotWorlds):
            suite = suite.limited({k: v for k, v in values.items() if k.startswith("limits.")})
        jobs.append(Job(suite, world.mission, 0, options.controller))
    rows = spread(partial(run_job, options), jobs, workers)
    return [kept(row, world.name) for world, row in zip(worlds, rows, strict=True)]


def _asked(task: Task, suites: dict[str, "str | RobotWorlds"]) -> dict[str, object]:
    """What a search depends on, by the names of the options."""
    robots = "".join(one.declared for one in suites.values() if isinstance(one, RobotWorlds))
    declared = json.dumps(flat(task.config))
    return {
        "suite": list(task.suites),
        "worlds": task.worlds,
        "robot": hashlib.sha256(f"{robots}{declared}".encode()).hexdigest()[:16],
        "seed": task.seed,
        "data": shown(str(task.data)),
        "version of dynastar": code_version(),
    }
