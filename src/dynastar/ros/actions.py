"""Nav2's actions NavigateToPose and NavigateThroughPoses, where nav2_msgs is installed."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.node import Node

from dynastar.errors import DynastarError, InputError
from dynastar.geometry import Goal
from dynastar.path import Path
from dynastar.ros.driver import Tick
from dynastar.ros.incoming import goal_of
from dynastar.ros.outgoing import Messages

FEEDBACK_EVERY = 0.5  # s
SLOWEST = 0.05  # m/s, of the mean speed by which the time that is left is estimated
OVER = {"arrived": "succeed", "blocked": "abort", "idle": "abort"}
ACTIONS = {
    "navigate_to_pose": "nav2_msgs/action/NavigateToPose",
    "navigate_through_poses": "nav2_msgs/action/NavigateThroughPoses",
}


def goals_of(request: Any, frame: str) -> list[Goal]:
    """The goals in an action's goal: one pose, or several as any ROS 2 distribution lists them."""
    if hasattr(request, "pose"):
        return [goal_of(request.pose, frame)]
    poses = request.poses
    for inner in ("goals", "poses"):  # nav_msgs/Goals, nav2_msgs/PoseStampedArray
        poses = getattr(poses, inner, poses)
    if not poses:
        raise InputError("there is no pose in the goal: expected one or more")
    return [goal_of(pose, frame) for pose in poses]


def left_of(path: Path, place: tuple[float, float]) -> float:
    """Metres of a path from the nearest of its points to its end, and from ``place`` to that point."""
    apart = np.hypot(*(path.points - place).T)
    nearest = int(np.argmin(apart))
    return float(path.length - path.arc[nearest] + apart[nearest])


class Actions:
    """Action servers: one mission at a time, which a newer goal of any kind replaces."""

    def __init__(
        self,
        node: Node,
        types: dict[str, Any],
        frame: str,
        messages: Messages,
        request: Callable[..., None],
    ) -> None:
        self._node, self._frame, self._messages = node, frame, messages
        self._request = request  # as Driver.request, which raises a DynastarError
        self._active: Any = None
        self._type: Any = None
        self._began = self._said_at = -math.inf
        self._travelled = 0.0
        self._place: tuple[float, float] | None = None
        self._servers = [
            ActionServer(
                node,
                kind,
                name,
                execute_callback=lambda handle: None,  # a mission is executed by the ticks
                goal_callback=self._judge,
                handle_accepted_callback=lambda handle, kind=kind: self._accept(handle, kind),
                cancel_callback=self._on_cancel,
            )
            for name, kind in types.items()
        ]

    def _judge(self, request: Any) -> GoalResponse:
        """Sets out for the goals, or refuses with a word in the log."""
        try:
            goals = goals_of(request, self._frame)
            self._request(goals=goals)
        except DynastarError as error:
            self._node.get_logger().warning(f"the goal is refused: {error}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _accept(self, handle: Any, kind: Any) -> None:
        self.replaced()
        self._active, self._type = handle, kind
        self._began, self._said_at = math.nan, -math.inf
        self._travelled, self._place = 0.0, None

    def _on_cancel(self, handle: Any) -> CancelResponse:
        if handle is self._active:
            self._request(cancel=True)
        return CancelResponse.ACCEPT

    def replaced(self) -> None:
        """Ends the mission under way, since another goal has come."""
        self._finish("abort", "replaced by another goal")

    def update(self, tick: Tick, now: float) -> None:
        """Says how the mission goes, and ends it when it is over."""
        handle, status, state = self._active, tick.status, tick.pose
        if handle is None or status is None or state is None:
            return
        if not math.isfinite(self._began):
            self._began = now
        if handle.is_cancel_requested:
            self._finish("canceled", "cancelled")
        elif tick.state in OVER:
            self._finish(OVER[tick.state], "" if tick.state == "arrived" else tick.reason)
        elif now - self._said_at >= FEEDBACK_EVERY and math.isfinite(state.pose.x):
            self._said_at = now
            handle.publish_feedback(self._feedback(tick, now))

    def _feedback(self, tick: Tick, now: float) -> Any:
        assert tick.status is not None
        assert tick.pose is not None
        found, status, pose = self._type.Feedback(), tick.status, tick.pose.pose
        found.current_pose.header = self._messages.header(self._frame, now)
        found.current_pose.pose = self._messages.pose(pose)
        left = 0.0 if status.plan is None else left_of(status.plan.path, (pose.x, pose.y))
        driven = now - self._began
        self._travelled += math.dist(pose[:2], self._place or pose[:2])
        self._place = pose[:2]
        speed = max(self._travelled / driven if driven > 0.0 else 0.0, SLOWEST)
        found.navigation_time = Duration(seconds=driven).to_msg()
        found.estimated_time_remaining = Duration(seconds=left / speed).to_msg()
        found.number_of_recoveries = min(status.recoveries, 2**15 - 1)
        found.distance_remaining = left
        if hasattr(found, "number_of_poses_remaining"):
            found.number_of_poses_remaining = min(status.goals_left, 2**15 - 1)
        return found

    def _finish(self, how: str, words: str) -> None:
        handle, self._active = self._active, None
        if handle is None or not handle.is_active:
            return

        def ended(handle: Any) -> Any:
            getattr(handle, how)()
            result = self._type.Result()
            if words and hasattr(result, "error_msg"):
                result.error_msg = words
            return result

        handle.execute(ended)
