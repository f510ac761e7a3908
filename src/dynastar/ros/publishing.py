"""What is published besides the command: paths, local map, cost-to-go, markers, diagnostics."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Navigator, RobotState, Status
from dynastar.navigator.aligned import turned_pose
from dynastar.robot import arc
from dynastar.ros.markers import AHEAD, POINTS, Markers
from dynastar.ros.outgoing import Messages

EVERY = 0.2  # s between two pictures of the candidates, the tracks and the local map
OK_STATES = (
    *("idle", "following", "avoiding", "waiting", "turning", "recovering", "arrived"),
    *("passing", "limiting"),  # of a guard
)
OK, WARN, ERROR = (bytes([level]) for level in range(3))  # levels of a DiagnosticStatus

PUBLISHES = {
    "plan": "nav_msgs/msg/Path",
    "local_plan": "nav_msgs/msg/Path",
    "local_map": "nav_msgs/msg/OccupancyGrid",
    "cost_to_go": "nav_msgs/msg/OccupancyGrid",
    "markers": "visualization_msgs/msg/MarkerArray",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


class StatusPublisher:
    """Decides when to publish what; ``publish(topic, message)`` sends it where it is ``wanted(topic)``.

    ``name`` is that of the status in /diagnostics.
    """

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
        self._markers = Markers(messages, frame)
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
        local = navigator.sensing.local_map
        yaw = navigator.planning_map.grid.frame.yaw
        if self._wanted("local_map"):
            occupied = navigator.planning_map.occupied_under(local)
            values = np.where(occupied, 100, np.where(local.open, 0, -1)).astype(np.int8)
            cells = local.resolution, *turned_pose(Pose2D(*local.origin), yaw)
            self._publish("local_map", out.grid(values, cells, frame, now))
        guide = navigator.driving.guide
        if self._wanted("cost_to_go") and guide is not None and status.choice is not None:
            cost, x, y, side = guide.cost_to_go.value
            corner = Pose2D(x - 0.5 * side, y - 0.5 * side, 0.0)  # of cells twice as large
            cells = 2.0 * side, *turned_pose(corner, yaw)
            self._publish("cost_to_go", out.grid(_percent(cost[::2, ::2]), cells, frame, now))
        if self._wanted("markers"):
            footprint = navigator.robot.footprint
            self._publish("markers", self._markers.array(footprint, status, state, now))

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
            name=self._name,
            message=f"{state}: {reason}",
            values=pairs,
        )
        header = self._messages.header("", now)
        array = make("diagnostic_msgs/msg/DiagnosticArray", header=header, status=[status])
        self._publish("/diagnostics", array)


def _percent(cost: npt.NDArray[np.floating]) -> npt.NDArray[np.int8]:
    """A cost-to-go from 0, the least in the window, to 100, the largest; -1 where it is not known."""
    known = np.isfinite(cost)
    if not known.any():
        return np.full(cost.shape, -1, np.int8)
    low, high = float(cost[known].min()), float(cost[known].max())
    part = (np.where(known, cost, low) - low) / max(high - low, 1e-9)
    return np.where(known, np.round(100.0 * part), -1.0).astype(np.int8)


def _driven(state: RobotState, status: Status) -> npt.NDArray[np.float64]:
    """The arc of the chosen sample for as long as it is held and a little more, (n, 2) metres."""
    choice = status.choice
    if choice is None or choice.manoeuvre is None:
        return np.array([state.pose[:2]])
    v, omega, hold, _ = choice.manoeuvre
    times = np.linspace(0.0, max(hold, AHEAD), 2 * POINTS)
    return np.array([arc(state.pose, Twist(v, omega), float(t))[:2] for t in times])
