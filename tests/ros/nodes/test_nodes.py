"""The nodes as processes over the real middleware, in the office with unmapped boxes and walkers."""

import math
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from nav_msgs.srv import GetPlan
from std_srvs.srv import Trigger

from dynastar import load_map
from dynastar.geometry import Pose2D, Twist
from dynastar.ros.middleware import make
from dynastar.ros.outgoing import Messages, rotation_of
from dynastar.ros.replay import replay

OFFICE = Path(__file__).parents[3] / "examples" / "office" / "office.yaml"
OFFICE_SCENARIO = OFFICE.with_suffix(".toml")
BRAKING = 0.3  # s within which braking has to begin


def brakes_after(client, struck: float) -> float:
    """Seconds from a fault to the first of the commands that end in a stop."""
    assert client.spin(10.0, lambda: client.commands[-1][1:] == (0.0, 0.0))
    recent = [(at, abs(v)) for at, v, _ in client.commands if at > struck - 0.5]
    fastest = max(v for _, v in recent)
    last = max(at for at, v in recent if v > 0.98 * fastest)
    return next(at for at, _ in recent if at > max(struck, last)) - struck


def test_it_drives_to_a_goal_and_stops(office):
    office.set_off(7.2, 10.0)
    office.wait_for("arrived")
    assert math.dist(office.place, (7.2, 10.0)) < 0.35
    assert office.plans
    assert office.contacts == []
    latencies = np.array(office.latencies[20:])
    latencies = latencies[latencies < 0.045]  # those that answer a scan
    print(f"scan to cmd_vel: median {1e3 * np.median(latencies):.1f} ms")
    assert np.median(latencies) < 0.02
    for process in (office.navigator, office.simulator):
        process.send_signal(signal.SIGINT)
        assert process.wait(10.0) == 0
    office.spin(0.3)
    assert office.commands[-1][1:] == (0.0, 0.0)


def test_goals_replace_one_another_and_are_cancelled_and_refused(office):
    office.set_off(7.2, 10.0)
    office.send(5.0, 2.0)
    assert office.spin(10.0, lambda: office.plans[-1].poses[-1].pose.position.y == 2.0)
    for x, y, frame in ((7.0, 2.0, "odom"), (math.nan, 2.0, "map"), (700.0, 2.0, "map")):
        plans = len(office.plans)
        office.send(x, y, frame)
        office.spin(0.5)
        assert len(office.plans) == plans
    answer = office.call(Trigger, "dynastar/cancel", Trigger.Request())
    assert answer.success
    office.wait_for("cancelled", 5.0)
    assert office.spin(5.0, lambda: office.commands[-1][1:] == (0.0, 0.0))


@pytest.mark.parametrize("lost", ["scan", "odom"])
def test_lost_data_brake_it_and_it_goes_on_when_they_are_back(office, lost):
    office.set_off(12.0, 12.5)
    said = office.set_parameter("dynastar_sim", f"publish_{lost}", type=1, bool_value=False)
    struck = time.monotonic()
    assert said.successful
    assert brakes_after(office, struck) < BRAKING
    assert "sensor_lost" in office.state
    assert "s old" in office.state
    office.set_parameter("dynastar_sim", f"publish_{lost}", type=1, bool_value=True)
    assert office.spin(10.0, office.drives)


def test_a_simulator_that_dies_stops_it(office):
    office.set_off(12.0, 12.5)
    office.simulator.kill()
    assert brakes_after(office, time.monotonic()) < BRAKING
    assert "sensor_lost" in office.state


