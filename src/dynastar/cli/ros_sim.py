"""``dynastar ros-sim``: the simulator as a ROS 2 node."""

import argparse

from dynastar import io
from dynastar.cli.compiling import prepare
from dynastar.extras import require


def execute(arguments: argparse.Namespace) -> int:
    """Runs the node until it is interrupted."""
    scenario = io.load_scenario(arguments.scenario)
    require("ros", "ROS 2 nodes need")
    prepare()
    from dynastar.ros.main import simulate

    return simulate(scenario, arguments.ros_args)
