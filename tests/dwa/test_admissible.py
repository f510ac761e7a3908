import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar import robot as drive
from dynastar.dwa import DwaConfig
from dynastar.dwa.admissible import (
    ADMISSIBLE,
    HIDDEN,
    MOVING,
    NO_STOP,
    certified_stop,
    hidden_gap,
    rests_in_time,
)  # fmt: skip
from dynastar.dwa.dwa import body_of, rules_of
from dynastar.dwa.motion import driven, moved, state_at
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS, Limits, Robot, arc, slew
from naive import slack_of_constraint
from scenes import (
    CELL,
    PERIOD,
    boxed,
    boxes_of,
    empty,
    hidden_in,
    rules_for,
    scattered,
    scene_of,
)

MARGIN = 0.05
WEAK = Limits(1.2, 1.5, 0.8, 2.0, 0.4, 1.0, v_min=-0.4)
ROUND = Robot("round", WEAK, Footprint.disc(0.3))
SHAPES = {
    "round": ROUND,
    "box": Robot("box", WEAK, ROBOTS["jackal"].footprint),
    "off-centre": Robot(
        "off-centre", WEAK, Footprint.polygon([(0.5, -0.1), (0.5, 0.2), (-0.1, 0.25), (-0.2, -0.2)])
    ),
}
OVERSHOOT = 0.25 * CELL  # the longest stretch between two looks


def certify(scene, robot, state, command):
    return certified_stop(scene.around, rules_for(robot), state, command, 0.0)


def rests(scene, robot, state, command):
    return rests_in_time(scene.around, rules_for(robot), state, command)


def reachable_command(random, limits, v, omega):
    wanted = random.uniform(limits.v_min, limits.v_max), random.uniform(-1.5, 1.5)
    return (
        slew(v, wanted[0], limits.v_accel, limits.v_brake, PERIOD),
        slew(omega, wanted[1], limits.omega_accel, limits.omega_brake, PERIOD),
    )


def model_sweep(limits, state, command):
    """Poses (x, y, cos, sin) of a period in two halves and of the stop along one arc after it."""
    poses = [state.pose]
    for _ in range(2):
        after = driven(state, *command, limits, 0.5 * PERIOD)
        length = 0.25 * (state.v + after.v) * PERIOD
        angle = 0.25 * (state.omega + after.omega) * PERIOD
        poses += [moved(state.pose, f * length, f * angle) for f in np.linspace(0.0, 1.0, 8)]
        state = after
    stop = drive.stopping_time(Twist(state.v, state.omega), limits)
    for f in np.linspace(0.0, 0.5, 150):
        poses.append(moved(state.pose, f * stop * state.v, f * stop * state.omega))
    return poses


def true_sweep(limits, state, command):
    """The same poses by a drive that ramps each speed on its own and then holds it."""
    at = state.pose
    pose = Pose2D(at.x, at.y, math.atan2(at.sin, at.cos))
    twist, poses = Twist(state.v, state.omega), []
    for _ in range(50):
        after = Twist(
            slew(twist.v, command[0], limits.v_accel, limits.v_brake, PERIOD / 50),
            slew(twist.omega, command[1], limits.omega_accel, limits.omega_brake, PERIOD / 50),
        )
        mean = Twist(*(0.5 * (a + b) for a, b in zip(twist, after, strict=True)))
        pose, twist = arc(pose, mean, PERIOD / 50), after
        poses.append(pose)
    stop = drive.stopping_time(twist, limits)
    poses += [arc(pose, twist, f * stop) for f in np.linspace(0.0, 0.5, 150)]
    return [(p.x, p.y, math.cos(p.theta), math.sin(p.theta)) for p in poses]


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_the_robot_drives_at_a_wall_as_fast_as_it_can_stop(name):
    robot, wall = SHAPES[name], 6.0
    front = 0.3 if name == "round" else robot.footprint.vertices[:, 0].max()
    scene = scene_of(boxed((wall, 0.0, 6.2, 8.0)), margin=MARGIN)
    for v in np.linspace(0.1, 1.2, 12):
        room = v * PERIOD + v * v / (2.0 * WEAK.v_brake)
        for slack, expected in ((0.01, ADMISSIBLE), (-0.01, NO_STOP)):
            x = wall + 0.5 * CELL - MARGIN - front - room - slack
            state = state_at(x, 4.0, 0.0, v, 0.0)
            assert certify(scene, robot, state, (v, 0.0)) == expected


@pytest.mark.parametrize("error", [0.05, 0.2])
def test_a_drive_that_is_faster_than_told_stops_before_a_wall_too(error):
    scene, wall, v = scene_of(boxed((6.0, 0.0, 6.2, 8.0)), margin=MARGIN), 6.0, 1.0
    room = (1.0 + error) * (v * PERIOD + v * v / (2.0 * WEAK.v_brake))
    for slack, expected in ((0.01, ADMISSIBLE), (-0.01, NO_STOP)):
        x = wall + 0.5 * CELL - MARGIN - 0.3 - room - slack
        rules = rules_of(ROUND, DwaConfig(), PERIOD, drive_error=error)
        state = state_at(x, 4.0, 0.0, v, 0.0)
        assert certified_stop(scene.around, rules, state, (v, 0.0), 0.0) == expected


