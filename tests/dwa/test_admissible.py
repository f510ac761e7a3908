import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar import robot as drive
from dynastar.dwa import body_of
from dynastar.dwa.admissible import (
    ADMISSIBLE,
    HIDDEN,
    MOVER,
    NO_STOP,
    certified_stop,
    hidden_gap,
    rests_in_time,
)  # fmt: skip
from dynastar.dwa.motion import driven, moved
from dynastar.geometry import Pose2D, Twist
from dynastar.perception import MovingObstacle
from dynastar.perception.hidden import Hidden
from dynastar.robot import ROBOTS, Footprint, Limits, Robot, arc, slew
from naive import spare_of_rule
from scenes import CELL, boxed, centres_of, empty, scene_of, state_of

PERIOD, MARGIN = 0.1, 0.05
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
    return certified_stop(scene, body_of(robot), robot.limits, state, command, PERIOD)


def rests(scene, robot, state, command):
    return rests_in_time(scene, body_of(robot), robot.limits, state, command, PERIOD)


def reachable_command(random, limits, v, omega):
    wanted = random.uniform(limits.v_min, limits.v_max), random.uniform(-1.5, 1.5)
    return (
        slew(v, wanted[0], limits.v_accel, limits.v_brake, PERIOD),
        slew(omega, wanted[1], limits.omega_accel, limits.omega_brake, PERIOD),
    )


def model_sweep(limits, state, command):
    """Poses (x, y, cos, sin) of a period in two halves and of the stop along one arc behind it."""
    pose, v, omega = state
    poses = [pose]
    for _ in range(2):
        after, v1, w1 = driven(pose, v, omega, *command, limits, 0.5 * PERIOD)
        length, angle = 0.25 * (v + v1) * PERIOD, 0.25 * (omega + w1) * PERIOD
        poses += [moved(pose, f * length, f * angle) for f in np.linspace(0.0, 1.0, 8)]
        pose, v, omega = after, v1, w1
    stop = max(abs(v) / limits.v_brake, abs(omega) / limits.omega_brake)
    poses += [moved(pose, f * stop * v, f * stop * omega) for f in np.linspace(0.0, 0.5, 150)]
    return poses


def true_sweep(limits, state, command):
    """The same as a drive does it that ramps each speed on its own and then holds."""
    (x, y, cos, sin), v, omega = state
    pose, twist, poses = Pose2D(x, y, math.atan2(sin, cos)), Twist(v, omega), []
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
def test_a_wall_ahead_is_driven_at_as_fast_as_one_can_stop(name):
    robot, wall = SHAPES[name], 6.0
    front = 0.3 if name == "round" else robot.footprint.vertices[:, 0].max()
    scene = scene_of(boxed((wall, 0.0, 6.2, 8.0)), margin=MARGIN)
    for v in np.linspace(0.1, 1.2, 12):
        room = v * PERIOD + v * v / (2.0 * WEAK.v_brake)
        for spare, expected in ((0.01, ADMISSIBLE), (-0.01, NO_STOP)):
            x = wall + 0.5 * CELL - MARGIN - front - room - spare
            assert certify(scene, robot, state_of(x, 4.0, 0.0, v), (v, 0.0)) == expected


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 10**6))
@settings(max_examples=150, deadline=None)
def test_a_stop_is_certified_if_and_only_if_its_whole_sweep_keeps_the_rule(name, seed):
    robot, random = SHAPES[name], np.random.default_rng(seed)
    closed = empty() | (random.random(empty().shape) < random.choice([0.0003, 0.001, 0.003]))
    scene, centres = scene_of(closed, margin=MARGIN), centres_of(closed)
    v, omega = random.uniform(-0.4, 1.2), random.uniform(-1.5, 1.5)
    state = state_of(*random.uniform(1.0, 7.0, 2), random.uniform(-4, 4), v, omega)
    near = centres[np.hypot(*(centres - state[0][:2]).T) < 4.0]
    command = reachable_command(random, robot.limits, v, omega)
    certified = certify(scene, robot, state, command) == ADMISSIBLE

    def least(poses):
        return min(spare_of_rule(near, robot.footprint, MARGIN, state[0], p) for p in poses)

    if certified:
        assert least(model_sweep(robot.limits, state, command)) > -0.5 * OVERSHOOT - 1e-6
        assert least(true_sweep(robot.limits, state, command)) > -0.5 * OVERSHOOT - 2e-3
    else:
        assert least(model_sweep(robot.limits, state, command)) < 1e-3


