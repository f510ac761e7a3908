"""Messages of scan, odometry, pose, tf and maps: what is late, wrong or missing, and the state now."""

import math
from abc import ABC, abstractmethod
from typing import Any

from dynastar.errors import DynastarError, InputError
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.masks import SpeedScale, with_keepout, with_speed_limits
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.robot import Robot
from dynastar.ros.incoming import check_frame, grid_of, pose_of, scan_of, seconds, twist_of
from dynastar.ros.localization import Localization
from dynastar.ros.settings import NodeSettings
from dynastar.ros.transforms import Mount, Transforms
from dynastar.scan import LaserScan

APART = 0.1  # s that the clocks of two lidars may be apart
JUMP = 0.5  # s by which a clock that goes back, or a stamp ahead of it, is another time
NOWHERE = Pose2D(math.nan, math.nan, math.nan)
LAYERS = "map", "keepout_filter_mask", "speed_filter_mask"
SENSED = {
    "map": "nav_msgs/msg/OccupancyGrid",
    "keepout_filter_mask": "nav_msgs/msg/OccupancyGrid",
    "speed_filter_mask": "nav_msgs/msg/OccupancyGrid",
    "scan": "sensor_msgs/msg/LaserScan",
    "odom": "nav_msgs/msg/Odometry",
    "amcl_pose": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
}


