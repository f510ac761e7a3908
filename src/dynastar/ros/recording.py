"""A mission in simulation, driven by messages as the node is, and recorded."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.episode import Episode
from dynastar.geometry import Goal, Pose2D, Twist, as_goals
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState, Status
from dynastar.robot import Robot
from dynastar.ros.bag import BagWriter, as_read, make
from dynastar.ros.bridge import REQUESTS, TAKES, Bridge, start_request
from dynastar.ros.outgoing import Messages
from dynastar.ros.publishing import PUBLISHES, StatusPublisher
from dynastar.ros.settings import NodeSettings
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario, warm_up
from dynastar.simulation.run import drive
from dynastar.simulation.start import check_start

KINDS = {
    **TAKES,
    **PUBLISHES,
    "cmd_vel": "geometry_msgs/msg/Twist",
    REQUESTS: "std_msgs/msg/String",
}
AT_ORIGIN = Pose2D(0.0, 0.0, 0.0)


def run_recorded(
    scenario: Scenario, folder: Path, progress: bool = False, seed: int | None = None
) -> Episode:
    """``simulation.run`` with a recording in a new folder.

    The pose in the map stands in odom, whose frame is the map's. Raises DataError for a folder
    that exists and MissingPackage without rosbags.
    """
    check_start(scenario)
    warm_up()
    with BagWriter(folder) as bag:

        def driven(
            grid: OccupancyGrid, robot: Robot, config: NavigatorConfig
        ) -> RecordingController:
            return RecordingController(bag, grid, robot, config)

        return drive(scenario, progress, seed, navigator=driven, trace=True)


class RecordingController:
    """What ``simulation.drive`` drives by: a Bridge that is given messages, all of them recorded.

    What it sees is rounded as the messages are, so that a replay gives its commands to the last digit.
    """

    def __init__(
        self, bag: BagWriter, grid: OccupancyGrid, robot: Robot, config: NavigatorConfig
    ) -> None:
        self._bag, self._out, self._now = bag, Messages(make), 0.0
        self._settings = NodeSettings(robot=robot.name)
        frame = self._settings.global_frame
        self._bridge = Bridge(self._settings, robot, config)
        self._status = StatusPublisher(
            self._out, frame, "dynastar: navigation", self._write, lambda topic: True
        )
        self._write(REQUESTS, self._out.text(start_request(self._settings, robot, config)))
        self._give(
            "/tf_static", self._out.transforms([("base_link", "laser", robot.lidar.mount)], 0.0)
        )
        self.set_map(grid)

    @property
    def status(self) -> Status:
        """The navigator's."""
        return self.navigator.status

    @property
    def navigator(self) -> Navigator:
        """The bridge's."""
        assert self._bridge.navigator is not None
        return self._bridge.navigator

    def _write(self, topic: str, message: Any) -> None:
        name = topic if topic.startswith("/") else f"/{topic}"
        self._bag.write(name, KINDS[topic], self._now, message)

    def _give(self, topic: str, message: Any) -> None:
        """Writes a message, and gives the bridge what a reader of the recording gets."""
        self._write(topic, message)
        self._bridge.take(topic, as_read(KINDS[topic], message))

    def set_map(self, grid: OccupancyGrid) -> None:
        """A map, and its keep-out zones and speed limits (to a hundredth of v_max) as Nav2's masks."""
        frame = self._settings.global_frame
        layers = {}
        if grid.keepout is not None:
            layers["keepout_filter_mask"] = np.where(grid.keepout, 100, 0).astype(np.int8)
        if grid.speed_limit is not None:
            percent = 100.0 * (1.0 - grid.speed_limit / self._bridge.robot.limits.v_max)
            layers["speed_filter_mask"] = np.clip(np.round(percent), 0, 99).astype(np.int8)
        for topic, values in (layers | {"map": grid.values}).items():
            self._give(topic, self._out.grid(values, grid.frame, frame, self._now))

    def set_goal(self, goals: Sequence[Goal]) -> None:
        """Goals to reach, in order."""
        words = self._bridge.request(goals=[tuple(goal) for goal in as_goals(goals)])
        self._write(REQUESTS, self._out.text(words))

    def command(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """The bridge's command for messages of this state and scan."""
        if math.isfinite(state.stamp):
            self._now = 1e-6 * round(1e6 * state.stamp)
        out, base = self._out, self._settings.base_frame
        carried = [(self._settings.global_frame, "odom", AT_ORIGIN), ("odom", base, state.pose)]
        self._write("/tf", out.transforms(carried, self._now))
        self._give("odom", out.odometry(state.pose, state.twist, ("odom", base), self._now))
        if scan is not None:
            self._give("scan", out.scan(scan, "laser"))
        tick = self._bridge.tick(self._now)
        self._write("cmd_vel", out.twist(tick.command))
        if tick.status is not None:
            self._status.show(self.navigator, tick.status, tick.robot, self._now)
        values = self._bridge.values(tick)
        self._status.say(tick.state, tick.reason, values, self._now, self._now)
        return tick.command
