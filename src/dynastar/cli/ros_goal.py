"""``dynastar ros-goal``: a goal for the navigator's node, without the command ``ros2``."""

import argparse

from dynastar.cli.parsing import number
from dynastar.cli.ros import EXAMPLES
from dynastar.extras import require

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "execute"]

DESCRIPTION = (
    "Publishes a goal on goal_pose once the navigator's node takes goals, and says what happens "
    "until the robot has arrived. Exit status 0 only for an arrival. What follows --ros-args goes to ROS."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("x", metavar="X", type=number, help="m")
    parser.add_argument("y", metavar="Y", type=number, help="m")
    parser.add_argument(
        "heading", metavar="HEADING", type=number, nargs="?", help="rad (default: any heading)"
    )
    parser.add_argument("--frame", default="map", metavar="NAME", help="of the goal (default map)")
    parser.add_argument(
        "--timeout",
        type=number,
        default=10.0,
        metavar="S",
        help="seconds to wait for the node (default 10)",
    )
    parser.add_argument(
        "--no-wait", action="store_true", help="end when the goal is accepted, exit status 0"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Sends the goal and prints what the node says."""
    require("ros", "ROS 2 nodes need")
    from dynastar.geometry import Goal
    from dynastar.ros.goal import send

    goal = Goal(arguments.x, arguments.y, arguments.heading)
    options = arguments.frame, arguments.timeout, not arguments.no_wait
    return send(goal, *options, arguments.ros_args)
