"""The navigator as a ROS 2 node: its subscriptions, publishers, services and parameters."""

import math
import time
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from nav_msgs.srv import GetPlan
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.parameter import Parameter
from rclpy.serialization import serialize_message
from std_srvs.srv import Trigger

from dynastar.errors import DynastarError, InputError
from dynastar.geometry import Goal
from dynastar.planning import plan
from dynastar.ros.bag import BagWriter
from dynastar.ros.bridge import REQUESTS, TAKES, Bridge, Tick, start_request
from dynastar.ros.driving_node import DrivingNode
from dynastar.ros.incoming import goal_of
from dynastar.ros.middleware import make
from dynastar.ros.publishing import PUBLISHES, StatusPublisher
from dynastar.ros.settings import flat, nested

LATE = 1.2  # periods after a command, from which on the next does not wait for a scan


class NavigatorNode(DrivingNode):
    """Drives as ``Navigator.command`` says: at every scan, and by a timer where scans stay away."""

    bridge: Bridge

    def __init__(self, **options: Any) -> None:
        super().__init__("dynastar", PUBLISHES, **options)
        settings = self.parameters.settings
        self.bridge = Bridge(settings, self.parameters.robot, self.parameters.config)
        self._bag = BagWriter(Path(settings.bag), aside=False) if settings.bag else None
        self._ticked, self._state = -math.inf, ""
        self._kinds |= TAKES
        self._status = StatusPublisher(
            self._out,
            settings.global_frame,
            f"{self.get_name()}: navigation",
            self._publish,
            self._wanted,
        )
        robot, config = self.parameters.robot, self.parameters.config
        self._note_request(start_request(settings, robot, config))
        self._subscribe(TAKES)
        self._actions = self._serve()
        # The steady clock goes on when a simulator's clock does not.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        late = LATE * self.parameters.config.period
        self._watchdog = self.create_timer(late, self._tick, clock=steady)
        self.add_on_set_parameters_callback(self._set_parameters)
        self.get_logger().info(f"{settings.robot}, preset {settings.preset}: waiting for a map")

    def _serve(self) -> Any:
        """The services, and Nav2's actions where their types are installed; those, or None."""
        self.create_service(GetPlan, "make_plan", self._make_plan)
        self.create_service(Trigger, "~/cancel", self._cancel)
        self.create_service(Trigger, "~/clear", self._clear)
        try:
            types = import_module("nav2_msgs.action")
        except ImportError:
            self.get_logger().info("without NavigateToPose: nav2_msgs is not installed")
            return None
        from dynastar.ros.actions import ACTIONS, Actions

        found = {name: getattr(types, kind.split("/")[-1], None) for name, kind in ACTIONS.items()}
        kinds = {name: kind for name, kind in found.items() if kind is not None}
        frame = self.parameters.settings.global_frame
        return Actions(self, kinds, frame, self._out, self._request)

    # -- what comes in ----------------------------------------------------------------------------

    def _take(self, topic: str, message: Any) -> None:
        self._record(topic, message, self._time())
        words = self.bridge.take(topic, message)
        if words and topic == "goal_pose":
            self.get_logger().warning(words, throttle_duration_sec=0.1)
        elif words:
            self.get_logger().warning(words, throttle_duration_sec=1.0)
        elif topic == "map":
            grid = self.bridge.grid
            assert grid is not None
            self._status.reset()
            self.get_logger().info(f"map: {grid.columns} x {grid.rows} cells, {grid.extent()}")
        elif topic == "goal_pose":
            self._log_goals([goal_of(message, self.parameters.settings.global_frame)])
            if self._actions is not None:
                self._actions.replaced()
        if topic == "scan":
            self._tick()

    def _request(self, **wanted: Any) -> None:
        """Carries out a request of a service, an action or a parameter, and records it."""
        self._note_request(self.bridge.request(**wanted))
        if "goals" in wanted:
            self._log_goals(wanted["goals"])
        elif "follow" in wanted:
            self.get_logger().info(f"path of {len(wanted['follow'][0])} poses")

    def _note_request(self, words: str) -> None:
        if self._bag is not None:
            message = make("std_msgs/msg/String", data=words)
            self._write(REQUESTS, "std_msgs/msg/String", message, self._clock_time())

    # -- the loop ---------------------------------------------------------------------------------

    def _restart(self) -> None:
        if self._bag is not None:
            self.get_logger().warning("the clock went back: the recording ends here")
            self._end_recording()
        self._request(restart="the clock went back")
        self._status.reset()
        self._ticked = -math.inf
        self.get_logger().warning("the clock went back: the goal is dropped")

    def _tick(self) -> None:
        """A command: at every scan, and a little over a period after the last one where none comes."""
        now = self._ticked = self._time()
        self._watchdog.reset()
        self._check_clock(now)
        tick = self.bridge.tick(now)
        self._send(tick.command, now)
        if tick.status is not None and self.bridge.navigator is not None:
            self._status.show(self.bridge.navigator, tick.status, tick.robot, now)
        values = self.bridge.values(tick)
        self._status.say(tick.state, tick.reason, values, now, time.monotonic())
        self._log(tick)
        if self._actions is not None:
            self._actions.update(tick, now)

    def _log(self, tick: Tick) -> None:
        """Log how a mission ends, and when and why sensor data are lost."""
        before, self._state = self._state, tick.state
        if tick.state == before:
            return
        if tick.state == "arrived":
            self.get_logger().info(f"arrived: {tick.reason}")
        elif tick.state in ("blocked", "sensor_lost"):
            self.get_logger().warning(f"{tick.state}: {tick.reason}")
        elif before == "sensor_lost":
            self.get_logger().info(f"sensor data are back: {tick.state}, {tick.reason}")

    def _log_goals(self, goals: Sequence[Goal]) -> None:
        words = ", ".join(
            f"({x:.2f}, {y:.2f})" + ("" if heading is None else f" heading {heading:.2f} rad")
            for x, y, heading in goals
        )
        self.get_logger().info(f"{'goal' if len(goals) == 1 else 'goals'} {words}")

    def stop(self) -> None:
        """Stops the robot; the recording ends before, for no tick belongs to this command."""
        try:
            self._end_recording()
        finally:
            super().stop()

    # -- what goes out ----------------------------------------------------------------------------

    def _publish(self, topic: str, message: Any) -> None:
        self._emit(topic, message, self._ticked)

    def _emit(self, topic: str, message: Any, now: float) -> None:
        super()._emit(topic, message, now)  # first: a command does not wait for the disk
        self._record(topic, message, now)

    def _wanted(self, topic: str) -> bool:
        return self._bag is not None or super()._wanted(topic)

    def _record(self, topic: str, message: Any, now: float) -> None:
        if self._bag is not None:
            self._write(topic, self._kinds[topic], message, now)

    def _write(self, topic: str, kind: str, message: Any, now: float) -> None:
        """Writes to the recording; one that cannot be written ends, and the robot drives on."""
        assert self._bag is not None
        try:
            name = self.resolve_topic_name(topic)
            self._bag.write_cdr(name, kind, now, serialize_message(message))
        except OSError as error:
            self.get_logger().error(f"the recording ends here: {error}")
            self._end_recording()

    def _end_recording(self) -> None:
        bag, self._bag = self._bag, None
        if bag is not None:
            try:
                bag.close()
            except OSError as error:
                self.get_logger().error(f"the recording was not closed: {error}")

    # -- services and parameters ------------------------------------------------------------------

    def _make_plan(self, request: GetPlan.Request, response: GetPlan.Response) -> GetPlan.Response:
        """A path on the map as it is known, for the robot's disc; empty, with a word, if there is none."""
        frame, grid = self.parameters.settings.global_frame, self.bridge.grid
        try:
            if grid is None:
                raise InputError("there is no map yet")
            start, goal = goal_of(request.start, frame), goal_of(request.goal, frame)
            found = plan(
                grid,
                (start.x, start.y),
                (goal.x, goal.y),
                radius=self.parameters.robot.footprint.circumscribed,
                unknown=self.parameters.config.unknown,
                tolerance=float(request.tolerance),
            )
            response.plan = self._out.path(found.path.points, frame, self._clock_time())
        except DynastarError as error:
            self.get_logger().warning(f"no plan: {error}")
        return response

    def _cancel(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        del request
        return self._answer(response, "the goal is dropped", cancel=True)

    def _clear(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        del request
        return self._answer(response, "forgot what was sensed", clear=True)

    def _answer(self, response: Any, done: str, **wanted: Any) -> Any:
        try:
            self._request(**wanted)
            response.success, response.message = True, done
        except DynastarError as error:
            response.success, response.message = False, str(error)
        return response

    def _set_parameters(self, changes: list[Parameter]) -> SetParametersResult:
        """Takes in changed settings while running; refuses with the reason."""
        values = {change.name: change.value for change in changes if change.name != "use_sim_time"}
        fixed = [name for name in values if not self.parameters.is_setting(name)]
        if fixed:
            reason = f"{fixed[0]} is read at the start only: start the node anew"
            return SetParametersResult(successful=False, reason=reason)
        try:
            config = self.parameters.changed(values)
            if values:
                self._request(settings=nested(flat(config)))
        except DynastarError as error:
            return SetParametersResult(successful=False, reason=str(error))
        self.parameters.config = config
        self._status.reset()  # a new navigator counts its plans anew
        self._watchdog.timer_period_ns = round(1e9 * LATE * config.period)
        return SetParametersResult(successful=True)
