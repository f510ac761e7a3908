"""``dynastar ros-sim``: the simulator as a ROS 2 node."""

import argparse
from pathlib import Path

from dynastar import io
from dynastar.cli.parsing import path
from dynastar.cli.ros import EXAMPLES
from dynastar.extras import require

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "execute"]

DESCRIPTION = (
    "Runs a scenario as a ROS 2 node: it publishes map, scan and odom and takes cmd_vel. "
    "What follows --ros-args goes to ROS."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        type=path,
        default=Path("office"),
        help="a scenario file, or an example's name (default office)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Runs the node until it is interrupted."""
    from dynastar.cli.compiling import prepare

    scenario = io.load_scenario(arguments.scenario)
    require("ros", "ROS 2 nodes need")
    prepare()
    from dynastar.ros.main import simulate

    return simulate(scenario, arguments.ros_args)