@given(st.integers(0, 10**6))
@settings(max_examples=300, deadline=None)
def test_nobody_with_bounded_acceleration_touches_a_robot_that_still_moves(seed):
    """If keeping still is out of everybody's reach, so is what is admitted."""
    random = np.random.default_rng(seed)
    bearing, far = random.uniform(-math.pi, math.pi), random.uniform(0.7, 3.0)
    x, y = 4.0 + far * math.cos(bearing), 4.0 + far * math.sin(bearing)
    mover = MovingObstacle(x, y, *random.uniform(-1.5, 1.5, 2), 0.3)
    ahead = random.choice([0.0, 0.2])
    scene = scene_of(empty(), movers=[mover], margin=MARGIN, ahead=ahead)
    bound = scene.people.acceleration
    v, omega = random.uniform(-0.4, 1.2), random.uniform(-1.5, 1.5)
    state = state_of(4.0, 4.0, 0.0, v, omega)
    command = reachable_command(random, WEAK, v, omega)
    pose, v1, w1 = driven(state[0], v, omega, *command, WEAK, PERIOD)
    stop = max(abs(v1) / WEAK.v_brake, abs(w1) / WEAK.omega_brake)
    times = np.linspace(0.0, PERIOD + stop, 200)
    where = []
    for t in times:
        if t <= PERIOD:
            where.append(driven(state[0], v, omega, *command, WEAK, t)[0][:2])
        else:
            done = stop * 0.5 * (1.0 - (1.0 - (t - PERIOD) / max(stop, 1e-9)) ** 2)
            where.append(moved(pose, v1 * done, w1 * done)[:2])
    after = (ahead + times)[:, None]
    mean = np.array([x, y]) + after * np.array([mover.vx, mover.vy])
    reach = 0.6 + 0.5 * bound * after[:, 0] ** 2
    still_clear = (np.hypot(*(mean - (4.0, 4.0)).T) > reach + 0.05).all()
    pushed = np.hypot(*(mean - where).T) - 0.5 * bound * after[:, 0] ** 2  # straight at the robot
    worst = np.maximum(pushed, 0.0).min() - 0.6
    admitted = rests(scene, ROUND, state, command) == ADMISSIBLE
    if still_clear and admitted:
        assert worst > -0.01
    if not admitted:
        assert worst < 0.2 or np.hypot(*(mean - where).T).min() < 0.7
    if admitted:
        assert np.hypot(*(mean - where).T)[1:].min() > 0.6 - 0.02


def test_where_nothing_keeps_clear_one_may_drive_away_but_not_nearer():
    chased = scene_of(empty(), movers=[MovingObstacle(3.0, 4.0, 0.2, 0.0, 0.3)])
    away, towards = state_of(4.0, 4.0, 0.0, 0.6), state_of(4.0, 4.0, math.pi, 0.6)
    assert rests(chased, ROUND, away, (0.6, 0.0)) == ADMISSIBLE
    assert rests(chased, ROUND, towards, (0.6, 0.0)) == MOVER
    assert rests(chased, ROUND, state_of(4.0, 4.0, 0.0), (0.0, 0.0)) == ADMISSIBLE


def corner(speed):
    """Somebody may stand anywhere beyond x = 5 m."""
    x = (np.arange(80) + 0.5) * 0.1
    distance = np.tile(np.maximum(5.0 - x, 0.0).astype(np.float32), (80, 1))
    return Hidden(distance, 0.0, 0.0, 0.1, 0.25, speed, 0.1)


def test_the_gap_to_somebody_hidden():
    assert hidden_gap(corner(0.5), 4.05, 4.0) == pytest.approx(0.95 - 0.25, abs=0.01)
    assert hidden_gap(corner(0.5), -0.1, 4.0) == hidden_gap(corner(0.5), 8.1, 4.0) == 0.0


@pytest.mark.parametrize("speed", [0.3, 0.5, 1.0])
def test_unseen_space_is_approached_as_fast_as_one_rests_before_somebody_comes(speed):
    for v in (0.4, 0.6, 0.8):
        stop = v / WEAK.v_brake
        needs = v * PERIOD + 0.5 * v * stop + speed * (PERIOD + stop) + 0.25 + 0.3 - 0.1
        for spare, expected in ((0.2, ADMISSIBLE), (-0.2, HIDDEN)):
            state = state_of(5.0 - needs - spare, 4.0, 0.0, v)
            scene = scene_of(empty(), hidden=corner(speed))
            assert rests(scene, ROUND, state, (v, 0.0)) == expected
    free = scene_of(empty(), hidden=corner(0.0))
    assert rests(free, ROUND, state_of(4.0, 4.0, 0.0, 1.2), (1.2, 0.0)) == ADMISSIBLE
