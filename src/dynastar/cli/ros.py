"""``dynastar ros``: the navigator as a ROS 2 node."""

import argparse

from dynastar import io
from dynastar.cli.arguments import add_robot
from dynastar.cli.parsing import path
from dynastar.extras import require

DESCRIPTION = (
    "Runs the navigator as a ROS 2 node: it takes map, scan, odom and goal_pose and "
    "publishes cmd_vel. What follows --ros-args goes to ROS."
)

EXAMPLES = """\
examples:
  dynastar ros-sim                                              # the office; or a scenario file
  dynastar ros --scenario office
  dynastar ros --robot my_robot.toml                            # as dynastar check reads it
  dynastar ros-goal 7.2 10
  dynastar ros --scenario office --ros-args -p bag:=out/bag     # records, see dynastar replay
  dynastar ros --ros-args -p robot:=jackal -p pose_source:=amcl -r cmd_vel:=/base/cmd_vel"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    given = parser.add_mutually_exclusive_group()
    add_robot(given)
    given.add_argument(
        "--scenario",
        type=path,
        metavar="SCENARIO",
        help="take robot and errors from this scenario: a file, or an example's name",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Runs the node until it is interrupted."""
    from dynastar.cli.compiling import prepare
    from dynastar.cli.robots import robot_arguments

    robot = robot_arguments(arguments.robot)
    scenario = None if arguments.scenario is None else io.load_scenario(arguments.scenario)
    require("ros", "ROS 2 nodes need")
    prepare()
    from dynastar.ros.main import navigate
    from dynastar.ros.settings import parameters_of

    given = robot if scenario is None else parameters_of(scenario)
    return navigate([*given, *arguments.ros_args])
