"""What the node shows: paths, the local map, markers of the window and of tracks, diagnostics."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Path as PathMessage
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Navigator, RobotState, Status
from dynastar.robot import arc
from dynastar.ros.convert import grid_message, path_message, stamp_of

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SHOWN_EVERY = 0.2  # s between two pictures of the window, the tracks and the local map
AHEAD = 1.0  # s for which a sample's arc is drawn
POINTS = 6  # of a drawn arc
GREY = (0.6, 0.6, 0.6, 0.5)
OK_STATES = ("idle", "following", "avoiding", "waiting", "turning", "recovering", "arrived")


class Publishers:
    """Everything that is published besides the command."""

    def __init__(self, node: Node, frame: str) -> None:
        self._frame, self._name = frame, node.get_name()
        self._plan = node.create_publisher(PathMessage, "plan", LATCHED)
        self._local_plan = node.create_publisher(PathMessage, "local_plan", 1)
        self._local_map = node.create_publisher(GridMessage, "local_map", 1)
        self._markers = node.create_publisher(MarkerArray, "markers", 1)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._plan_id, self._shown = -1, -math.inf
        self._said: tuple[str, str] | None = None
        self._said_at = -math.inf

    def reset(self) -> None:
        """Time or map have changed: everything is shown again."""
        self._plan_id, self._shown, self._said_at = -1, -math.inf, -math.inf

    def show(
        self, navigator: Navigator, status: Status, state: RobotState | None, now: float
    ) -> None:
        """Publishes a new plan at once, and the rest a few times a second where it is subscribed to."""
        if status.plan is not None and status.plan_id != self._plan_id:
            self._plan_id = status.plan_id
            self._plan.publish(path_message(status.plan.path.points, self._frame, now))
        if state is None or not math.isfinite(state.pose.x) or now < self._shown + SHOWN_EVERY:
            return
        self._shown = now
        if self._local_plan.get_subscription_count():
            points = _driven(state, status)
            self._local_plan.publish(path_message(points, self._frame, now))
        if self._local_map.get_subscription_count():
            local = navigator.sensing.local_map
            stands = navigator.planning_map.stands_in(local)
            values = np.where(stands, 100, np.where(local.open > 0, 0, -1)).astype(np.int8)
            self._local_map.publish(grid_message(values, local.frame, self._frame, now))
        if self._markers.get_subscription_count():
            self._markers.publish(self._window_and_tracks(status, state, now))

    def say(self, state: str, reason: str, values: dict[str, Any], now: float) -> None:
        """Publishes the state and its reason: at once when it changes, else once a second."""
        if (state, reason) == self._said and 0.0 <= now - self._said_at < 1.0:
            return
        self._said, self._said_at = (state, reason), now
        level = DiagnosticStatus.OK if state in OK_STATES else DiagnosticStatus.WARN
        if state == "sensor_lost":
            level = DiagnosticStatus.ERROR
        message = DiagnosticArray()
        message.header.stamp = stamp_of(now)
        pairs = [
            KeyValue(key=key, value=str(value)) for key, value in {"state": state, **values}.items()
        ]
        words = f"{state}: {reason}"
        message.status = [
            DiagnosticStatus(
                level=level, name=f"{self._name}: navigation", message=words, values=pairs
            )
        ]
        self._diagnostics.publish(message)

    def _window_and_tracks(self, status: Status, state: RobotState, now: float) -> MarkerArray:
        """Candidates coloured by score, refused ones grey; tracks with where they will be in 1 s."""
        window = self._marker("window", Marker.LINE_LIST, 0.01, now)
        choice = status.choice
        if choice is not None:
            score = choice.score
            good = (choice.refused == 0) & np.isfinite(score)
            low, high = (score[good].min(), score[good].max()) if good.any() else (0.0, 1.0)
            for index, (v, omega) in enumerate(choice.samples):
                part = (score[index] - low) / max(high - low, 1e-9) if good[index] else 0.0
                colour = (1.0 - part, part, 0.2, 0.9) if good[index] else GREY
                line = [
                    arc(state.pose, Twist(v, omega), AHEAD * k / POINTS) for k in range(POINTS + 1)
                ]
                for a, b in pairwise(line):
                    window.points += [_point(a), _point(b)]
                    window.colors += 2 * [
                        ColorRGBA(**dict(zip("rgba", map(float, colour), strict=True)))
                    ]
        markers = [self._cleared(), window]
        for track in status.tracks:
            for k, alpha in ((0, 0.9), (1, 0.4), (2, 0.2)):
                disc = self._marker("tracks", Marker.CYLINDER, 2.0 * float(track.radius), now)
                disc.id = len(markers)
                disc.pose.position.x = float(track.x + k * track.vx)
                disc.pose.position.y = float(track.y + k * track.vy)
                disc.scale.z = 0.1
                disc.color = ColorRGBA(r=0.0, g=0.62, b=0.45, a=alpha)
                markers.append(disc)
        return MarkerArray(markers=markers)

    def _marker(self, group: str, kind: int, size: float, now: float) -> Marker:
        marker = Marker(ns=group, type=kind, action=Marker.ADD)
        marker.header.stamp, marker.header.frame_id = stamp_of(now), self._frame
        marker.scale.x = marker.scale.y = size
        marker.pose.orientation.w = 1.0
        return marker

    def _cleared(self) -> Marker:
        marker = Marker(action=Marker.DELETEALL)
        marker.header.frame_id = self._frame
        return marker


def _point(pose: Pose2D) -> Point:
    return Point(x=float(pose.x), y=float(pose.y), z=0.05)


def _driven(state: RobotState, status: Status) -> np.ndarray[Any, np.dtype[np.float64]]:
    """The arc of the chosen sample for as long as it is held and a little more, (n, 2) metres."""
    choice = status.choice
    if choice is None or choice.manoeuvre is None:
        return np.array([state.pose[:2]])
    v, omega, hold, _ = choice.manoeuvre
    times = np.linspace(0.0, max(hold, AHEAD), 2 * POINTS)
    return np.array([arc(state.pose, Twist(v, omega), float(t))[:2] for t in times])
