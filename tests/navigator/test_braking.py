import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState
from dynastar.navigator.braking import Commands, StopProfile
from dynastar.robot import ROBOTS, Limits, arc, slew, stopping_time
from dynastar.simulation import Scenario, World

PARTS = 20


def drive(pose, twist, command, limits, period):
    """A drive that goes to the command at its own limits and holds, in fine steps."""
    h = period / PARTS
    for _ in range(PARTS):
        after = Twist(
            slew(twist.v, command.v, limits.v_accel, limits.v_brake, h),
            slew(twist.omega, command.omega, limits.omega_accel, limits.omega_brake, h),
        )
        mean = Twist(0.5 * (twist.v + after.v), 0.5 * (twist.omega + after.omega))
        pose, twist = arc(pose, mean, h), after
    return pose, twist


limits_ = st.builds(
    Limits,
    v_max=st.just(2.0),
    omega_max=st.just(2.0),
    v_accel=st.floats(0.2, 3.0),
    omega_accel=st.floats(0.2, 5.0),
    v_brake=st.floats(0.2, 3.0),
    omega_brake=st.floats(0.2, 5.0),
    v_min=st.just(0.0),
    v_least=st.just(0.0),
    omega_least=st.just(0.0),
)


@given(limits_, st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.sampled_from([0.05, 0.1]))
def test_the_stop_ends_on_the_arc_it_was_certified_on(limits, v, omega, period):
    twist = Twist(v, omega)
    pose = start = Pose2D(0.0, 0.0, 0.0)
    stop, ticks = StopProfile(twist, limits), 0
    while (twist.v or twist.omega) and ticks < 1000:
        pose, twist = drive(pose, twist, stop.next(twist, period, period), limits, period)
        ticks += 1
    duration = stopping_time(Twist(v, omega), limits)
    expected = arc(start, Twist(v, omega), 0.5 * duration)
    assert twist == Twist(0.0, 0.0)
    assert ticks <= math.ceil(duration / period) + 1
    # What is left is the last period, which ends in a full stop wherever it began.
    slack = 0.6 * period * period * max(limits.v_brake, limits.omega_brake * abs(v) * period) + 0.01
    assert math.dist(pose[:2], expected[:2]) < slack


@given(limits_, st.floats(0.1, 1.5), st.floats(-1.5, 1.5))
def test_braking_is_never_harder_than_the_limits(limits, v, omega):
    twist, stop = Twist(v, omega), StopProfile(Twist(v, omega), limits)
    for _ in range(50):
        command = stop.next(twist, 0.1, 0.1)
        assert abs(command.v - twist.v) <= limits.v_brake * 0.1 + 1e-9
        assert abs(command.omega - twist.omega) <= limits.omega_brake * 0.1 + 1e-9
        assert abs(command.v) <= abs(twist.v) + 1e-9
        twist = command


@given(
    limits_,
    st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
    st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
)
def test_the_next_command_goes_on_from_the_last_one_near_the_measured_speed(limits, sent, measured):
    commands, period = Commands(limits, 0.1, 0.0), 0.1
    sent, measured = Twist(*sent), Twist(*measured)
    commands.send(RobotState(0.0, Pose2D(0.0, 0.0, 0.0), measured), sent)
    twist = commands.carried_on(measured)
    near_v = 0.08 * limits.v_max + limits.v_brake * period
    near_omega = 0.1 * limits.omega_max + limits.omega_brake * period
    assert abs(twist.v - measured.v) <= near_v + 1e-12
    assert abs(twist.omega - measured.omega) <= near_omega + 1e-12
    if abs(sent.v - measured.v) <= near_v:
        assert twist.v == sent.v
    if abs(sent.omega - measured.omega) <= near_omega:
        assert twist.omega == sent.omega


@pytest.mark.parametrize("latency", [0.0, 0.1, 0.25])
def test_stops_are_certified_for_every_latency_up_to_the_declared_one(latency):
    """A drive that acts at any of these latencies is near one of the states."""
    limits, period = ROBOTS["paper"].limits, 0.1
    commands, sent = Commands(limits, period, latency), []
    pose, twist = Pose2D(0.0, 0.0, 0.0), Twist(0.4, 0.0)
    for k, command in enumerate([Twist(0.45, 0.03), Twist(0.5, 0.06), Twist(0.55, 0.03)]):
        state = RobotState(k * period, pose, twist)
        commands.send(state, command)
        sent.append((state.stamp, command))
    state = RobotState(3 * period, pose, twist)
    acting = commands.when_one_acts(state)
    stops = commands.stops_from(state, acting, commands.carried_on(acting.twist))
    assert len(stops) == 2 * (1 + 3 * math.ceil(latency / 0.1))  # as measured, and as told
    assert stops[-1].pose == acting.pose
    for true in np.linspace(0.0, latency, 6):
        expected, _ = commands.when_one_acts(state, float(true))
        near = min(math.dist(expected[:2], stop.pose[:2]) for stop in stops)
        assert near <= 0.5 * 0.1 * 0.55 + 1e-9
    for stop in stops:
        assert stop.twist.v >= twist.v
        assert period - 1e-9 <= stop.hold <= period + latency + 1e-9
    assert stops[0].hold == pytest.approx(period + latency)  # it acts at once, the next one late
    assert stops[-1].hold == pytest.approx(period)


