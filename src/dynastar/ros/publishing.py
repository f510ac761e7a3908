"""What is published besides the command: paths, local map, markers of window and tracks, diagnostics."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Navigator, RobotState, Status
from dynastar.navigator.aligned import turned_pose
from dynastar.robot import arc
from dynastar.ros.outgoing import Colour, Messages

EVERY = 0.2  # s between two pictures of the window, the tracks and the local map
AHEAD = 1.0  # s for which a sample's arc is drawn
POINTS = 6  # of a drawn arc
GREY: Colour = (0.6, 0.6, 0.6, 0.5)
GREEN = (0.0, 0.62, 0.45)
OK_STATES = ("idle", "following", "avoiding", "waiting", "turning", "recovering", "arrived")
OK, WARN, ERROR = (bytes([level]) for level in range(3))  # levels of a DiagnosticStatus
LINE_LIST, CYLINDER, DELETE_ALL = 5, 3, 3  # of a Marker

PUBLISHES = {
    "plan": "nav_msgs/msg/Path",
    "local_plan": "nav_msgs/msg/Path",
    "local_map": "nav_msgs/msg/OccupancyGrid",
    "markers": "visualization_msgs/msg/MarkerArray",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


class StatusPublisher:
    """Decides when to publish what; ``publish(topic, message)`` sends it where it is ``wanted(topic)``."""

    def __init__(
        self,
        messages: Messages,
        frame: str,
        name: str,
        publish: Callable[[str, Any], None],
        wanted: Callable[[str], bool],
    ) -> None:
        self._messages, self._frame, self._name = messages, frame, name
        self._publish, self._wanted = publish, wanted
        self.reset()

    def reset(self) -> None:
        """Time or map have changed: everything is shown again."""
        self._plan_id, self._published, self._said_at = -1, -math.inf, -math.inf
        self._said: tuple[str, str] | None = None

    def show(
        self, navigator: Navigator, status: Status, state: RobotState | None, now: float
    ) -> None:
        """Publishes a new plan at once, and the rest a few times a second where it is wanted."""
        out, frame = self._messages, self._frame
        if status.plan is not None and status.plan_id != self._plan_id:
            self._plan_id = status.plan_id
            self._publish("plan", out.path(status.plan.path.points, frame, now))
        if state is None or not math.isfinite(state.pose.x) or now < self._published + EVERY:
            return
        self._published = now
        if self._wanted("local_plan"):
            self._publish("local_plan", out.path(_driven(state, status), frame, now))
        if self._wanted("local_map"):
            local = navigator.sensing.local_map
            stands = navigator.planning_map.occupied_under(local)
            values = np.where(stands, 100, np.where(local.open > 0, 0, -1)).astype(np.int8)
            corner = turned_pose(Pose2D(*local.origin), navigator.planning_map.grid.frame.yaw)
            cells = local.resolution, *corner
            self._publish("local_map", out.grid(values, cells, frame, now))
        if self._wanted("markers"):
            self._publish("markers", self._window_and_tracks(status, state, now))

    def say(
        self, state: str, reason: str, values: dict[str, Any], now: float, steady: float
    ) -> None:
        """Publishes the state and its reason: at once when it changes, else once a second.

        ``steady`` is a time in seconds that goes on where ``now`` may stand still.
        """
        if (state, reason) == self._said and steady - self._said_at < 1.0:
            return
        self._said, self._said_at = (state, reason), steady
        make, level = self._messages.make, OK if state in OK_STATES else WARN
        pairs = [
            make("diagnostic_msgs/msg/KeyValue", key=key, value=str(value))
            for key, value in {"state": state, **values}.items()
        ]
        status = make(
            "diagnostic_msgs/msg/DiagnosticStatus",
            level=ERROR if state == "sensor_lost" else level,
            name=f"{self._name}: navigation",
            message=f"{state}: {reason}",
            values=pairs,
        )
        header = self._messages.header("", now)
        array = make("diagnostic_msgs/msg/DiagnosticArray", header=header, status=[status])
        self._publish("/diagnostics", array)

    def _window_and_tracks(self, status: Status, state: RobotState, now: float) -> Any:
        """Candidates coloured by score, refused ones grey; tracks with where they will be in 1 s."""
        out = self._messages
        cleared = self._marker("", 0, 0.0, now, action=DELETE_ALL)
        points, colours = [], []
        for line, colour in _candidates(status, state):
            for a, b in pairwise(line):
                points += [out.point(a.x, a.y, 0.05), out.point(b.x, b.y, 0.05)]
                colours += 2 * [out.colour(colour)]
        window = {"points": points, "colors": colours}
        markers = [cleared, self._marker("window", LINE_LIST, 0.01, now, **window)]
        for track in status.tracks:
            for k, alpha in ((0, 0.9), (1, 0.4), (2, 0.2)):
                x, y = float(track.x + k * track.vx), float(track.y + k * track.vy)
                place = out.pose(Pose2D(x, y, 0.0))
                colour = out.colour((*GREEN, alpha))
                size = 2.0 * float(track.radius)
                disc = {"pose": place, "color": colour, "id": len(markers)}
                markers.append(self._marker("tracks", CYLINDER, size, now, **disc))
        return out.make("visualization_msgs/msg/MarkerArray", markers=markers)

    def _marker(self, group: str, kind: int, size: float, now: float, **fields: Any) -> Any:
        out = self._messages
        header = out.header(self._frame, now)
        pose = fields.pop("pose", None) or out.pose(Pose2D(0.0, 0.0, 0.0))
        scale = out.make("geometry_msgs/msg/Vector3", x=size, y=size, z=0.1)
        shape = {"ns": group, "type": kind, "header": header, "pose": pose, "scale": scale}
        return out.make("visualization_msgs/msg/Marker", **shape, **fields)


def _candidates(status: Status, state: RobotState) -> list[tuple[list[Pose2D], Colour]]:
    """The arc of each sample with its colour, by its rank between the worst and the best score."""
    choice = status.choice
    if choice is None:
        return []
    score = choice.score
    good = (choice.refused == 0) & np.isfinite(score)
    low, high = (score[good].min(), score[good].max()) if good.any() else (0.0, 1.0)
    found = []
    for index, (v, omega) in enumerate(choice.samples):
        part = float((score[index] - low) / max(high - low, 1e-9)) if good[index] else 0.0
        colour = (1.0 - part, part, 0.2, 0.9) if good[index] else GREY
        line = [arc(state.pose, Twist(v, omega), AHEAD * k / POINTS) for k in range(POINTS + 1)]
        found.append((line, colour))
    return found


def _driven(state: RobotState, status: Status) -> npt.NDArray[np.float64]:
    """The arc of the chosen sample for as long as it is held and a little more, (n, 2) metres."""
    choice = status.choice
    if choice is None or choice.manoeuvre is None:
        return np.array([state.pose[:2]])
    v, omega, hold, _ = choice.manoeuvre
    times = np.linspace(0.0, max(hold, AHEAD), 2 * POINTS)
    return np.array([arc(state.pose, Twist(v, omega), float(t))[:2] for t in times])