class Intake(ABC):
    """What a robot's messages say, for a navigator or a guard."""

    def __init__(self, settings: NodeSettings, robot: Robot, config: NavigatorConfig) -> None:
        self.settings, self.robot, self.config = settings, robot, config
        self.grid: OccupancyGrid | None = None
        self.localization = Localization(settings.pose_source)
        self.transforms = Transforms()
        self.refused = ""  # what was refused last, and why
        self._refusals: dict[str, str] = {}  # by topic, why its newest message was refused
        self.fault = ""  # what else keeps it from driving, as a clock that stands still
        self.odometry_frame = ""
        self._layers: dict[str, OccupancyGrid] = {}  # the newest map and masks
        self._scan: LaserScan | None = None
        self._new_scans: list[LaserScan] = []  # since the last tick
        # Frames of lidars that are taken to be where one is built in.
        self._assumed: set[str] = set()
        self._now = self._at = -math.inf  # the clock, and the time of the last state

    # -- what comes in ----------------------------------------------------------------------------

    def take(self, topic: str, message: Any) -> str:
        """Use a message of a topic in SENSED. Returns what is wrong with it, or ""."""
        try:
            if topic in LAYERS:
                self._use_layer(topic, grid_of(message, self.settings.global_frame))
            elif topic == "scan":
                self._take_scan(message)
            elif topic == "odom":
                self._take_odometry(message)
            elif topic == "amcl_pose":
                self._take_pose(message)
            else:
                self.transforms.add(message, static=topic.endswith("static"))
        except DynastarError as error:
            self.refused = str(error)
            self._refusals[topic] = self.refused
            return self.refused
        self._refusals.pop(topic, None)
        return ""

    def use_map(self, grid: OccupancyGrid) -> None:
        """Uses a map as if a message had brought it. InputError where it does not fit the masks."""
        self._use_layer("map", grid)

    @abstractmethod
    def _use_grid(self, grid: OccupancyGrid) -> None:
        """Uses another map with its masks."""

    def _use_layer(self, topic: str, layer: OccupancyGrid) -> None:
        """Takes in a map or a mask, and uses the map with its masks if there is one."""
        settings, grids = self.settings, {**self._layers, topic: layer}
        grid = grids.get("map")
        if grid is not None and "keepout_filter_mask" in grids:
            grid = with_keepout(grid, grids["keepout_filter_mask"])
        if grid is not None and "speed_filter_mask" in grids:
            scale = SpeedScale(
                settings.speed_filter_type,
                settings.speed_filter_base,
                settings.speed_filter_multiplier,
            )
            v_max = self.robot.limits.v_max
            grid = with_speed_limits(grid, grids["speed_filter_mask"], v_max, scale)
        if grid is not None:
            self._use_grid(grid)
        self._layers, self.grid = grids, grid

    def _take_scan(self, message: Any) -> None:
        self._scan = scan_of(message, self._mount(message.header.frame_id))
        self._new_scans.append(self._scan)

    def _mount(self, frame: str) -> Mount:
        """Where the lidar is: as given, else from tf where it is known, else as built in.

        InputError for a frame that tf has elsewhere than on the robot.
        """
        built_in, base = Mount(self.robot.lidar.mount), self.settings.base_frame
        if self.settings.laser_pose:
            return built_in
        name = frame.lstrip("/")
        found = self.transforms.planar(base, name)
        if found is None and self.transforms.planar(name, base) is not None:
            raise InputError(
                f"the scan is in the frame '{name:.80}', which the robot moves in: expected the frame "
                f"of a lidar, fixed to '{base}'"
            )
        if found is None:
            self._assumed.add(frame)
            return built_in
        if frame in self._assumed and not found.is_near(built_in):
            self._drop_sensed()
        self._assumed.discard(frame)
        return found

    @abstractmethod
    def _drop_sensed(self) -> None:
        """Drops what was sensed: a lidar was not where it was taken to be."""

    def _take_odometry(self, message: Any) -> None:
        self.odometry_frame = message.header.frame_id.lstrip("/")
        self.localization.add_odometry(
            seconds(message.header.stamp),
            pose_of(message.pose.pose, "the odometry"),
            twist_of(message.twist.twist),
        )

    def _take_pose(self, message: Any) -> None:
        if self.settings.pose_source == "amcl":
            check_frame("the pose", message.header.frame_id, self.settings.global_frame)
            pose = pose_of(message.pose.pose, "the pose in the map")
            self.localization.add_pose(seconds(message.header.stamp), pose)

    def _forget(self, reason: str) -> None:
        """Forgets all but the map: time has jumped."""
        self.localization.reset()
        self.transforms.clear()
        self._scan, self._new_scans, self.refused = None, [], reason
        self._refusals = {one: why for one, why in self._refusals.items() if one in LAYERS}
        self._at = -math.inf

    # -- what is known now ------------------------------------------------------------------------

    def jumped(self, now: float) -> bool:
        """Whether the clock (s) has gone back since it was asked last; it never does by a little."""
        before, self._now = self._now, now
        return now < before - JUMP

    def _take_new_scans(self) -> list[LaserScan]:
        """The scans that have come since the last tick."""
        scans, self._new_scans = self._new_scans, []
        return scans

    def _state(self, now: float) -> tuple[RobotState, str]:
        """The state now, and what is wrong with odometry, scan or pose: then a state that stops."""
        scan = self._scan
        trouble = self.fault or self._layer_refused()
        trouble = trouble or self._late("odometry", "odom", self.localization.stamp, now)
        scanned = -math.inf if scan is None else scan.stamp
        trouble = trouble or self._late("scan", "scan", scanned, now)
        trouble = trouble or self._follow_tf(now)
        at = now if scan is None or scan.stamp - now > JUMP else max(now, scan.stamp)
        if 0.0 < self._at - at <= APART:  # by another lidar's scan
            at = self._at
        self._at = at
        state = self.localization.at(at)
        if state is None:
            unknown = "the pose in the map is not known yet"
            trouble = trouble or self._refusals.get("amcl_pose", unknown)
        if trouble or state is None:
            twist = Twist(0.0, 0.0) if state is None else state.twist
            return RobotState(at, NOWHERE, twist), trouble
        return state, ""

    def _layer_refused(self) -> str:
        """Why a map or a mask was refused of which there is none in use, or ""."""
        found = (topic for topic in LAYERS if topic in self._refusals and topic not in self._layers)
        return next((f"{topic}: {self._refusals[topic]}" for topic in found), "")

    def _late(self, what: str, topic: str, stamp: float, now: float) -> str:
        """Describe what is wrong with the stamp of data, or why newer data were refused, or ""."""
        late = lateness(what, stamp, now, self.settings.data_age)
        return self._refusals.get(topic, late) if late else ""

    def _follow_tf(self, now: float) -> str:
        """Takes the pose of the odometry's frame in the map from tf; what is wrong, or ""."""
        if self.settings.pose_source != "tf":
            return ""
        frame, parent = self.odometry_frame, self.settings.global_frame
        try:
            found = self.transforms.planar(parent, frame)
        except InputError as error:
            return str(error)
        if found is None:
            return f"tf does not say where '{frame:.80}' is in '{parent}'"
        ages = self.transforms.ages(parent, frame, now)
        if ages and max(ages) > self.settings.pose_age:
            return f"the transform of '{frame}' is {max(ages):.2f} s old"
        if ages and -min(ages) > self.settings.pose_age:
            return f"the transform of '{frame}' is stamped {-min(ages):.2f} s ahead of the clock"
        self.localization.map_to_odom = found.pose
        return ""


def lateness(what: str, stamp: float, now: float, age: float) -> str:
    """Describe what is wrong with the stamp of data, or ""."""
    if not math.isfinite(stamp):
        return f"no {what} has come yet"
    if now - stamp > age:
        return f"the {what} is {now - stamp:.2f} s old"
    if stamp - now > JUMP:
        return f"the {what} is stamped {stamp - now:.2f} s ahead of the clock"
    return ""