def test_a_command_that_acts_for_longer_needs_more_room():
    scene, wall, v, hold = scene_of(boxed((6.0, 0.0, 6.2, 8.0)), margin=MARGIN), 6.0, 1.0, 0.35
    room = v * hold + v * v / (2.0 * WEAK.v_brake)
    rules = rules_of(ROUND, DwaConfig(), PERIOD)
    for slack, expected in ((0.01, ADMISSIBLE), (-0.01, NO_STOP)):
        x = wall + 0.5 * CELL - MARGIN - 0.3 - room - slack
        state = state_at(x, 4.0, 0.0, v, 0.0)
        assert certified_stop(scene.around, rules, state, (v, 0.0), hold) == expected


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_a_stop_is_certified_if_and_only_if_its_whole_sweep_keeps_clear(name, seed):
    robot, random = SHAPES[name], np.random.default_rng(seed)
    closed = scattered(random, random.choice([0.0003, 0.001, 0.003]))
    scene = scene_of(closed, margin=MARGIN)
    boxes, hit = boxes_of(scene.around.closed)
    v, omega = random.uniform(-0.4, 1.2), random.uniform(-1.5, 1.5)
    state = state_at(*random.uniform(1.0, 7.0, 2), random.uniform(-4, 4), v, omega)
    start = state.pose
    at_hand = np.hypot(*(boxes[:, ::2] - (start.x, start.y)).T) < 4.0
    near = boxes[at_hand], hit[at_hand]
    command = reachable_command(random, robot.limits, v, omega)
    certified = certify(scene, robot, state, command) == ADMISSIBLE

    def least(poses):
        return min(slack_of_constraint(near, robot.footprint, MARGIN, start, p) for p in poses)

    if certified:
        assert least(model_sweep(robot.limits, state, command)) > -0.5 * OVERSHOOT - 1e-6
        assert least(true_sweep(robot.limits, state, command)) > -0.5 * OVERSHOOT - 2e-3
    else:
        assert least(model_sweep(robot.limits, state, command)) < 1e-3


@given(st.integers(0, 10**6))
@settings(max_examples=300, deadline=None)
def test_no_obstacle_with_bounded_acceleration_touches_a_robot_that_still_moves(seed):
    """If a robot at rest is out of the obstacle's reach, so is one with an admissible command."""
    random = np.random.default_rng(seed)
    bearing, far = random.uniform(-math.pi, math.pi), random.uniform(0.7, 3.0)
    x, y = 4.0 + far * math.cos(bearing), 4.0 + far * math.sin(bearing)
    obstacle = MovingObstacle(x, y, *random.uniform(-1.5, 1.5, 2), 0.3)
    latency = random.choice([0.0, 0.2])
    scene = scene_of(empty(), moving=[obstacle], margin=MARGIN, latency=latency)
    bound = scene.around.moving.acceleration
    v, omega = random.uniform(-0.4, 1.2), random.uniform(-1.5, 1.5)
    state = state_at(4.0, 4.0, 0.0, v, omega)
    command = reachable_command(random, WEAK, v, omega)
    after = driven(state, *command, WEAK, PERIOD)
    stop = drive.stopping_time(Twist(after.v, after.omega), WEAK)
    times = np.linspace(0.0, PERIOD + stop, 200)
    where = []
    for t in times:
        if t <= PERIOD:
            pose = driven(state, *command, WEAK, t).pose
        else:
            done = stop * 0.5 * (1.0 - (1.0 - (t - PERIOD) / max(stop, 1e-9)) ** 2)
            pose = moved(after.pose, after.v * done, after.omega * done)
        where.append((pose.x, pose.y))
    later = (latency + times)[:, None]
    mean = np.array([x, y]) + later * np.array([obstacle.vx, obstacle.vy])
    reach = 0.6 + 0.5 * bound * later[:, 0] ** 2
    still_clear = (np.hypot(*(mean - (4.0, 4.0)).T) > reach + 0.05).all()
    pushed = np.hypot(*(mean - where).T) - 0.5 * bound * later[:, 0] ** 2  # straight at the robot
    worst = np.maximum(pushed, 0.0).min() - 0.6
    admitted = rests(scene, ROUND, state, command) == ADMISSIBLE
    if still_clear and admitted:
        assert worst > -0.01
    if not admitted:
        assert worst < 0.2 or np.hypot(*(mean - where).T).min() < 0.7
    if admitted:
        assert np.hypot(*(mean - where).T)[1:].min() > 0.6 - 0.02


