"""``dynastar check``: whether a robot's numbers, its map and its recordings fit, before it drives."""

import argparse
import sys
import textwrap
import warnings
from typing import TYPE_CHECKING

from dynastar import io
from dynastar.cli.arguments import add_json, add_robot, add_set
from dynastar.cli.outputs import make_folder
from dynastar.cli.parsing import path, refuse_unheard
from dynastar.cli.show import as_json
from dynastar.errors import InputError
from dynastar.extras import require
from dynastar.terminal import printable

if TYPE_CHECKING:
    from dynastar.check import Check
    from dynastar.grid import OccupancyGrid
    from dynastar.navigator import NavigatorConfig
    from dynastar.robot import Robot

DESCRIPTION = (
    "Says in sentences whether the declared numbers of a robot fit together, fit its map, this "
    "computer and a recording, and what the no-contact guarantee covers with them."
)

EXAMPLES = """\
examples:
  dynastar check --robot my_robot.toml
  dynastar check --robot my_robot.toml --map home.yaml --out out/check
  dynastar check --robot turtlebot3_burger --set latency=0.1 --no-time
  dynastar check --scenario examples/office/office.toml
  dynastar check --robot my_robot.toml --bag robot.mcap --topic scan=/front/scan

A robot's file has the tables [robot], [sensor] and [navigator] of a scenario file; a whole scenario
does, too. Exit status: 0 without a problem, 1 with one. With --out it writes report.html, pictures
and check.json into DIR."""

WIDTH = 100  # letters of a line
LEVEL_WIDTH = 9

TOPICS = ("scan", "odom", "cmd_vel", "tf", "tf_static")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_robot(parser)
    parser.add_argument(
        "--scenario",
        type=path,
        metavar="SCENARIO.toml",
        help="its robot, settings and map, where --robot and --map give no others",
    )
    parser.add_argument(
        "--map", type=path, metavar="MAP", help="the map to drive on: .yaml (ROS), .npy, .txt"
    )
    parser.add_argument(
        "--bag", type=path, metavar="BAG", help="a recording of scans and odometry by ROS 2"
    )
    parser.add_argument(
        "--topic",
        action="append",
        default=[],
        metavar="NAME=TOPIC",
        help="the recording's topic for scan, odom, cmd_vel, tf; repeatable",
    )
    parser.add_argument(
        "--no-time", action="store_true", help="do not measure how long a tick takes here"
    )
    parser.add_argument("--out", type=path, metavar="DIR", help="write a report into this folder")
    add_json(parser)
    add_set(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Checks the robot, prints the findings, and returns 1 if there is a problem."""
    from dynastar.check import check_robot
    from dynastar.cli.compiling import prepare
    from dynastar.cli.replay import topic_table
    from dynastar.ros.bag import BagReader

    robot, config, grid = _given(arguments)
    if arguments.bag is not None:
        require("bags", "recordings need")
    else:
        refuse_unheard(arguments, {"topic": []}, "goes with --bag")
    folder = None if arguments.out is None else make_folder("--out", arguments.out)
    topics = topic_table(arguments.topic, TOPICS)
    if arguments.bag is not None:  # refused before the kernels are compiled
        with warnings.catch_warnings(action="ignore"):
            BagReader(arguments.bag).close()
    if not arguments.no_time:
        prepare()
    check = check_robot(robot, config, grid, arguments.bag, topics, not arguments.no_time)
    if folder is not None:
        from dynastar.check.report import write_check

        name = arguments.scenario if arguments.robot is None else arguments.robot
        page = write_check(check, folder, f"Check of {path(str(name)).name}")
        print(f"report: {page.absolute().as_uri()}", file=sys.stderr)
    print(as_json(check.as_data()) if arguments.json else as_text(check))
    return 1 if check.level == "problem" else 0


def _given(
    arguments: argparse.Namespace,
) -> "tuple[Robot, NavigatorConfig, OccupancyGrid | None]":
    """The robot, its settings and the map that the options name."""
    from dynastar.bench.settings import parsed
    from dynastar.cli.robots import named_robot
    from dynastar.navigator.config import changed
    from dynastar.simulation.run import effective_config

    if arguments.robot is None and arguments.scenario is None:
        raise InputError("there is no robot to check: give --robot or --scenario")
    grid = None
    if arguments.scenario is not None:
        scenario = io.load_scenario(arguments.scenario)
        grid, robot, config = scenario.grid, scenario.robot, effective_config(scenario)
    if arguments.robot is not None:
        robot, config = named_robot(arguments.robot)
    if arguments.map is not None:
        grid = io.load_map(arguments.map)
    return robot, changed(config, parsed(arguments.set)), grid


def as_text(check: "Check") -> str:
    """The findings as wrapped lines, each led by its level, and their sum."""
    indent = " " * LEVEL_WIDTH
    lines = [
        textwrap.fill(
            printable(one.words()),
            WIDTH,
            initial_indent=f"{one.level:<{LEVEL_WIDTH}}",
            subsequent_indent=indent,
        )
        for one in check.findings
    ]
    levels = [one.level for one in check.findings]
    counts = (f"{levels.count(level)} {level}" for level in ("ok", "warning", "problem"))
    return "\n".join([*lines, ", ".join(counts)])
