"""``dynastar ros``: the navigator as a ROS 2 node."""

import argparse

from dynastar import io
from dynastar.cli.compiling import prepare
from dynastar.extras import require


def execute(arguments: argparse.Namespace) -> int:
    """Runs the node until it is interrupted."""
    scenario = None if arguments.scenario is None else io.load_scenario(arguments.scenario)
    require("ros", "ROS 2 nodes need")
    prepare()
    from dynastar.ros.main import navigate, parameters_of

    given = [] if scenario is None else parameters_of(scenario)
    return navigate([*given, *arguments.ros_args])