@pytest.mark.parametrize("latency", [0.0, 0.4])
def test_the_robot_drives_at_an_obstacle_as_fast_as_it_rests_before_it_can_come(latency):
    """Head-on at 0.5 m/s, which it may raise by 1.5 m/s2 from now on."""
    for v in (0.3, 0.6, 1.0):
        stop = v / WEAK.v_brake
        until = latency + PERIOD + stop
        driven_to_rest = v * PERIOD + 0.5 * v * stop
        needs = 0.6 + driven_to_rest + 0.5 * until + 0.05 + 0.5 * 1.5 * until**2
        for slack, expected in ((0.01, ADMISSIBLE), (-0.01, MOVING)):
            obstacle = MovingObstacle(2.0 + needs + slack, 4.0, -0.5, 0.0, 0.3)
            scene = scene_of(empty(), moving=[obstacle], latency=latency)
            assert rests(scene, ROUND, state_at(2.0, 4.0, 0.0, v, 0.0), (v, 0.0)) == expected


def test_where_no_command_keeps_clear_the_robot_may_drive_away_but_not_nearer():
    chased = scene_of(empty(), moving=[MovingObstacle(3.0, 4.0, 0.2, 0.0, 0.3)])
    away, towards = (state_at(4.0, 4.0, theta, 0.6, 0.0) for theta in (0.0, math.pi))
    assert rests(chased, ROUND, away, (0.6, 0.0)) == ADMISSIBLE
    assert rests(chased, ROUND, towards, (0.6, 0.0)) == MOVING
    assert rests(chased, ROUND, state_at(4.0, 4.0, 0.0, 0.0, 0.0), (0.0, 0.0)) == ADMISSIBLE


def corner(speed):
    """Unseen space beyond x = 5 m."""
    x = (np.arange(80) + 0.5) * 0.1
    return hidden_in(np.tile(np.maximum(5.0 - x, 0.0), (80, 1)), speed)


def test_the_gap_to_a_hidden_person_is_that_from_the_footprint():
    disc = body_of(ROUND)
    ahead, behind = state_at(4.05, 4.0, 0.0, 0.0, 0.0).pose, state_at(4.05, 4.0, math.pi, 0, 0).pose
    assert hidden_gap(corner(0.5), disc, ahead, 1.0) == pytest.approx(0.95 - 0.25 - 0.3, abs=0.01)
    for x in (-0.1, 8.1):  # off the field
        off = state_at(x, 4.0, 0.0, 0.0, 0.0).pose
        assert hidden_gap(corner(0.5), disc, off, 1.0) < -0.25
    nose = Footprint.polygon([(0.6, -0.2), (0.6, 0.2), (-0.1, 0.2), (-0.1, -0.2)])
    cart = body_of(Robot("cart", WEAK, nose))
    assert hidden_gap(corner(0.5), cart, ahead, 1.0) == pytest.approx(0.95 - 0.25 - 0.6, abs=0.05)
    assert hidden_gap(corner(0.5), cart, behind, 1.0) == pytest.approx(0.95 - 0.25 - 0.1, abs=0.05)


@pytest.mark.parametrize("speed", [0.3, 0.5, 1.0])
def test_the_robot_approaches_unseen_space_as_fast_as_it_rests_before_a_person_comes(speed):
    for v in (0.4, 0.6, 0.8):
        stop = v / WEAK.v_brake
        needs = v * PERIOD + 0.5 * v * stop + speed * (PERIOD + stop) + 0.25 + 0.3 - 0.1
        for slack, expected in ((0.2, ADMISSIBLE), (-0.2, HIDDEN)):
            state = state_at(5.0 - needs - slack, 4.0, 0.0, v, 0.0)
            scene = scene_of(empty(), hidden=corner(speed))
            assert rests(scene, ROUND, state, (v, 0.0)) == expected
    free = scene_of(empty(), hidden=corner(0.0))
    assert rests(free, ROUND, state_at(4.0, 4.0, 0.0, 1.2, 0.0), (1.2, 0.0)) == ADMISSIBLE


@pytest.mark.parametrize("v", [0.4, 0.6, 0.8])
def test_an_obstacle_that_moves_does_not_hide_that_somebody_may_step_out(v):
    """Refused for the hidden person, also if an obstacle can come before."""
    stop = v / WEAK.v_brake
    needs = v * PERIOD + 0.5 * v * stop + 0.5 * (PERIOD + stop) + 0.25 + 0.3 - 0.1
    state = state_at(4.8 - needs + 0.4, 4.0, 0.0, v, 0.0)
    beside = MovingObstacle(state.pose.x + 0.9, 4.0, -0.5, 0.0, 0.3)
    alone = scene_of(empty(), moving=[beside])
    assert rests(alone, ROUND, state, (v, 0.0)) == MOVING
    scene = scene_of(empty(), hidden=corner(0.5), moving=[beside])
    assert rests(scene, ROUND, state, (v, 0.0)) == HIDDEN
