"""What the nodes that command a robot share: topics, the clock, the command and its last word."""

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from dynastar.errors import InputError
from dynastar.geometry import Twist
from dynastar.ros.intake import Intake
from dynastar.ros.middleware import make, message_class
from dynastar.ros.outgoing import Messages
from dynastar.ros.parameters import Parameters

FAREWELL = 0.5  # s to hand the last message to the middleware
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SENSORS = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
FRAMES = QoSProfile(depth=100)
FRAMES_FIXED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
QUALITY = {"/tf": FRAMES, "/tf_static": FRAMES_FIXED, "/diagnostics": QoSProfile(depth=10)}
QUALITY |= {"scan": SENSORS, "odom": SENSORS, "cmd_vel_in": SENSORS}
LATCHES = ("map", "keepout_filter_mask", "speed_filter_mask", "amcl_pose", "plan")


def quality(topic: str) -> QoSProfile:
    """The quality of service that ROS 2 uses for a topic."""
    return LATCHED if topic in LATCHES else QUALITY.get(topic, QoSProfile(depth=1))


class DrivingNode(Node, ABC):  # type: ignore[misc]
    """A node with ``parameters`` that feeds a ``bridge`` and publishes cmd_vel, zero at its end."""

    bridge: Intake

    def __init__(self, name: str, publishes: Mapping[str, str], **options: Any) -> None:
        super().__init__(name, **options)
        self.parameters = self.read_parameters()
        self._out = Messages(make)
        self._clock_read, self._clock_moved = -math.inf, time.monotonic()
        self._kinds = {**publishes, "cmd_vel": self._twist_kind}
        self._outlets = {
            topic: self.create_publisher(message_class(kind), topic, quality(topic))
            for topic, kind in self._kinds.items()
        }

    def read_parameters(self) -> Parameters:
        """Declares and reads the node's parameters."""
        return Parameters(self)

    @property
    def _twist_kind(self) -> str:
        twist = "TwistStamped" if self.parameters.settings.enable_stamped_cmd_vel else "Twist"
        return f"geometry_msgs/msg/{twist}"

    def _subscribe(self, topics: Mapping[str, str]) -> None:
        """Hands each message of the topics, with their types, to ``_take``."""
        for topic, kind in topics.items():
            if message_class(kind) is not None:  # tf2_msgs is not always installed
                take = lambda message, topic=topic: self._take(topic, message)  # noqa: E731
                self.create_subscription(message_class(kind), topic, take, quality(topic))
            elif self.parameters.settings.pose_source == "tf":
                raise InputError("'pose_source' is tf, which needs the package tf2_msgs")

    @abstractmethod
    def _take(self, topic: str, message: Any) -> None:
        """Takes in a message of a topic."""

    @abstractmethod
    def _request(self, **wanted: Any) -> None:
        """Carries out a request by name, as the bridge's ``request``."""

    def _check_clock(self, now: float) -> None:
        """Notes whether the clock goes on, by the steady clock."""
        steady = time.monotonic()
        if now != self._clock_read:
            self._clock_read, self._clock_moved = now, steady
            if self.bridge.fault:
                self._request(fault="")
            return
        age = self.parameters.settings.data_age
        if not self.bridge.fault and steady - self._clock_moved > age:
            self._request(fault="the clock stands still")

    def _clock_time(self) -> float:
        """The clock in seconds, to the microsecond, as recordings have it."""
        return 1e-6 * (self.get_clock().now().nanoseconds // 1000)

    def _time(self) -> float:
        """The clock in seconds; one that went back starts everything anew."""
        now = self._clock_time()
        if self.bridge.jumped(now):
            self._restart()
        return now

    @abstractmethod
    def _restart(self) -> None:
        """Starts anew, as time has jumped."""

    def _send(self, command: Twist, now: float) -> None:
        if self.parameters.settings.enable_stamped_cmd_vel:
            message = self._out.twist_stamped(command, self.parameters.settings.base_frame, now)
        else:
            message = self._out.twist(command)
        self._emit("cmd_vel", message, now)

    def _emit(self, topic: str, message: Any, now: float) -> None:
        """Publishes a message at a time (s)."""
        del now
        self._outlets[topic].publish(message)

    def _wanted(self, topic: str) -> bool:
        return bool(self._outlets[topic].get_subscription_count() > 0)

    def stop(self) -> None:
        """Commands zero, and waits until the middleware has the message."""
        self._send(Twist(0.0, 0.0), self._clock_time())
        self._outlets["cmd_vel"].wait_for_all_acked(Duration(seconds=FAREWELL))
