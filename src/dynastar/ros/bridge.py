"""Messages in, commands out: what the node does, and what a recording is replayed with."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dynastar.config import checked
from dynastar.errors import DynastarError, InputError
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.masks import SpeedScale, with_keepout, with_speed_limits
from dynastar.navigator import Navigator, NavigatorConfig, RobotState, Status
from dynastar.robot import Robot
from dynastar.ros.incoming import check_frame, goal_of, grid_of, pose_of, scan_of, seconds, twist_of
from dynastar.ros.localization import Localization
from dynastar.ros.settings import NodeSettings, flat, nested, robot_from, robot_table
from dynastar.ros.transforms import Mount, Transforms
from dynastar.scan import LaserScan

JUMP = 0.5  # s by which a clock that goes back, or a stamp ahead of it, is another time
NOWHERE = Pose2D(math.nan, math.nan, math.nan)

TAKES = {
    "map": "nav_msgs/msg/OccupancyGrid",
    "keepout_filter_mask": "nav_msgs/msg/OccupancyGrid",
    "speed_filter_mask": "nav_msgs/msg/OccupancyGrid",
    "scan": "sensor_msgs/msg/LaserScan",
    "odom": "nav_msgs/msg/Odometry",
    "goal_pose": "geometry_msgs/msg/PoseStamped",
    "amcl_pose": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
}
REQUESTS = "dynastar/requests"  # what was asked for by services, actions and parameters, as JSON


def start_request(settings: NodeSettings, robot: Robot, config: NavigatorConfig) -> str:
    """The first request of a recording: what the bridge was made of, as JSON."""
    table = {
        "settings": settings._asdict(),
        "robot": robot_table(robot),
        "config": nested(flat(config)),
    }
    return json.dumps({"start": table})


def started(table: Mapping[str, Any]) -> "Bridge":
    """The bridge that a recording's first request tells of; InputError where it cannot be."""
    try:
        settings = checked(NodeSettings, table["settings"], "settings")
        config = checked(NavigatorConfig, table["config"], "config")
        return Bridge(settings, robot_from(table["robot"]), config)
    except (KeyError, TypeError) as error:
        raise InputError(f"a recording's start cannot be read: {error}") from None


class Tick(NamedTuple):
    """Result of a tick: command, state of the navigator with its reason, status, state of the robot."""

    command: Twist
    state: str
    reason: str
    status: Status | None = None
    robot: RobotState | None = None


