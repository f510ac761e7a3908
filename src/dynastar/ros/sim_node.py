"""The simulator as a ROS 2 node: publishes map, scan and odometry of a scenario, takes cmd_vel."""

import math
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist as TwistMessage
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan as ScanMessage
from std_msgs.msg import String

from dynastar.geometry import Twist
from dynastar.ros.convert import grid_message, rotation_of, scan_message, stamp_of
from dynastar.ros.publishing import LATCHED
from dynastar.simulation import Scenario, World
from dynastar.simulation.run import start_pose

TIMEOUT = 0.5  # s without a command after which the drive stops, as the robots' own do


class SimulatorNode(Node):  # type: ignore[misc]
    """Runs a scenario in real time, or ``speed`` times as fast, with /clock if asked."""

    def __init__(self, scenario: Scenario, **options: Any) -> None:
        super().__init__("dynastar_sim", **options)
        self.period = float(self.declare_parameter("period", 0.05).value)
        self.publish_clock = bool(self.declare_parameter("publish_clock", False).value)
        self.stamped = bool(self.declare_parameter("enable_stamped_cmd_vel", False).value)
        for name in ("publish_scan", "publish_odom"):  # false is a fault to try
            self.declare_parameter(name, True)
        self.scenario = scenario
        self.world = World(scenario, start_pose(scenario), scenario.seed)
        self.contacts = 0
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
        self._map.publish(grid_message(grid.values, grid.frame, "map", self._stamp()))
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
            self._clock_out.publish(Clock(clock=stamp_of(stamp)))
        pose = world.sensed_pose()
        odometry = Odometry()
        odometry.header.stamp, odometry.header.frame_id = stamp_of(stamp), "odom"
        odometry.child_frame_id = "base_link"
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = pose.x, pose.y
        odometry.pose.pose.orientation = rotation_of(pose.theta)
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = map(float, world.twist)
        if self.get_parameter("publish_odom").value:
            self._odometry.publish(odometry)
        if not self.get_parameter("publish_scan").value:
            return
        scan = scan_message(world.scan(), "laser")
        scan.header.stamp = odometry.header.stamp
        self._scan.publish(scan)


def as_parameters(scenario: Scenario) -> dict[str, Any]:
    """The parameters of a navigator node that drives this scenario's robot with its errors."""
    from dynastar.simulation.run import effective_config

    config = effective_config(scenario)
    names = "latency", "range_error", "pose_error", "heading_error", "goal_tolerance", "unknown"
    found = {name: getattr(config, name) for name in names}
    footprint = scenario.robot.footprint
    if not footprint.is_disc:
        found["polygon"] = np.asarray(footprint.vertices).reshape(-1).tolist()
    return {"robot": scenario.robot.name, "period": 0.05, **found}