def test_until_the_oldest_command_that_is_known_acts_the_robot_goes_on_as_it_does():
    limits, latency = ROBOTS["jackal"].limits, 0.3
    commands = Commands(limits, 0.1, latency)
    for k in range(6):
        state = RobotState(0.1 * k, Pose2D(0.2 * k, 0.0, 0.0), Twist(2.0, 0.0))
        pose, twist = commands.when_one_acts(state)
        assert pose == pytest.approx((0.2 * k + 0.6, 0.0, 0.0))
        assert twist == Twist(2.0, 0.0)
        commands.send(state, Twist(2.0, 0.0))


def test_commands_under_way_may_act_alone_until_the_next_one_acts():
    limits, period, latency = ROBOTS["jackal"].limits, 0.1, 0.3
    commands = Commands(limits, period, latency)
    pose, twist = Pose2D(0.0, 0.0, 0.0), Twist(0.5, 0.0)
    for k, omega in enumerate((0.0, 0.4, 0.8)):
        commands.send(RobotState(k * period, pose, twist), Twist(0.5, omega))
    state = RobotState(3 * period, pose, twist)
    acting = commands.when_one_acts(state)
    headings = [stop.pose.theta for stop in commands.stops_from(state, acting, acting.twist)]
    assert min(headings) == pytest.approx(0.0)  # the oldest alone: straight on
    assert max(headings) > acting.pose.theta + 0.05  # the newest alone turns more than expected


@pytest.mark.parametrize(("declared", "true"), [(0.3, 0.0), (0.3, 0.1), (0.2, 0.2)])
def test_a_latency_smaller_than_declared_causes_no_contact(declared, true):
    robot, random = ROBOTS["jackal"], np.random.default_rng(3)
    known = np.pad(np.zeros((158, 278), np.int8), 1, constant_values=100)
    for start in (2.0, 4.0, 6.0):
        cells = known.copy()
        for x, y in random.uniform((2.5, 0.5), (11.0, 7.0), (8, 2)) / 0.05:
            cells[int(y) : int(y) + 12, int(x) : int(x) + 12] = 100
        cells[int(start / 0.05) - 12 : int(start / 0.05) + 12, :40] = known[:24, 10:11]
        cells[:, 0] = 100
        scenario = Scenario(
            "boxes", OccupancyGrid(cells, 0.05), robot, (1.2, start, 0.0), (), latency=true
        )
        world = World(scenario, Pose2D(1.2, start, 0.0))
        navigator = Navigator(OccupancyGrid(known, 0.05), robot, NavigatorConfig(latency=declared))
        navigator.set_goal((12.5, 8.0 - start))
        while navigator.mission.under_way and world.time < 40.0 and not world.contact:
            state = RobotState(world.time, world.pose, world.twist)
            world.step(navigator.command(state, world.scan()), 0.1)
        assert not world.contact
        assert navigator.status.state == "arrived"


HALL = OccupancyGrid(np.pad(np.zeros((158, 398), np.int8), 1, constant_values=100), 0.05)


@pytest.mark.parametrize(
    ("drive_gain", "odometry_gain"), [(1.05, 1.0), (0.92, 1.0), (1.0, 1.03), (1.03, 0.98)]
)
def test_a_drive_that_is_a_few_per_cent_off_arrives_without_contact(drive_gain, odometry_gain):
    robot = ROBOTS["paper"]
    world = World(Scenario("hall", HALL, robot, (2.0, 4.0, 0.0), ()), Pose2D(2.0, 4.0, 0.0))
    navigator = Navigator(HALL, robot, NavigatorConfig())
    navigator.set_goal((15.0, 4.0))
    while not world.contact and world.time < 45.0:
        twist = Twist(*(odometry_gain * speed for speed in world.twist))
        command = navigator.command(RobotState(world.time, world.pose, twist), world.scan())
        world.step(Twist(*(drive_gain * speed for speed in command)), 0.1)
        if navigator.status.state == "arrived" and world.resting:
            break
    assert not world.contact
    assert navigator.status.state == "arrived"
    assert math.dist(world.pose[:2], (15.0, 4.0)) < 0.3
