import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from driving import room
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState
from dynastar.navigator.last_turn import turn_by
from dynastar.robot import ROBOTS, Lidar, Limits, Robot, slew
from dynastar.simulation import Scenario, World

SHORT_BY = 0.09  # rad
LIMITS = Limits(0.6, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3)
CART = Robot(
    "cart",
    LIMITS,
    Footprint.polygon([(0.85, -0.25), (0.85, 0.25), (-0.15, 0.25), (-0.15, -0.25)]),
    Lidar(720, math.tau, 0.05, 10.0),
)


def drive(
    grid, robot, start, goal, *, latency=0.0, gain=1.0, least=0.0, declared=0.0, period=0.1, seconds=60.0
):  # fmt: skip
    """A mission in a true world, by a drive with a gain that does not turn slower than ``least``.

    The navigator, the world, and the radians turned in all.
    """
    grid = OccupancyGrid(grid.refined(2).values, 0.05)
    start = Pose2D(*start)
    world = World(Scenario("turn", grid, robot, tuple(start), (), latency=latency), start)
    navigator = Navigator(grid, robot, NavigatorConfig(latency=declared))
    turned, theta = 0.0, start.theta
    navigator.set_goal(goal)
    while navigator.mission.under_way and world.time < seconds:
        state = RobotState(world.time, world.pose, world.twist)
        command = navigator.command(state, world.scan())
        omega = gain * command.omega if abs(command.omega) >= least else 0.0
        world.step(Twist(command.v, omega), period)
        assert not world.contact
        turned += abs(math.remainder(world.pose.theta - theta, math.tau))
        theta = world.pose.theta
    return navigator.status, world, turned


@pytest.mark.parametrize(
    ("latency", "gain", "period"), [(0.15, 1.0, 0.1), (0.0, 1.15, 0.1), (0.0, 1.0, 0.25)]
)
@pytest.mark.parametrize("name", ["pioneer3dx", "turtlebot3_burger", "jackal"])
def test_the_robot_does_not_swing_though_its_drive_is_not_as_declared(name, latency, gain, period):
    status, world, turned = drive(
        room(8.0, 5.0), ROBOTS[name], (4.0, 2.5, 0.0), (4.0, 2.5, 2.5),
        latency=latency, gain=gain, period=period, seconds=20.0,
    )  # fmt: skip
    assert status.state == "arrived"
    assert abs(math.remainder(world.pose.theta - 2.5, math.tau)) < 0.15
    assert turned < 4.0


@pytest.mark.parametrize("turn", [2.5, -1.0, 0.4])
@pytest.mark.parametrize("declared", [0.0, 0.2, 0.4])
@pytest.mark.parametrize(
    ("least", "period"), [(0.12, 0.05), (0.12, 0.2), (0.25, 0.05), (0.25, 0.1)]
)
def test_a_drive_that_does_not_turn_slowly_comes_to_the_heading_as_well(
    turn, declared, least, period
):
    status, world, _ = drive(
        room(8.0, 5.0), ROBOTS["pioneer3dx"], (4.0, 2.5, 0.0), (4.0, 2.5, turn),
        least=least, declared=declared, period=period, seconds=30.0,
    )  # fmt: skip
    assert status.state == "arrived", status.reason
    assert abs(math.remainder(world.pose.theta - turn, math.tau)) < 0.15


def test_a_long_robot_turns_the_long_way_round_where_the_short_one_is_shut():
    grid = room(8.0, 6.0, (0.0, 3.6, 8.0, 6.0))
    status, world, turned = drive(grid, CART, (1.5, 3.0, 0.0), (5.0, 3.0, 2.4))
    assert status.state == "arrived"
    assert abs(math.remainder(world.pose.theta - 2.4, math.tau)) < 0.15
    assert math.dist(world.pose[:2], (5.0, 3.0)) <= 0.25
    assert turned > math.pi


def test_on_a_map_of_another_yaw_a_place_to_turn_is_looked_for_anew():
    grid, robot = OccupancyGrid(room().refined(2).values, 0.05), ROBOTS["jackal"]
    start = Pose2D(4.0, 0.42, 0.0)
    world = World(Scenario("turn", grid, robot, tuple(start), ()), start)
    navigator = Navigator(grid, robot, NavigatorConfig())
    navigator.set_goal((4.0, 0.42, 1.57))

    def tick():
        state = RobotState(world.time, world.pose, world.twist)
        world.step(navigator.command(state, world.scan()), 0.1)
        assert world.time < 60.0

    while navigator._last_turn.place is None:
        tick()
    free = OccupancyGrid(np.zeros((300, 300), np.int8), GridFrame(0.1, 15.0, -15.0, 1.57))
    navigator.set_map(free)
    while navigator.mission.under_way:
        tick()
        assert math.dist(start[:2], world.pose[:2]) < 0.6
    assert navigator.status.state == "arrived"


def test_without_room_for_the_heading_the_mission_ends_blocked_and_says_so():
    grid = room(8.0, 6.0, (0.0, 3.4, 8.0, 6.0), (0.0, 0.0, 8.0, 2.8))
    status, world, _ = drive(
        grid, ROBOTS["jackal"], (1.5, 3.1, 0.0), (5.0, 3.1, 3.1), seconds=100.0
    )
    assert status.state == "blocked"
    assert "heading" in status.reason
    assert math.dist(world.pose[:2], (5.0, 3.1)) <= 0.25


@given(st.floats(-6.3, 6.3), st.floats(-1.0, 1.0), st.floats(0.0, 0.3))
def test_the_turn_is_within_the_limits_and_ends_at_the_angle(angle, omega, least):
    limits, period = LIMITS._replace(omega_least=least), 0.05
    twist, left = Twist(0.0, omega), angle
    for _ in range(400):
        command = turn_by(left, SHORT_BY, twist, limits, period)
        assert abs(command.omega) <= max(limits.omega_max, abs(omega))
        assert command.omega == 0.0 or abs(command.omega) >= least
        reached = slew(twist.omega, command.omega, limits.omega_accel, limits.omega_brake, period)
        left -= 0.5 * (twist.omega + reached) * period
        twist = Twist(0.0, reached)
    assert abs(left) < 0.1
    assert abs(twist.omega) < 0.1
