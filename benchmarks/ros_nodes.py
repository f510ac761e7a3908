"""The navigator's node beside the simulator's, as two processes over the middleware.

Run it with the Python of an environment that has the extra ros: first one pair of nodes drives to and
fro across the office for some minutes, then each mission starts a pair of its own. Said are arrivals and
contacts; the time from a scan to its command as a third process hears them, and from the scan's stamp;
how many commands came within a period of their scan's stamp; and what the navigator's process needs.
With --guard it is the guard's node instead, which is given speeds at random 20 times a second: the times
between its commands, contacts, and what its process needs.

    make .venvs/ros/.installed && .venvs/ros/bin/python benchmarks/ros_nodes.py --missions 20 --minutes 10
    .venvs/ros/bin/python benchmarks/ros_nodes.py --guard 2
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
os.environ.setdefault("ROS_DOMAIN_ID", str(random.randint(1, 100)))
os.environ.setdefault("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

OFFICE = Path(__file__).parents[1] / "examples" / "office" / "office.toml"
ENDS = ((37.6, 22.6), (2.0, 2.0))
LIMIT = 400.0  # s, of a mission
WARM = 5.0  # s at the start of a run that are not measured


class Watch:
    """Hears scans, commands, states and contacts of a run, and sends goals."""

    def __init__(self) -> None:
        rclpy.init()
        self.node = rclpy.create_node("watch")
        self.scans: list[float] = []  # stamps
        self.heard: list[float] = []  # when they came
        self.commands: list[float] = []
        self.state, self.contact = "", ""
        take = self.node.create_subscription
        take(LaserScan, "scan", self._on_scan, 50)
        take(Twist, "cmd_vel", lambda message: self.commands.append(time.time()), 50)
        take(DiagnosticArray, "/diagnostics", self._on_state, 10)
        take(String, "contact", lambda message: setattr(self, "contact", message.data), 10)
        self._goal = self.node.create_publisher(PoseStamped, "goal_pose", 1)

    def _on_scan(self, message: LaserScan) -> None:
        stamp = message.header.stamp
        self.scans.append(stamp.sec + 1e-9 * stamp.nanosec)
        self.heard.append(time.time())

    def _on_state(self, message: DiagnosticArray) -> None:
        self.state = message.status[0].message

    def spin(self, seconds: float, until=lambda: False) -> bool:
        """Lets messages come for some seconds, or until something holds; whether it does."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until():
            rclpy.spin_once(self.node, timeout_sec=0.05)
        return until()

    def send(self, place: tuple[float, float]) -> None:
        """Sends a goal, and waits until the navigator has set out."""
        goal = PoseStamped()
        goal.header.frame_id = "map"
        goal.pose.position.x, goal.pose.position.y = place
        goal.pose.orientation.w = 1.0
        self._goal.publish(goal)
        self.spin(5.0, lambda: "arrived" not in self.state and "no goal" not in self.state)

    def latencies(self, since: float) -> tuple[np.ndarray, np.ndarray]:
        """Seconds to the command that answers each scan: from its stamp, and from its coming here."""
        until, commands = time.time() - 1.0, np.array(self.commands)
        pairs = zip(self.scans, self.heard, strict=True)
        stamps, heard = np.array([pair for pair in pairs if since < pair[0] < until]).T
        answers = commands[np.searchsorted(commands, stamps)]
        return answers - stamps, answers - heard

    def close(self) -> None:
        """Leaves the middleware."""
        self.node.destroy_node()
        rclpy.shutdown()


class Nodes:
    """The simulator and another node as processes."""

    def __init__(self, *words: object) -> None:
        self.simulator = self._start("ros-sim", OFFICE)
        self.navigator = self._start(*words)

    def _start(self, *words: object) -> subprocess.Popen:
        env = {k: v for k, v in os.environ.items() if k != "_ROS_WHEELS_BOOTSTRAP_COMPLETE"}
        command = [sys.executable, "-m", "dynastar", *map(str, words)]
        return subprocess.Popen(command, env=env, stderr=subprocess.DEVNULL)

    def cpu_seconds(self) -> float:
        """Of the navigator so far."""
        fields = Path(f"/proc/{self.navigator.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def peak_megabytes(self) -> float:
        """Largest resident memory of the navigator so far."""
        lines = Path(f"/proc/{self.navigator.pid}/status").read_text().splitlines()
        return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))

    def end(self) -> None:
        """Ends both by SIGINT."""
        for process in (self.navigator, self.simulator):
            process.send_signal(signal.SIGINT)
            process.wait(20.0)