def test_plans_parameters_and_another_map(office):
    request = GetPlan.Request()
    for pose, (x, y) in ((request.start, (2.0, 2.0)), (request.goal, (37.6, 22.6))):
        pose.header.frame_id = "map"
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation = rotation_of(make, 0.0)
    assert len(office.call(GetPlan, "make_plan", request).plan.poses) > 5
    request.goal.pose.position.x, request.tolerance = 39.97, 1.0  # in the wall
    near = office.call(GetPlan, "make_plan", request).plan.poses[-1].pose.position
    assert math.dist((near.x, near.y), (39.97, 22.6)) <= 1.0
    request.goal.pose.position.x = 500.0
    assert len(office.call(GetPlan, "make_plan", request).plan.poses) == 0
    good = office.set_parameter("dynastar", "dwa.horizon", type=3, double_value=3.0)
    assert good.successful
    bad = office.set_parameter("dynastar", "dwa.horizon", type=3, double_value=-1.0)
    assert not bad.successful
    fixed = office.set_parameter("dynastar", "robot", type=4, string_value="jackal")
    assert "read at the start only" in fixed.reason
    office.set_off(7.2, 10.0)
    plans = len(office.plans)
    grid = load_map(OFFICE)
    values = grid.values.copy()
    values[80:84, 20:170] = 100  # a wall across the first room, y = 4.0 to 4.2
    values[80:84, 140:160] = 0
    office.maps.publish(Messages(make).grid(values, grid.frame, "map", time.time()))
    assert office.spin(10.0, lambda: len(office.plans) > plans)
    office.maps.publish(Messages(make).grid(values, grid.frame, "other", time.time()))
    office.spin(0.5)
    assert office.navigator.poll() is None


@pytest.fixture
def room(client, room_of):
    made = room_of("-p", "robot:=turtlebot3_burger")
    made.run(client, 1.0)
    client.send(4.5, 2.5)
    made.run(client, 1.0)
    assert client.drives()
    return made


def test_a_clock_that_goes_back_drops_the_goal(client, room):
    room.time = 1.0
    room.run(client, 1.0)
    assert "idle" in client.state
    assert client.commands[-1][1:] == (0.0, 0.0)
    client.send(4.5, 2.5)
    room.run(client, 1.0)
    assert client.drives()


def test_a_recording_ends_where_the_clock_goes_back(client, room_of, tmp_path):
    bag = tmp_path / "bag"
    made = room_of("-p", "robot:=turtlebot3_burger", "-p", f"bag:={bag}")
    made.run(client, 1.0)
    client.send(4.5, 2.5)
    made.run(client, 1.0)
    made.time = 1.0
    made.run(client, 1.0)
    assert client.navigator.poll() is None
    found = replay(bag)
    assert np.array_equal(found.commands, found.recorded)
    times = found.times[found.times > 1.0]  # before the first message of the clock it is 0
    assert (np.diff(times) > 0.005).all()


def test_a_clock_that_stands_still_brakes_it(client, room):
    struck = time.monotonic()
    room.run(client, 1.0, runs=False, data=False)
    assert brakes_after(client, struck) < BRAKING
    assert "the clock stands still" in client.state
    room.run(client, 1.0)
    assert client.drives()


def test_a_burst_of_goals_and_nonsense_leaves_it_driving(client, room):
    for k in range(500):
        client.send(4.0 if k % 2 else math.nan, 2.5 + 0.001 * k)
        nowhere, frames = Pose2D(math.nan, 0.0, 0.0), ("odom", "base_link")
        room.odometry.publish(room.out.odometry(nowhere, Twist(0.0, 0.0), frames, room.time))
    struck = time.monotonic()
    room.run(client, 1.0)
    gaps = np.diff([at for at, *_ in client.commands if at > struck])
    assert gaps.max() < BRAKING
    assert client.navigator.poll() is None
    client.send(4.5, 2.5)
    room.run(client, 1.0)
    assert client.drives()


def test_a_recording_of_the_node_gives_its_commands_again(client, processes, tmp_path):
    client.simulator = processes.start("ros-sim", OFFICE_SCENARIO)
    bag = tmp_path / "bag"
    words = ["--ros-args", "-p", "latency:=0.1", "-p", f"bag:={bag}"]
    client.navigator = processes.start("ros", "--scenario", OFFICE_SCENARIO, *words)
    client.wait_for("no goal")
    client.set_off(7.2, 10.0)
    client.spin(4.0)
    client.set_parameter("dynastar", "dwa.horizon", type=3, double_value=3.0)
    client.spin(1.0)
    client.call(Trigger, "dynastar/cancel", Trigger.Request())
    client.spin(1.0)
    client.navigator.send_signal(signal.SIGTERM)
    assert client.navigator.wait(10.0) == 0
    found = replay(bag)
    assert len(found.commands) > 100
    assert np.array_equal(found.commands, found.recorded)
    assert {"idle", "following"} <= set(found.states)
