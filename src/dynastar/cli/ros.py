"""``dynastar ros``: the navigator as a ROS 2 node."""

import argparse

from dynastar import io
from dynastar.cli.parsing import path
from dynastar.extras import require

DESCRIPTION = (
    "Runs the navigator as a ROS 2 node: it takes map, scan, odom and goal_pose and "
    "publishes cmd_vel. What follows --ros-args goes to ROS."
)

EXAMPLES = """\
examples:
  dynastar ros-sim examples/office/office.toml
  dynastar ros --scenario examples/office/office.toml
  dynastar ros --scenario office.toml --ros-args -p bag:=out/bag     # records, see dynastar replay
  dynastar ros --ros-args -p robot:=jackal -p pose_source:=amcl -r cmd_vel:=/base/cmd_vel
  ros2 topic pub --once /goal_pose geometry_msgs/msg/PoseStamped \\
      '{header: {frame_id: map}, pose: {position: {x: 7.2, y: 10.0}, orientation: {w: 1.0}}}'"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "--scenario",
        type=path,
        metavar="FILE",
        help="take robot and errors from this scenario file",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Runs the node until it is interrupted."""
    from dynastar.cli.compiling import prepare

    scenario = None if arguments.scenario is None else io.load_scenario(arguments.scenario)
    require("ros", "ROS 2 nodes need")
    prepare()
    from dynastar.ros.main import navigate, parameters_of

    given = [] if scenario is None else parameters_of(scenario)
    return navigate([*given, *arguments.ros_args])
