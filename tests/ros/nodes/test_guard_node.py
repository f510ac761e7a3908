"""The guard as a process over the real middleware, in the simulated office."""

import math
import signal
import time
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from visualization_msgs.msg import MarkerArray

OFFICE = Path(__file__).parents[3] / "examples" / "office" / "office.toml"


class Joystick:
    """Sends the same command to the guard at 20 Hz, and keeps the markers that come."""

    def __init__(self, client) -> None:
        self.client, self.markers = client, []
        self.out = client.node.create_publisher(Twist, "cmd_vel_in", 1)
        client.node.create_subscription(MarkerArray, "markers", self.markers.append, 1)

    def rests(self, reason: str) -> bool:
        """Whether the last command is 0 and the state names a reason: they come one after the other."""
        return self.client.commands[-1][1] == 0.0 and reason in self.client.state

    def hold(self, v: float, omega: float, seconds: float, until=lambda: False) -> bool:
        message = Twist()
        message.linear.x, message.angular.z = v, omega
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.out.publish(message)
            if self.client.spin(0.05, until):
                return True
        return False


@pytest.fixture
def joystick(client, processes):
    client.simulator = processes.start("ros-sim", OFFICE)
    client.guard = processes.start("ros-guard", "--robot", "pioneer3dx")
    client.wait_for("no command has come yet")
    return Joystick(client)


def test_it_passes_commands_and_stops_before_obstacles(client, joystick):
    assert client.spin(30.0, lambda: client.odometry is not None), "no odometry"
    start = client.place
    assert joystick.hold(0.4, 0.0, 20.0, lambda: client.commands[-1][1] > 0.39)
    assert joystick.hold(0.4, 0.0, 5.0, lambda: "passing" in client.state)
    joystick.hold(0.4, 0.0, 60.0, lambda: "limiting" in client.state)
    joystick.hold(0.4, 0.0, 8.0)
    assert math.dist(start, client.place) > 0.3
    assert client.commands[-1][1] < 0.1
    assert client.contacts == []
    assert joystick.markers
    assert len(joystick.markers[-1].markers[0].points) > 50


def test_it_publishes_by_itself_and_stops_without_commands_and_for_nan(client, joystick):
    assert joystick.hold(0.2, 0.0, 20.0, client.drives)
    seen = len(client.commands)
    joystick.hold(0.2, 0.0, 2.0)
    assert 5.0 < (len(client.commands) - seen) / 2.0 < 65.0  # 50 Hz, on a busy machine less
    assert client.spin(5.0, lambda: joystick.rests("idle"))
    assert joystick.hold(0.2, 0.0, 20.0, client.drives)
    assert joystick.hold(math.nan, 0.0, 5.0, lambda: joystick.rests("finite"))


def test_a_lost_simulator_stops_it_and_its_last_word_is_zero(client, joystick):
    assert joystick.hold(0.2, 0.0, 20.0, client.drives)
    client.simulator.send_signal(signal.SIGSTOP)
    assert joystick.hold(0.2, 0.0, 5.0, lambda: joystick.rests("sensor_lost"))
    client.simulator.send_signal(signal.SIGCONT)
    assert joystick.hold(0.2, 0.0, 10.0, client.drives)
    client.guard.send_signal(signal.SIGHUP)  # its terminal was closed
    assert client.guard.wait(10.0) == 0
    client.spin(0.3)
    assert client.commands[-1][1:] == (0.0, 0.0)
