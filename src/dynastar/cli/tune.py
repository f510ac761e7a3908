"""``dynastar tune``: better settings for a robot, or the robot itself from a recording."""

import argparse
import os
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from dynastar import io
from dynastar.cli.arguments import add_robot
from dynastar.cli.outputs import check_file, make_folder, refuse_dash
from dynastar.cli.parsing import count, number, path, refuse_unheard, seed
from dynastar.errors import InputError, ScenarioError
from dynastar.extras import require
from dynastar.writing import written_aside

DESCRIPTION = (
    "Searches better settings for a robot by driving simulated missions, and says whether they "
    "are better than the default. With --bag: measures the robot from a recording."
)

EXAMPLES = """\
examples:
  dynastar tune --hours 0.5
  dynastar tune --robot my_robot.toml --hours 2 --out out/tune
  dynastar tune --suite random,people,barn --data data --dask tcp://host:8786
  dynastar tune --bag drive.mcap --robot my_robot.toml --out measured.toml

Every setting drives the same worlds; poor ones are stopped early. The best one is compared with the
default in other worlds, of report seeds (of a suite that has no more, in the same ones with other
noise). Writes tuned.toml, report.html and state.json into PATH. A search that was stopped resumes when
the command is given again. The robot's file has the keys of a scenario: [robot], [sensor], [navigator].
`random` and `people` are drawn for it, other suites have robots of their own. The bounds of the
no-contact guarantee are never changed.

--bag reads scans, odometry and commands of a drive, and writes latency, gains, accelerations, dead band,
range noise and the robot's own parts in view, each with its evidence, into the new file PATH."""

FEWEST_HOURS = 0.001
TOPICS = ("scan", "odom", "cmd_vel")
SEARCHING: dict[str, Any] = {  # options of a search, with their defaults
    "suite": "random,people",
    "data": None,
    "hours": 2.0,
    "settings": None,
    "worlds": 20,
    "seed": 0,
    "workers": None,
    "dask": None,
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_robot(parser)
    parser.add_argument(
        "--suite", default=SEARCHING["suite"], metavar="NAMES", help="default random,people"
    )
    parser.add_argument(
        "--data", type=path, metavar="DIR", help="of the suites (default $DYNASTAR_DATA)"
    )
    parser.add_argument(
        "--hours",
        type=number,
        default=SEARCHING["hours"],
        metavar="H",
        help="time of driving, in all (default 2)",
    )
    parser.add_argument(
        "--settings",
        type=count,
        metavar="N",
        help="stop the search after N settings besides the default",
    )
    parser.add_argument(
        "--worlds",
        type=count,
        default=SEARCHING["worlds"],
        metavar="N",
        help="of each suite (default 20)",
    )
    parser.add_argument(
        "--seed", type=seed, default=SEARCHING["seed"], metavar="N", help="default 0, below 10000"
    )
    parser.add_argument("--workers", type=count, metavar="N", help="processes (default: all cores)")
    parser.add_argument("--dask", metavar="ADDRESS", help="run on this Dask cluster instead")
    parser.add_argument(
        "--bag",
        type=path,
        metavar="BAG",
        help="measure the robot from this recording instead; --robot then tells the footprint",
    )
    parser.add_argument(
        "--topic",
        action="append",
        default=[],
        metavar="NAME=TOPIC",
        help="of --bag: the recording's topic for scan, odom or cmd_vel; repeatable",
    )
    parser.add_argument(
        "--out", type=path, metavar="PATH", help="default out/tune, with --bag robot.toml"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Searches settings, or measures a robot."""
    if arguments.bag is not None:
        return _measure(arguments)
    return _search(arguments)


def _measure(arguments: argparse.Namespace) -> int:
    require("bags", "recordings need")
    from dynastar.cli.replay import topic_table
    from dynastar.cli.robots import named_robot
    from dynastar.navigator import NavigatorConfig
    from dynastar.navigator.config import changes
    from dynastar.tune.measured import measured, robot_toml
    from dynastar.tune.recording import read_drive

    refuse_unheard(arguments, SEARCHING, "goes with a search, not with --bag")
    refuse_dash("--out", arguments.out)
    file = check_file("--out", arguments.out or Path("robot.toml"))
    assert file is not None
    if file.exists():  # perhaps written by hand
        raise InputError(f"--out {file}: is there already; name a new file")
    robot, told = None, {}
    if arguments.robot is not None:
        robot, config = named_robot(arguments.robot)
        told = changes(NavigatorConfig(), config)
    found = measured(read_drive(arguments.bag, topic_table(arguments.topic, TOPICS)), robot)
    print(found.words())
    with written_aside(file) as aside:
        aside.write_text(robot_toml(found, Path(arguments.bag).name, told), encoding="utf-8")
        try:
            io.load_robot(aside)
        except ScenarioError as error:
            why = str(error).removeprefix(f"{aside}: ")
            raise InputError(f"{file} is not written, it would not be valid: {why}") from None
    print(f"the robot is written to {file}", file=sys.stderr)
    return 0


def _search(arguments: argparse.Namespace) -> int:
    require("tune", "tuning needs")
    from dynastar.bench.remote import jobs_at_once
    from dynastar.bench.workers import pool
    from dynastar.cli.compiling import prepare
    from dynastar.cli.robots import named_faults, named_robot
    from dynastar.navigator import NavigatorConfig
    from dynastar.tune.search import Plan
    from dynastar.tune.tuning import Task, tune

    refuse_unheard(arguments, {"topic": []}, "goes with --bag")
    if not arguments.hours >= FEWEST_HOURS:
        raise InputError(f"--hours {arguments.hours:g}: expected {FEWEST_HOURS:g} or more")
    robot, config, faults = None, NavigatorConfig(), {}
    if arguments.robot is not None:
        robot, config = named_robot(arguments.robot)
        faults = named_faults(arguments.robot)
    names = tuple(dict.fromkeys(arguments.suite.split(",")))
    task = Task(names, arguments.worlds, robot, config, arguments.data, arguments.seed, faults)
    if arguments.dask is not None:
        refuse_unheard(arguments, {"workers": None}, "goes with processes here, not with --dask")
    refuse_dash("--out", arguments.out)
    folder = make_folder("--out", arguments.out or Path("out/tune"))
    processes = arguments.workers or os.cpu_count() or 1
    if arguments.dask is not None:
        processes = jobs_at_once(arguments.dask)
    at_once = max(4, 2 * processes)
    plan = Plan(3600.0 * arguments.hours, arguments.settings, at_once, arguments.seed)
    prepare()
    workers: Any = nullcontext(arguments.dask or processes)
    if arguments.dask is None and processes > 1:
        workers = pool(processes)
    with workers as opened:
        found = tune(task, plan, folder, opened, lambda line: print(line, file=sys.stderr))
    print(found.words)
    print(f"results written to {folder}", file=sys.stderr)
    return 0
