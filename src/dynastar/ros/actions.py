"""Nav2's actions NavigateToPose, NavigateThroughPoses and FollowPath, where nav2_msgs is installed."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.node import Node

from dynastar.errors import DynastarError, InputError
from dynastar.path import Path
from dynastar.ros.bridge import Tick
from dynastar.ros.incoming import check_frame, goal_of, pose_of
from dynastar.ros.outgoing import Messages

FEEDBACK_EVERY = 0.5  # s
SLOWEST = 0.05  # m/s, of the mean speed by which the time that is left is estimated
OVER = {"arrived": "succeed", "blocked": "abort", "idle": "abort"}
ACTIONS = {
    "navigate_to_pose": "nav2_msgs/action/NavigateToPose",
    "navigate_through_poses": "nav2_msgs/action/NavigateThroughPoses",
    "follow_path": "nav2_msgs/action/FollowPath",
}


def requested(request: Any, frame: str) -> dict[str, Any]:
    """What an action's goal asks of ``Bridge.request``: goals to reach, or a path to follow.

    Raises InputError for another frame, for poses that are not finite, and where there are none.
    """
    if hasattr(request, "path"):
        check_frame("the path", request.path.header.frame_id, frame)
        poses = [pose_of(stamped.pose) for stamped in request.path.poses]
        if not poses:
            raise InputError("there is no pose in the path: expected one or more")
        return {"follow": ([[pose.x, pose.y] for pose in poses], poses[-1].theta)}
    if hasattr(request, "pose"):
        return {"goals": [goal_of(request.pose, frame)]}
    poses = request.poses
    for inner in ("goals", "poses"):  # nav_msgs/Goals, nav2_msgs/PoseStampedArray
        poses = getattr(poses, inner, poses)
    if not poses:
        raise InputError("there is no pose in the goal: expected one or more")
    return {"goals": [goal_of(pose, frame) for pose in poses]}


def remaining_length(path: Path, place: tuple[float, float]) -> float:
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
        self._request = request  # as Bridge.request, which raises a DynastarError
        self._active: Any = None
        self._type: Any = None
        self._began = self._said_at = -math.inf
        self._travelled = 0.0
        self._place: tuple[float, float] | None = None
        self._path: Path | None = None  # one that was given
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
            self._request(**requested(request, self._frame))
        except DynastarError as error:
            self._node.get_logger().warning(f"the goal is refused: {error}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _accept(self, handle: Any, kind: Any) -> None:
        self.replaced()
        self._active, self._type = handle, kind
        self._began, self._said_at = math.nan, -math.inf
        self._travelled, self._place = 0.0, None
        request = handle.request
        follows = hasattr(request, "path")
        self._path = Path(requested(request, self._frame)["follow"][0]) if follows else None

    def _on_cancel(self, handle: Any) -> CancelResponse:
        if handle is self._active:
            self._request(cancel=True)
        return CancelResponse.ACCEPT

    def replaced(self) -> None:
        """Ends the mission under way, since another goal has come."""
        self._finish("abort", "replaced by another goal")

    def update(self, tick: Tick, now: float) -> None:
        """Says how the mission goes, and ends it when it is over."""
        handle, status, state = self._active, tick.status, tick.robot
        if handle is None or status is None or state is None:
            return
        if not math.isfinite(self._began):
            self._began = now
        if handle.is_cancel_requested:
            self._finish("canceled", "cancelled")
        elif tick.state in OVER:
            self._finish(OVER[tick.state], "" if tick.state == "arrived" else tick.reason)
            if tick.state == "blocked":  # with a new map the navigator would try again
                self._request(cancel=True)
        elif now - self._said_at >= FEEDBACK_EVERY and math.isfinite(state.pose.x):
            self._said_at = now
            handle.publish_feedback(self._feedback(tick, now))

    def _feedback(self, tick: Tick, now: float) -> Any:
        assert tick.status is not None
        assert tick.robot is not None
        status, pose = tick.status, tick.robot.pose
        path = status.plan.path if self._path is None and status.plan is not None else self._path
        left = 0.0 if path is None else remaining_length(path, (pose.x, pose.y))
        driven = now - self._began
        self._travelled += math.dist(pose[:2], self._place or pose[:2])
        self._place = pose[:2]
        mean = max(self._travelled / driven if driven > 0.0 else 0.0, SLOWEST)
        here = self._messages.make(
            "geometry_msgs/msg/PoseStamped",
            header=self._messages.header(self._frame, now),
            pose=self._messages.pose(pose),
        )
        known = {
            "current_pose": here,
            "navigation_time": Duration(seconds=driven).to_msg(),
            "estimated_time_remaining": Duration(seconds=left / mean).to_msg(),
            "number_of_recoveries": min(status.recoveries, 2**15 - 1),
            "number_of_poses_remaining": min(status.goals_left, 2**15 - 1),
            "distance_remaining": left,
            "distance_to_goal": left,
            "speed": float(tick.robot.twist.v),
        }
        fields = self._type.Feedback.get_fields_and_field_types()
        return self._type.Feedback(**{key: known[key] for key in fields if key in known})

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
