"""Sending a goal to the navigator's node, and following its diagnostics until the robot has arrived."""

import math
import time
from collections.abc import Callable, Sequence

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node

from dynastar.errors import DynastarError
from dynastar.geometry import Goal, Pose2D
from dynastar.ros.middleware import make
from dynastar.ros.outgoing import Messages

DIAGNOSED = ": navigation"  # end of the name of the navigator's status in /diagnostics
SILENT = 5.0  # s without a word after which the node is taken to be gone
ENDED = {"arrived": 0, "blocked": 1, "idle": 1}  # exit status by the state in which a mission ends


class GoalNode(Node):  # type: ignore[misc]
    """Publishes a goal and holds what the navigator's node said last."""

    def __init__(self) -> None:
        super().__init__("dynastar_goal")
        self.said: dict[str, str] = {}  # the values of the newest status, and its message
        self.heard = -math.inf  # s, when that was
        self._goals = self.create_publisher(PoseStamped, "goal_pose", 1)
        self.create_subscription(DiagnosticArray, "/diagnostics", self._hear, 10)

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name.endswith(DIAGNOSED):
                values = {pair.key: pair.value for pair in status.values}
                self.said = {**values, "message": status.message}
                self.heard = time.monotonic()

    def spin_until(self, holds: Callable[[], bool], seconds: float) -> bool:
        """Take messages until something holds, at most for some seconds. Returns True if it does."""
        end = time.monotonic() + seconds
        while not holds() and time.monotonic() < end:
            rclpy.spin_once(self, timeout_sec=0.1)
        return holds()

    def is_heard(self) -> bool:
        """Whether a node takes goals and says what it does."""
        return bool(self._goals.get_subscription_count() and self.said)

    def counts(self) -> tuple[int, int]:
        """How many goals the node has taken and refused since its start."""
        return int(self.said.get("goals taken", 0)), int(self.said.get("goals refused", 0))

    def publish(self, goal: Goal, frame: str) -> None:
        """Publishes a goal, with an orientation of zeros where any heading will do."""
        out, now = Messages(make), 1e-9 * self.get_clock().now().nanoseconds
        pose = out.pose(Pose2D(goal.x, goal.y, goal.heading or 0.0))
        if goal.heading is None:
            pose.orientation.w = 0.0
        self._goals.publish(PoseStamped(header=out.header(frame, now), pose=pose))


def send(goal: Goal, frame: str, timeout: float, wait: bool, arguments: Sequence[str]) -> int:
    """Send a goal and print what the node says of it. Returns 0 if it arrives, else 1.

    ``timeout`` is in seconds. Without ``wait``, a goal that is accepted is enough. Raises
    DynastarError where no node takes goals within the timeout, or none answers.
    """
    rclpy.init(args=list(arguments))
    node = GoalNode()
    try:
        return _sent(node, goal, frame, timeout, wait)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def _sent(node: GoalNode, goal: Goal, frame: str, timeout: float, wait: bool) -> int:
    print("waiting for the navigator's node", flush=True)
    if not node.spin_until(node.is_heard, timeout):
        raise DynastarError(
            f"no node takes goals after {timeout:g} s: is 'dynastar ros' running, with the same "
            "ROS_DOMAIN_ID?"
        )
    taken, refused = node.counts()
    node.publish(goal, frame)
    print(f"sent ({goal.x:g}, {goal.y:g})", flush=True)
    if not node.spin_until(lambda: node.counts() != (taken, refused), timeout):
        raise DynastarError(f"the node has not answered the goal after {timeout:g} s")
    if node.counts()[0] == taken:
        print(node.said["refused"])
        return 1
    print("accepted", flush=True)
    return _followed(node, taken + 1) if wait else 0


def _followed(node: GoalNode, number: int) -> int:
    """Print the states of the node's goal with this number until it ends; its exit status."""
    shown = ""
    while True:
        if node.counts()[0] != number:
            print("replaced by another goal")
            return 1
        if node.said["message"] != shown:
            shown, state = node.said["message"], node.said["state"]
            print(shown, flush=True)
            if state in ENDED:
                return ENDED[state]
        if time.monotonic() - node.heard > SILENT:
            raise DynastarError(f"the node has been silent for {SILENT:g} s")
        rclpy.spin_once(node, timeout_sec=0.1)
