"""A client of the nodes, and the nodes as processes, apart from all other ROS on this machine."""

import math
import os
import random
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="no rclpy here: `make test-ros` has an environment with it")

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_DOMAIN_ID"] = str(  # two groups of tests run side by side
    2 * random.Random().randint(1, 49) + int(os.environ.get("ROS_TEST_GROUP", "0"))
)
os.environ.setdefault("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # of lark, about modules of re
    import rosidl_generator_py  # noqa: F401
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from nav_msgs.msg import Path as PathMessage
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from dynastar.geometry import Pose2D
from dynastar.geometry import Twist as DynastarTwist
from dynastar.ros.driving_node import LATCHED
from dynastar.ros.middleware import make
from dynastar.ros.outgoing import Messages
from dynastar.scan import LaserScan as DynastarScan

EXAMPLES = Path(__file__).parents[3] / "examples"
OFFICE = EXAMPLES / "office" / "office.toml"


class Client:
    """What a person at a console sees and sends; everything that comes has its time of arrival."""

    def __init__(self) -> None:
        self.node = Node("client")
        self.commands: list[tuple[float, float, float]] = []
        self.diagnostics: list[tuple[float, str]] = []
        self.plans: list[PathMessage] = []
        self.contacts: list[str] = []
        self.latencies: list[float] = []
        self.odometry: Odometry | None = None
        self._scan = 0.0
        take = self.node.create_subscription
        take(LaserScan, "scan", self._on_scan, 10)
        take(Twist, "cmd_vel", self._on_command, 10)
        take(Odometry, "odom", lambda message: setattr(self, "odometry", message), 10)
        take(PathMessage, "plan", self.plans.append, LATCHED)
        take(String, "contact", lambda message: self.contacts.append(message.data), LATCHED)
        take(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)
        self.goals = self.node.create_publisher(PoseStamped, "goal_pose", 1)
        self.maps = self.node.create_publisher(OccupancyGrid, "map", LATCHED)

    @property
    def state(self) -> str:
        return self.diagnostics[-1][1] if self.diagnostics else ""

    @property
    def place(self) -> tuple[float, float]:
        assert self.odometry is not None
        position = self.odometry.pose.pose.position
        return position.x, position.y

    def spin(self, seconds: float, until=lambda: False) -> bool:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.02)
            if until():
                return True
        return False

    def wait_for(self, words: str, seconds: float = 60.0) -> None:
        assert self.spin(seconds, lambda: words in self.state), f"{words}: not in {self.state}"

    def send(self, x: float, y: float, frame: str = "map") -> None:
        """Sends a goal once, as `ros2 topic pub --once` does: to a subscription that is known."""
        matched = self.goals.get_subscription_count
        assert matched() or self.spin(10.0, matched), "nobody takes goals"
        goal = PoseStamped()
        goal.header.frame_id = frame
        goal.pose.position.x, goal.pose.position.y, goal.pose.orientation.w = x, y, 1.0
        self.goals.publish(goal)

    def set_off(self, x: float, y: float) -> None:
        """Sends a goal each second until it drives: one sent before both sides match is lost."""
        for _ in range(20):
            self.send(x, y)
            if self.spin(1.0, self.drives):
                return
        raise AssertionError(f"it does not drive: {self.state}, {self.commands[-3:]}")

    def call(self, kind, name: str, request):
        client = self.node.create_client(kind, name)
        assert client.wait_for_service(timeout_sec=10.0), name
        future = client.call_async(request)
        assert self.spin(20.0, future.done), name
        return future.result()

    def set_parameter(self, node: str, name: str, **value):
        request = SetParameters.Request()
        request.parameters = [Parameter(name=name, value=ParameterValue(**value))]
        return self.call(SetParameters, f"{node}/set_parameters", request).results[0]

    def drives(self) -> bool:
        return bool(self.commands) and abs(self.commands[-1][1]) > 0.15

    def _on_scan(self, message: LaserScan) -> None:
        self._scan = time.monotonic()

    def _on_command(self, message: Twist) -> None:
        now = time.monotonic()
        self.latencies.append(now - self._scan)
        self.commands.append((now, message.linear.x, message.angular.z))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self.diagnostics.append((time.monotonic(), message.status[0].message))


class Processes:
    """Nodes started by their commands; whatever still runs at the end is ended."""

    def __init__(self) -> None:
        self.running: list[subprocess.Popen] = []

    def start(self, *words: object, **options) -> subprocess.Popen:
        env = {k: v for k, v in os.environ.items() if k != "_ROS_WHEELS_BOOTSTRAP_COMPLETE"}
        command = [sys.executable, "-m", "dynastar", *map(str, words)]
        process = subprocess.Popen(command, env=env, **options)
        self.running.append(process)
        return process

    def end(self) -> None:
        for process in self.running:
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.kill()
            process.wait()


@pytest.fixture
def processes():
    nodes = Processes()
    yield nodes
    nodes.end()


@pytest.fixture
def client():
    rclpy.init()
    made = Client()
    yield made
    made.node.destroy_node()
    rclpy.shutdown()


@pytest.fixture
def office(client, processes):
    """The office with its unmapped boxes and walkers, and the navigator in it, ready for a goal."""
    client.simulator = processes.start("ros-sim", OFFICE)
    client.navigator = processes.start(
        "ros", "--scenario", OFFICE, "--ros-args", "-p", "latency:=0.1"
    )
    client.wait_for("no goal")
    return client


class Room:
    """A simulator of a test's own making: an empty room, a clock that does what is asked."""

    def __init__(self, client) -> None:
        self.node, self.out, self.time, self.x = client.node, Messages(make), 10.0, 2.0
        self.each = lambda: None
        publish = self.node.create_publisher
        self.clock = publish(Clock, "/clock", 1)
        self.scans, self.odometry = publish(LaserScan, "scan", 5), publish(Odometry, "odom", 5)
        values = np.zeros((100, 100), np.int8)
        values[[0, -1]] = values[:, [0, -1]] = 100
        client.maps.publish(self.out.grid(values, (0.05, 0.0, 0.0), "map", 0.0))

    def run(self, client, seconds: float, runs: bool = True, data: bool = True) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if runs:
                self.time += 0.05
            v = client.commands[-1][1] if client.commands else 0.0
            self.x += 0.05 * v
            self.clock.publish(Clock(clock=self.out.stamp(self.time)))
            self.each()
            if data:
                pose, frames = Pose2D(self.x, 2.5, 0.0), ("odom", "base_link")
                self.odometry.publish(
                    self.out.odometry(pose, DynastarTwist(v, 0.0), frames, self.time)
                )
                ranges = np.full(360, np.inf, np.float32)
                scan = DynastarScan(self.time, ranges, 0.0, math.tau / 360, 0.12, 3.5)
                self.scans.publish(self.out.scan(scan, "laser"))
            client.spin(0.05)


@pytest.fixture
def room_of(client, processes):
    """Starts a node with parameters in an empty room, 5 m square, with a clock of its own."""

    def made(*words: str) -> Room:
        client.navigator = processes.start("ros", "--ros-args", "-p", "use_sim_time:=true", *words)
        client.wait_for("idle")
        return Room(client)

    return made