def run(seconds: float, wait: float, bag: Path | None = None) -> dict[str, Any]:
    """One pair of nodes: to and fro for ``seconds``, or with 0 a single mission; recorded to ``bag``."""
    record = ("--ros-args", "-p", f"bag:={bag}") if bag else ()
    watch, nodes = Watch(), Nodes("ros", "--scenario", OFFICE, *record)
    try:
        started = lambda: "no goal" in watch.state or nodes.navigator.poll() is not None  # noqa: E731
        assert watch.spin(120.0, started), "the navigator says nothing for two minutes"
        assert nodes.navigator.poll() is None, "the navigator does not start"
        watch.spin(WARM + wait)
        began, used, wall = time.time(), nodes.cpu_seconds(), time.monotonic()
        legs = arrived = 0
        while legs == 0 or time.monotonic() - wall < seconds:
            watch.send(ENDS[legs % 2])
            legs += 1
            left = LIMIT if seconds == 0 else min(LIMIT, seconds - (time.monotonic() - wall))
            over = watch.spin(
                max(left, 0.0), lambda: "arrived" in watch.state or watch.contact != ""
            )
            arrived += over and not watch.contact
            if watch.contact:
                break
        elapsed = time.monotonic() - wall
        used = nodes.cpu_seconds() - used
        late, here = watch.latencies(began)
        return {
            "legs": legs,
            "arrived": arrived,
            "contact": watch.contact,
            "seconds": elapsed,
            "scans": len(late),
            "median_ms": 1e3 * float(np.median(here)),
            "p99_ms": 1e3 * float(np.quantile(here, 0.99)),
            "median_from_stamp_ms": 1e3 * float(np.median(late)),
            "p99_from_stamp_ms": 1e3 * float(np.quantile(late, 0.99)),
            "on_time": float((late < 0.05).mean()),
            "cpu_percent": 100.0 * used / elapsed,
            "peak_mb": nodes.peak_megabytes(),
        }
    finally:
        nodes.end()
        watch.close()


def guarded(seconds: float) -> dict[str, Any]:
    """The guard's node behind a controller that draws another pair of speeds every second."""
    watch = Watch()
    nodes = Nodes("ros-guard", "--ros-args", "-p", "robot:=pioneer3dx", "-p", "latency:=0.1")
    given = watch.node.create_publisher(Twist, "cmd_vel_in", 1)
    draw, message = random.Random(0), Twist()
    try:
        assert watch.spin(120.0, lambda: "no command" in watch.state), "the guard says nothing"
        watch.spin(WARM)
        watch.commands.clear()
        used, wall = nodes.cpu_seconds(), time.monotonic()
        ticks = 0
        while time.monotonic() - wall < seconds and not watch.contact:
            if ticks % 20 == 0:
                message.linear.x, message.angular.z = draw.uniform(-0.2, 0.55), draw.uniform(-1, 1)
            given.publish(message)
            ticks += 1
            watch.spin(0.05)
        elapsed = time.monotonic() - wall
        apart = 1e3 * np.diff(watch.commands)
        return {
            "seconds": elapsed,
            "commands_per_second": len(watch.commands) / elapsed,
            "apart_median_ms": float(np.median(apart)),
            "apart_p99_ms": float(np.quantile(apart, 0.99)),
            "contact": watch.contact,
            "cpu_percent": 100.0 * (nodes.cpu_seconds() - used) / elapsed,
            "peak_mb": nodes.peak_megabytes(),
        }
    finally:
        nodes.end()
        watch.close()


def main() -> None:
    """Runs what was asked for and prints a line for each run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--guard", type=float, metavar="MINUTES", help="the guard's node instead")
    parser.add_argument("--json-out", type=Path)
    parser.add_argument("--bags", type=Path, help="new folder for recordings of the missions")
    options = parser.parse_args()
    subprocess.run([sys.executable, "-m", "dynastar", "warmup"], check=True)
    runs = []
    if options.guard is not None:
        print({"run": "guard", **guarded(60.0 * options.guard)})
        return
    if options.minutes > 0.0:
        runs.append({"run": "to and fro", **run(60.0 * options.minutes, 0.0)})
        print(runs[-1], flush=True)
    for number in range(options.missions):
        bag = options.bags / f"{number:02}" if options.bags else None
        found = run(0.0, 1.7 * number, bag)  # the walkers are elsewhere each time
        runs.append({"run": number, **found})
        print(runs[-1], flush=True)
        if options.json_out:
            options.json_out.write_text(json.dumps(runs, indent=1))
    missions = [one for one in runs if one["run"] != "to and fro"]
    print(
        f"{sum(one['arrived'] for one in missions)} of {len(missions)} missions arrived, "
        f"{sum(one['contact'] != '' for one in missions)} with a contact"
    )


if __name__ == "__main__":
    main()