class Bridge:
    """A navigator that is fed with messages, and brakes while they are missing, late or wrong."""

    def __init__(self, settings: NodeSettings, robot: Robot, config: NavigatorConfig) -> None:
        self.settings, self.robot, self.config = settings, robot, config
        self.navigator: Navigator | None = None
        self.grid: OccupancyGrid | None = None
        self.localization = Localization(settings.pose_source)
        self.transforms = Transforms()
        self.refused = ""  # what was refused last, and why
        self.goals_taken = self.goals_refused = 0  # since the start
        self._refusals: dict[str, str] = {}  # by topic, why its newest message was refused
        self.fault = ""  # what else keeps it from driving, as a clock that stands still
        self._odometry_frame = ""
        self._layers: dict[str, OccupancyGrid] = {}  # the newest map and masks
        self._scan: LaserScan | None = None
        self._taken = False  # whether the newest scan has been given to the navigator
        self._now = -math.inf

    # -- what comes in ----------------------------------------------------------------------------

    def take(self, topic: str, message: Any) -> str:
        """Use a message of a topic in TAKES. Returns what is wrong with it, or ""."""
        try:
            if topic == "map" or topic.endswith("_filter_mask"):
                self._use_layer(topic, grid_of(message, self.settings.global_frame))
            elif topic == "scan":
                self._take_scan(message)
            elif topic == "odom":
                self._take_odometry(message)
            elif topic == "goal_pose":
                self.set_goals([goal_of(message, self.settings.global_frame)])
            elif topic == "amcl_pose":
                self._take_pose(message)
            else:
                self.transforms.add(message, static=topic.endswith("static"))
        except DynastarError as error:
            self.refused = str(error)
            if topic == "goal_pose":
                self.refused = f"the goal is refused: {error}"
                self.goals_refused += 1
            self._refusals[topic] = self.refused
            return self.refused
        self._refusals.pop(topic, None)
        return ""

    def use_map(self, grid: OccupancyGrid) -> None:
        """Uses a map as if a message had brought it. InputError where it does not fit the masks."""
        self._use_layer("map", grid)

    def _use_layer(self, topic: str, layer: OccupancyGrid) -> None:
        """A navigator for the map with its masks, or the present one with another map."""
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
        self._layers, self.grid = grids, grid
        if grid is not None and self.navigator is None:
            self.navigator = Navigator(grid, self.robot, self.config)
        elif grid is not None and self.navigator is not None:
            self.navigator.set_map(grid)

    def _take_scan(self, message: Any) -> None:
        self._scan, self._taken = scan_of(message, self._mount(message.header.frame_id)), False

    def _mount(self, frame: str) -> Mount:
        """Where the lidar is: as given, else from tf where it is known, else as built in."""
        if not self.settings.laser_pose:
            found = self.transforms.planar(self.settings.base_frame, frame.lstrip("/"))
            if found is not None:
                return found
        return Mount(self.robot.lidar.mount)

    def _take_odometry(self, message: Any) -> None:
        self._odometry_frame = message.header.frame_id.lstrip("/")
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

    # -- what is asked for ------------------------------------------------------------------------

    def set_goals(self, goals: list[Goal]) -> None:
        """Drives to goals, in order, in place of the present ones; InputError leaves those."""
        if self.navigator is None:
            raise InputError("there is no map yet")
        for goal in goals:
            self.navigator.planning_map.grid.world_to_cell(goal.x, goal.y)
        self.navigator.set_goal(goals)
        self.goals_taken += 1

    def follow(self, points: Sequence[Sequence[float]], heading: float | None = None) -> None:
        """Drives along a path (n, 2), metres, in place of the present goals; InputError leaves those."""
        if self.navigator is None:
            raise InputError("there is no map yet")
        self.navigator.follow(np.array(points, dtype=np.float64).reshape(-1, 2), heading)
        self.goals_taken += 1

    def request(self, **wanted: Any) -> str:
        """Carries out requests by name, and returns them as JSON.

        ``goals`` (x, y, heading), ``follow`` (points, heading), ``cancel``, ``clear``, ``settings``,
        ``restart`` and ``fault`` with their reasons. Raises InputError for one that cannot be carried out,
        which changes nothing.
        """
        for name, value in wanted.items():
            if name == "goals":
                self.set_goals([Goal(*goal) for goal in value])
            elif name == "follow":
                self.follow(*value)
            elif name == "settings":
                self._change(value)
            elif name == "restart":
                self._restart(value)
            elif name == "fault":
                self.fault = str(value)
            elif self.navigator is None:
                raise InputError("there is no map yet")
            elif name == "cancel":
                self.navigator.cancel()
            elif name == "clear":
                self.navigator.forget()
            else:
                raise InputError(f"unknown request '{name:.80}'")
        return json.dumps(wanted)

    def _change(self, values: Mapping[str, Any]) -> None:
        """Other settings from now on; the goals stay."""
        self.config = checked(NavigatorConfig, values)
        if self.navigator is not None and self.grid is not None:
            goals = self.navigator.mission.goals
            self.navigator = Navigator(self.grid, self.robot, self.config)
            self.navigator.set_goal(goals)

    def _restart(self, reason: str) -> None:
        """Forgets all but the map: time has jumped."""
        self.localization.reset()
        self.transforms.clear()
        self._scan, self.refused = None, reason
        self._refusals.clear()
        if self.grid is not None:
            self.navigator = Navigator(self.grid, self.robot, self.config)

    # -- the loop ---------------------------------------------------------------------------------

    def jumped(self, now: float) -> bool:
        """Whether the clock (s) has gone back since it was asked last; it never does by a little."""
        before, self._now = self._now, now
        return now < before - JUMP

    def tick(self, now: float) -> Tick:
        """The command at ``now`` (s); braking, with the reason, where data are missing or late."""
        if self.navigator is None:
            reason = self.fault or self._refusals.get("map", "no map has come yet")
            return Tick(Twist(0.0, 0.0), "idle", reason)
        state, trouble = self._state(now)
        scan = None if self._taken else self._scan
        self._taken = True
        command = self.navigator.command(state, scan)
        status = self.navigator.status
        return Tick(command, status.state, trouble or status.reason, status, state)

    def values(self, tick: Tick) -> dict[str, str]:
        """What is said of a tick beside its state and reason, by name."""
        status = Status() if tick.status is None else tick.status
        return {
            "v": f"{tick.command.v:.3f} m/s",
            "omega": f"{tick.command.omega:.3f} rad/s",
            "limited by": status.limited_by,
            "path": status.plan_reason,
            "goals left": str(status.goals_left),
            "replans": str(status.replans),
            "goals taken": str(self.goals_taken),
            "goals refused": str(self.goals_refused),
            "refused": self.refused,
        }

    def _state(self, now: float) -> tuple[RobotState, str]:
        """The state now, and what is wrong with odometry, scan or pose: then a state that stops."""
        scan = self._scan
        trouble = self.fault or self._late("odometry", "odom", self.localization.stamp, now)
        scanned = -math.inf if scan is None else scan.stamp
        trouble = trouble or self._late("scan", "scan", scanned, now)
        trouble = trouble or self._follow_tf(now)
        at = now if scan is None or scan.stamp - now > JUMP else max(now, scan.stamp)
        state = self.localization.at(at)
        if state is None:
            unknown = "the pose in the map is not known yet"
            trouble = trouble or self._refusals.get("amcl_pose", unknown)
        if trouble or state is None:
            twist = Twist(0.0, 0.0) if state is None else state.twist
            return RobotState(at, NOWHERE, twist), trouble
        return state, ""

    def _late(self, what: str, topic: str, stamp: float, now: float) -> str:
        """Describe what is wrong with the stamp of data, or why newer data were refused, or ""."""
        late = _late(what, stamp, now, self.settings.data_age)
        return self._refusals.get(topic, late) if late else ""

    def _follow_tf(self, now: float) -> str:
        """Takes the pose of the odometry's frame in the map from tf; what is wrong, or ""."""
        if self.settings.pose_source != "tf":
            return ""
        frame, parent = self._odometry_frame, self.settings.global_frame
        try:
            found = self.transforms.planar(parent, frame)
        except InputError as error:
            return str(error)
        if found is None:
            return f"tf does not say where '{frame:.80}' is in '{parent}'"
        if frame != parent and self.transforms.age(frame, now) > self.settings.pose_age:
            return f"the transform of '{frame}' is {self.transforms.age(frame, now):.2f} s old"
        self.localization.map_to_odom = found.pose
        return ""


def _late(what: str, stamp: float, now: float, age: float) -> str:
    """Describe what is wrong with the stamp of data, or return ""."""
    if not math.isfinite(stamp):
        return f"no {what} has come yet"
    if now - stamp > age:
        return f"the {what} is {now - stamp:.2f} s old"
    if stamp - now > JUMP:
        return f"the {what} is stamped {stamp - now:.2f} s ahead of the clock"
    return ""
