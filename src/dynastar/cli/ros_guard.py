"""``dynastar ros-guard``: a guard for another controller's commands, as a ROS 2 node."""

import argparse

from dynastar.cli.arguments import add_robot
from dynastar.extras import require

DESCRIPTION = (
    "Runs a guard as a ROS 2 node: it takes cmd_vel_in of any controller, scan and odom, and "
    "publishes as cmd_vel only what the robot can stop after. What follows --ros-args goes to ROS."
)

EXAMPLES = """\
examples:
  dynastar ros-guard --robot my_robot.toml        # as dynastar tune --bag writes it, and check reads it
  dynastar ros-guard --ros-args -p robot:=jackal -p latency:=0.1
  dynastar ros-guard --ros-args -p robot:=pioneer3dx -r cmd_vel_in:=/joy_vel -r cmd_vel:=/base/cmd_vel
  dynastar ros-guard --ros-args -p use_map:=true -p pose_source:=amcl    # with keep-out and speed masks"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_robot(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Runs the node until it is interrupted."""
    from dynastar.cli.compiling import prepare
    from dynastar.cli.robots import robot_arguments

    given = robot_arguments(arguments.robot, own_period=True)
    require("ros", "ROS 2 nodes need")
    prepare()
    from dynastar.ros.main import guard

    return guard([*given, *arguments.ros_args])
