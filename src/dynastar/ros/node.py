"""The navigator as a ROS 2 node: messages in, ``Navigator.command``, messages out."""

import math
from typing import Any

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TwistStamped
from geometry_msgs.msg import Twist as TwistMessage
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Odometry
from nav_msgs.srv import GetPlan
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan as ScanMessage
from std_srvs.srv import Trigger

from dynastar.errors import DynastarError, InputError
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.masks import SpeedScale, with_keepout, with_speed_limits
from dynastar.navigator import Navigator, RobotState
from dynastar.planning import plan
from dynastar.ros.convert import (
    check_frame,
    goal_of,
    grid_of,
    path_message,
    pose_of,
    scan_of,
    seconds,
    stamp_of,
)
from dynastar.ros.localization import Localization
from dynastar.ros.parameters import Parameters
from dynastar.ros.publishing import LATCHED, Publishers
from dynastar.scan import LaserScan

SENSORS = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
JUMP = 0.5  # s by which a clock that goes back, or a stamp ahead of it, is another time
NOWHERE = Pose2D(math.nan, math.nan, math.nan)


class NavigatorNode(Node):  # type: ignore[misc]
    """Drives as ``Navigator.command`` says: at every scan, and by a timer where scans stay away."""

    def __init__(self, **options: Any) -> None:
        super().__init__("dynastar", **options)
        self.parameters = Parameters(self)
        settings = self.parameters.settings
        self.navigator: Navigator | None = None
        self.localization = Localization(settings.pose_source)
        self._shown = Publishers(self, settings.global_frame)
        self._map: GridMessage | None = None
        self._grid: OccupancyGrid | None = None
        self._masks: dict[str, GridMessage] = {}
        self._scan: LaserScan | None = None
        self._taken = False  # whether the newest scan has been given to the navigator
        self._ticked = self._now = -math.inf
        self._refused = ""
        kind = TwistStamped if settings.enable_stamped_cmd_vel else TwistMessage
        self._command = self.create_publisher(kind, "cmd_vel", 1)
        self._subscribe()
        self.create_timer(0.2 * self.parameters.config.period, self._timer)
        self.add_on_set_parameters_callback(self._set_parameters)
        self.get_logger().info(f"{settings.robot}, preset {settings.preset}: waiting for a map")

    def _subscribe(self) -> None:
        self.create_subscription(GridMessage, "map", self._on_map, LATCHED)
        for mask in ("keepout_filter_mask", "speed_filter_mask"):
            take = lambda message, mask=mask: self._on_mask(mask, message)  # noqa: E731
            self.create_subscription(GridMessage, mask, take, LATCHED)
        self.create_subscription(ScanMessage, "scan", self._on_scan, SENSORS)
        self.create_subscription(Odometry, "odom", self._on_odometry, SENSORS)
        self.create_subscription(PoseStamped, "goal_pose", self._on_goal, 1)
        self.create_subscription(PoseWithCovarianceStamped, "amcl_pose", self._on_pose, LATCHED)
        self.create_service(GetPlan, "make_plan", self._make_plan)
        self.create_service(Trigger, "~/cancel", self._cancel)
        self.create_service(Trigger, "~/clear", self._clear)

    # -- what comes in ----------------------------------------------------------------------------

    def _on_map(self, message: GridMessage) -> None:
        self._map = message
        self._take_map()

    def _on_mask(self, mask: str, message: GridMessage) -> None:
        self._masks[mask] = message
        if self._map is not None:
            self._take_map()

    def _take_map(self) -> None:
        """A navigator for the map and the masks, or the present one with another map."""
        settings, frame = self.parameters.settings, self.parameters.settings.global_frame
        assert self._map is not None
        try:
            grid = grid_of(self._map, frame)
            if "keepout_filter_mask" in self._masks:
                grid = with_keepout(grid, grid_of(self._masks["keepout_filter_mask"], frame))
            if "speed_filter_mask" in self._masks:
                scale = SpeedScale(
                    settings.speed_filter_type,
                    settings.speed_filter_base,
                    settings.speed_filter_multiplier,
                )
                mask = grid_of(self._masks["speed_filter_mask"], frame)
                grid = with_speed_limits(grid, mask, self.parameters.robot.limits.v_max, scale)
        except DynastarError as error:
            self._refuse(str(error))
            return
        self._grid = grid
        if self.navigator is None:
            self.navigator = self._new_navigator()
        else:
            self.navigator.set_map(grid)
        self._shown.reset()
        self.get_logger().info(f"map: {grid.columns} x {grid.rows} cells, {grid.extent()}")

    def _on_scan(self, message: ScanMessage) -> None:
        lidar = self.parameters.robot.lidar
        self._scan = scan_of(message, Pose2D(lidar.x, lidar.y, lidar.theta))
        self._taken = False
        self._tick()

    def _on_odometry(self, message: Odometry) -> None:
        twist = message.twist.twist
        try:
            self.localization.add_odometry(
                seconds(message.header.stamp),
                pose_of(message.pose.pose),
                Twist(float(twist.linear.x), float(twist.angular.z)),
            )
        except InputError as error:
            self._refuse(str(error))

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        if self.parameters.settings.pose_source != "amcl":
            return
        try:
            check_frame("the pose", message.header.frame_id, self.parameters.settings.global_frame)
            self.localization.add_pose(seconds(message.header.stamp), pose_of(message.pose.pose))
        except InputError as error:
            self._refuse(str(error))

    def _on_goal(self, message: PoseStamped) -> None:
        """Drives to a goal in place of the present one; one that cannot be is refused, and it goes on."""
        try:
            goal = goal_of(message, self.parameters.settings.global_frame)
            if self.navigator is None:
                raise InputError("there is no map yet")
            self.navigator.planning_map.grid.world_to_cell(goal.x, goal.y)
            self.navigator.set_goal(goal)
        except DynastarError as error:
            self._refuse(f"the goal is refused: {error}")

    def _refuse(self, words: str) -> None:
        self._refused = words
        self.get_logger().warning(words, throttle_duration_sec=1.0)

    # -- the loop ---------------------------------------------------------------------------------

    def _timer(self) -> None:
        """Ticks if no scan has come for a little over a period."""
        now = self._time()
        if now - self._ticked > 1.2 * self.parameters.config.period:
            self._tick()

    def _time(self) -> float:
        """The clock in seconds; a clock that went back starts everything anew, without a goal."""
        now = self.get_clock().now().nanoseconds * 1e-9
        if now < self._now - JUMP:
            self._restart("the clock went back")
        self._now = now
        return now

    def _restart(self, reason: str) -> None:
        self.localization.reset()
        self._shown.reset()
        self._scan, self._ticked = None, -math.inf
        if self.navigator is not None:
            self.navigator = self._new_navigator()
        self._refuse(reason)

    def _new_navigator(self) -> Navigator:
        assert self._grid is not None
        return Navigator(self._grid, self.parameters.robot, self.parameters.config)

    def _tick(self) -> None:
        now = self._time()
        self._ticked = now
        if self.navigator is None:
            self._send(Twist(0.0, 0.0), now)
            self._shown.say("idle", self._refused or "no map has come yet", {}, now)
            return
        state, trouble = self._state(now)
        scan = None if self._taken else self._scan
        self._taken = True
        command = self.navigator.command(state, scan)
        self._send(command, now)
        status = self.navigator.status
        self._shown.show(self.navigator, status, state, now)
        values = {
            "v": f"{command.v:.3f} m/s",
            "omega": f"{command.omega:.3f} rad/s",
            "limited by": status.limited_by,
            "goals left": status.goals_left,
            "replans": status.replans,
            "refused": self._refused,
        }
        self._shown.say(status.state, trouble or status.reason, values, now)

    def _state(self, now: float) -> tuple[RobotState, str]:
        """The state now, and what is wrong with odometry, scan or pose: then a state that stops."""
        age = self.parameters.settings.data_age
        stamp = self.localization.stamp
        trouble = ""
        if not math.isfinite(stamp):
            trouble = "no odometry has come yet"
        elif now - stamp > age:
            trouble = f"the odometry is {now - stamp:.2f} s old"
        elif stamp - now > JUMP:
            trouble = f"the odometry is stamped {stamp - now:.2f} s ahead of the clock"
        elif self._scan is None:
            trouble = "no scan has come yet"
        elif now - self._scan.stamp > age:
            trouble = f"the scan is {now - self._scan.stamp:.2f} s old"
        elif self._scan.stamp - now > JUMP:
            trouble = f"the scan is stamped {self._scan.stamp - now:.2f} s ahead of the clock"
        at = max(now, self._scan.stamp if self._scan is not None else now)
        state = self.localization.at(at)
        if state is None:
            trouble = trouble or "the pose in the map is not known yet"
        if trouble or state is None:
            twist = Twist(0.0, 0.0) if state is None else state.twist
            return RobotState(at, NOWHERE, twist), trouble
        return state, ""

    def _send(self, command: Twist, now: float) -> None:
        stamped = self.parameters.settings.enable_stamped_cmd_vel
        message = TwistStamped() if stamped else TwistMessage()
        twist = message.twist if stamped else message
        twist.linear.x, twist.angular.z = float(command.v), float(command.omega)
        if stamped:
            message.header.stamp = stamp_of(now)
            message.header.frame_id = self.parameters.settings.base_frame
        self._command.publish(message)

    def stop(self) -> None:
        """The last word: zero."""
        self._send(Twist(0.0, 0.0), self._now if math.isfinite(self._now) else 0.0)

    # -- services and parameters ------------------------------------------------------------------

    def _make_plan(self, request: GetPlan.Request, response: GetPlan.Response) -> GetPlan.Response:
        """A path on the map as it is known, for the robot's disc; empty, with a word, if there is none."""
        frame = self.parameters.settings.global_frame
        try:
            if self._grid is None:
                raise InputError("there is no map yet")
            start, goal = goal_of(request.start, frame), goal_of(request.goal, frame)
            found = plan(
                self._grid,
                (start.x, start.y),
                (goal.x, goal.y),
                radius=self.parameters.robot.footprint.circumscribed,
                unknown=self.parameters.config.unknown,
            )
            response.plan = path_message(found.path.points, frame, self._now)
        except DynastarError as error:
            self._refuse(f"no plan: {error}")
        return response

    def _cancel(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        del request
        response.success = self.navigator is not None
        response.message = "the goal is dropped" if response.success else "there is no map yet"
        if self.navigator is not None:
            self.navigator.cancel()
        return response

    def _clear(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        del request
        response.success = self.navigator is not None
        response.message = "forgot what was sensed" if response.success else "there is no map yet"
        if self.navigator is not None:
            self.navigator.planning_map.forget()
            self.navigator.sensing.local_map.forget()
        return response

    def _set_parameters(self, changes: list[Parameter]) -> SetParametersResult:
        """Takes in changed settings while running; refuses with the reason."""
        fixed = [change.name for change in changes if not self.parameters.is_setting(change.name)]
        fixed = [name for name in fixed if name != "use_sim_time"]
        if fixed:
            return SetParametersResult(
                successful=False,
                reason=f"{fixed[0]} is read at the start only: start the node anew",
            )
        values = {change.name: change.value for change in changes if change.name != "use_sim_time"}
        try:
            config = self.parameters.changed(values)
        except DynastarError as error:
            return SetParametersResult(successful=False, reason=str(error))
        self.parameters.config = config
        if self.navigator is not None and values:
            goals = self.navigator.mission.goals
            self.navigator = self._new_navigator()
            self.navigator.set_goal(goals)
        return SetParametersResult(successful=True)
