"""The guard as a ROS 2 node: between another controller's cmd_vel_in and the robot's cmd_vel."""

import math
import time
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.parameter import Parameter

from dynastar.config import checked
from dynastar.ros.driving_node import DrivingNode
from dynastar.ros.guard_bridge import GuardBridge
from dynastar.ros.intake import SENSED
from dynastar.ros.markers import Markers
from dynastar.ros.parameters import Parameters, declare
from dynastar.ros.publishing import EVERY, PUBLISHES, StatusPublisher
from dynastar.ros.settings import GuardSettings, fields_of

PERIOD = 0.02  # s between two commands, unless the parameter says otherwise
MAPS = ("map", "keepout_filter_mask", "speed_filter_mask")


class GuardNode(DrivingNode):
    """Publishes what ``Guard.filter`` makes of the last command, every period."""

    bridge: GuardBridge

    def __init__(self, **options: Any) -> None:
        published = {topic: PUBLISHES[topic] for topic in ("markers", "/diagnostics")}
        super().__init__("dynastar_guard", published, **options)
        own = {
            name: declare(self, name, field, GuardSettings._field_defaults[name])
            for name, field in fields_of(GuardSettings).items()
        }
        settings, config = self.parameters.settings, self.parameters.config
        guard = checked(GuardSettings, own)
        self.bridge = GuardBridge(settings, self.parameters.robot, config, guard)
        self._drawn = -math.inf
        self._status = StatusPublisher(
            self._out,
            settings.global_frame,
            f"{self.get_name()}: guard",
            self._publish,
            self._wanted,
        )
        topics = {
            topic: kind for topic, kind in SENSED.items() if topic not in MAPS or guard.use_map
        }
        self._subscribe({**topics, "cmd_vel_in": self._twist_kind})
        self.add_on_set_parameters_callback(self._refuse)
        # The steady clock goes on when a simulator's clock does not.
        self.create_timer(config.period, self._tick, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.get_logger().info(f"{settings.robot}: guards cmd_vel_in")

    def read_parameters(self) -> Parameters:
        """Those of the navigator's node but for the recording, every 20 ms."""
        return Parameters(self, left_out=("bag",), period=PERIOD)

    def _refuse(self, changes: list[Parameter]) -> SetParametersResult:
        """Refuses to change parameters while running."""
        fixed = [change.name for change in changes if change.name != "use_sim_time"]
        reason = f"{fixed[0]} is read at the start only: start the node anew" if fixed else ""
        return SetParametersResult(successful=not fixed, reason=reason)

    def _take(self, topic: str, message: Any) -> None:
        now = self._time()
        if topic == "cmd_vel_in":
            self.bridge.ask(message, now)
            return
        words = self.bridge.take(topic, message)
        if words:
            self.get_logger().warning(words, throttle_duration_sec=1.0)

    def _request(self, **wanted: Any) -> None:
        self.bridge.request(**wanted)

    def _restart(self) -> None:
        self._request(restart="the clock went back")
        self._drawn = -math.inf
        self._status.reset()
        self.get_logger().warning("the clock went back: what was sensed is forgotten")

    def _tick(self) -> None:
        now = self._time()
        self._check_clock(now)
        tick = self.bridge.tick(now)
        command = tick.guarded.command
        self._send(command, now)
        values = {
            "v": f"{command.v:.3f} m/s",
            "omega": f"{command.omega:.3f} rad/s",
            "changed": tick.guarded.reason,
            "refused": self.bridge.refused,
        }
        self._status.say(tick.state, tick.reason, values, now, time.monotonic())
        if now >= self._drawn + EVERY and self._wanted("markers"):
            self._drawn = now
            held_back, footprint = tick.state != "passing", self.parameters.robot.footprint
            markers = Markers(self._out, self.bridge.frame)
            stop = markers.stop(footprint, self.bridge.guard.stop, held_back, now)
            self._publish("markers", stop)

    def _publish(self, topic: str, message: Any) -> None:
        self._emit(topic, message, 0.0)
