"""The simulator as a ROS 2 node: publishes map, scan and odometry of a scenario, takes cmd_vel."""

import math
from dataclasses import replace
from typing import Any

from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan as ScanMessage
from std_msgs.msg import String

from dynastar.geometry import Pose2D, Twist
from dynastar.ros.driving_node import FRAMES, FRAMES_FIXED, LATCHED
from dynastar.ros.middleware import make, message_class
from dynastar.ros.outgoing import Messages
from dynastar.ros.settings import SIMULATED_PERIOD
from dynastar.simulation import Scenario, World
from dynastar.simulation.start import check_start

ORIGIN = Pose2D(0.0, 0.0, 0.0)  # of odom in map: the simulated odometry does not drift
TIMEOUT = 0.5  # s without a command after which the drive stops, as the robots' own do


class SimulatorNode(Node):  # type: ignore[misc]
    """Runs a scenario in real time; with the parameter publish_clock it is the clock."""

    def __init__(self, scenario: Scenario, **options: Any) -> None:
        check_start(scenario)
        super().__init__("dynastar_sim", **options)
        self.period = float(self.declare_parameter("period", SIMULATED_PERIOD).value)
        self.publish_clock = bool(self.declare_parameter("publish_clock", False).value)
        self.stamped = bool(self.declare_parameter("enable_stamped_cmd_vel", False).value)
        for name in ("publish_scan", "publish_odom"):  # false is a fault to try
            self.declare_parameter(name, True)
        self.scenario = scenario
        self.world = World(scenario)
        self.contacts, self._out = 0, Messages(make)
        self._command, self._heard = Twist(0.0, 0.0), -math.inf
        self._map = self.create_publisher(GridMessage, "map", LATCHED)
        self._scan = self.create_publisher(ScanMessage, "scan", QoSProfile(depth=5))
        self._odometry = self.create_publisher(Odometry, "odom", QoSProfile(depth=5))
        self._contact = self.create_publisher(String, "contact", LATCHED)
        self._clock_out = self.create_publisher(Clock, "/clock", 1) if self.publish_clock else None
        if self.stamped:
            self.create_subscription(
                TwistStamped, "cmd_vel", lambda m: self._on_command(m.twist), 1
            )
        else:
            self.create_subscription(TwistMessage, "cmd_vel", self._on_command, 1)
        grid = scenario.grid
        self._map.publish(self._out.grid(grid.values, grid.frame, "map", self._stamp()))
        self._transforms = self._publish_frames()
        self.create_timer(self.period, self._step)
        self.get_logger().info(f"{scenario.name}: {scenario.robot.name}, {grid.extent()}")

    def _wall(self) -> float:
        return float(self.get_clock().now().nanoseconds) * 1e-9

    def _stamp(self) -> float:
        """The present time: of the world if this node is the clock, else of the node's clock."""
        return self.world.time if self.publish_clock else self._wall()

    def _on_command(self, message: TwistMessage) -> None:
        v, omega = float(message.linear.x), float(message.angular.z)
        if not (math.isfinite(v) and math.isfinite(omega)):
            self.get_logger().error(
                f"a command is ({v}, {omega}): left out", throttle_duration_sec=1.0
            )
            return
        self._command, self._heard = Twist(v, omega), self.world.time

    def _step(self) -> None:
        """Lets a period pass and publishes what is sensed then."""
        world = self.world
        fresh = world.time - self._heard <= TIMEOUT
        world.step(self._command if fresh else Twist(0.0, 0.0), self.period)
        if world.contact and not self.contacts:
            self.contacts = 1
            self._contact.publish(String(data=world.contact))
            self.get_logger().error(f"contact, {world.contact}, at {world.time:.2f} s")
        stamp = self._stamp()
        if self._clock_out is not None:
            self._clock_out.publish(Clock(clock=self._out.stamp(stamp)))
        state = world.sensed_state()
        if self.get_parameter("publish_odom").value:
            frames = ("odom", "base_link")
            self._odometry.publish(self._out.odometry(state.pose, state.twist, frames, stamp))
            if self._transforms is not None:
                carried = [("map", "odom", ORIGIN), ("odom", "base_link", state.pose)]
                self._transforms.publish(self._out.transforms(carried, stamp))
        if self.get_parameter("publish_scan").value:
            self._scan.publish(self._out.scan(replace(world.scan(), stamp=stamp), "laser"))

    def _publish_frames(self) -> Any:
        """Publishes where the lidar is; the publisher of the other frames, None without tf2_msgs."""
        kind = message_class("tf2_msgs/msg/TFMessage")
        if kind is None:
            return None
        self._fixed = self.create_publisher(kind, "/tf_static", FRAMES_FIXED)
        mount = ("base_link", "laser", self.scenario.robot.lidar.mount)
        self._fixed.publish(self._out.transforms([mount], self._stamp()))
        return self.create_publisher(kind, "/tf", FRAMES)
