"""The search over the window, and the window round it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import DynamicWindow
from dynastar.dwa.admissible import MOVER
from dynastar.dwa.config import DwaConfig, Weights
from dynastar.dwa.objective import note_risk, risk
from dynastar.dwa.scene import AT_REST, FOLLOW, Manoeuvre
from dynastar.geometry import Pose2D, Twist
from dynastar.perception import MovingObstacle
from dynastar.perception.hidden import Hidden
from dynastar.robot import ROBOTS, Footprint, Limits, Robot, arc, slew
from scenes import STEP, boxed, empty, field_of, scene_of

PERIOD = 0.1
LIMITS = Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0, v_min=-0.3)
ROUND = Robot("round", LIMITS, Footprint.disc(0.3))


def choose(closed, pose, twist=Twist(0.0, 0.0), robot=ROUND, config=DwaConfig(), **more):
    window = DynamicWindow(robot, config, PERIOD)
    radius = robot.footprint.inscribed
    scene = scene_of(closed, radius=radius, last=Manoeuvre(*twist, 0.5, FOLLOW), **more)
    return window.choose(Pose2D(*pose), twist, scene)


def drive(closed, pose, goal, seconds, robot=ROUND):
    """Ticks of a drive that does exactly as told: (pose, twist, choice)."""
    window, pose, twist, last = (
        DynamicWindow(robot, DwaConfig(), PERIOD),
        Pose2D(*pose),
        Twist(0.0, 0.0),
        AT_REST,
    )
    scene = scene_of(closed, goal, radius=robot.footprint.inscribed)
    for _ in range(round(seconds / PERIOD)):
        choice = window.choose(pose, twist, scene._replace(last=last))
        last = choice.left
        command = choice.command or Twist(
            slew(twist.v, 0.0, 1.0, robot.limits.v_brake, PERIOD),
            slew(twist.omega, 0.0, 1.0, robot.limits.omega_brake, PERIOD),
        )
        mean = Twist(0.5 * (twist.v + command.v), 0.5 * (twist.omega + command.omega))
        pose, twist = arc(pose, mean, PERIOD), command
        yield pose, twist, choice


JACKAL, BURGER = ROBOTS["jackal"], ROBOTS["turtlebot3_burger"]


@pytest.mark.parametrize(
    ("robot", "start"),
    [
        (ROUND, (1.0, 4.0, 0.0)),
        (ROUND, (1.0, 2.0, 2.5)),
        (ROUND, (6.0, 6.5, 1.0)),
        (JACKAL, (1.0, 4.0, 0.0)),
        (JACKAL, (1.0, 2.0, 2.5)),
        (BURGER, (1.0, 4.0, 0.0)),
        (BURGER, (6.0, 6.5, 1.0)),
    ],
)
def test_an_empty_scene_is_driven_through_to_the_goal(robot, start):
    goal = (4.0, 4.0)
    seconds = 6.0 + 2.5 * math.dist(start[:2], goal) / robot.limits.v_max
    near = [math.dist(p[:2], goal) < 0.5 for p, _, _ in drive(empty(), start, goal, seconds, robot)]
    assert any(near)


def test_a_wall_ahead_is_driven_round_and_never_touched():
    closed = boxed((3.5, 2.5, 3.7, 5.5))
    gaps, ends = [], []
    for pose, _, _ in drive(closed, (1.5, 4.0, 0.0), (6.0, 4.0), 20.0):
        dx = max(3.5 - pose.x, pose.x - 3.7, 0.0)
        dy = max(2.5 - pose.y, pose.y - 5.5, 0.0)
        gaps.append(math.hypot(dx, dy))
        ends.append(math.dist(pose[:2], (6.0, 4.0)))
    assert min(gaps) > 0.3
    assert min(ends) < 0.25


def test_shut_in_one_stands():
    closed = boxed(
        (3.0, 3.0, 5.0, 3.2), (3.0, 4.8, 5.0, 5.0), (3.0, 3.0, 3.2, 5.0), (4.8, 3.0, 5.0, 5.0)
    )
    for pose, _, _ in drive(closed, (4.0, 4.0, 0.0), (6.0, 4.0), 4.0):
        assert max(abs(pose.x - 4.0), abs(pose.y - 4.0)) < 0.8 - 0.3


def test_a_manoeuvre_that_is_carried_on_ends_in_time_though_ticks_are_shorter_than_steps():
    stubborn = DwaConfig(hysteresis=10.0)
    window = DynamicWindow(ROUND, stubborn, 0.05)
    last, holds = Manoeuvre(0.3, 0.2, 0.5, FOLLOW), []
    for _ in range(10):
        choice = window.choose(Pose2D(1.0, 4.0, 0.0), Twist(0.3, 0.2), scene_of(empty(), last=last))
        assert choice.manoeuvre is not None
        holds.append(choice.manoeuvre.hold)
        last = choice.left
    assert holds == pytest.approx(np.arange(0.5, 0.0, -0.05))


def test_simi_is_the_mean_closeness_to_the_path_and_draws_the_robot_to_it():
    line = np.ones((160, 160), bool)
    line[100] = False  # along y = 5.0 m
    path = field_of(~line)
    there = choose(
        empty(), (1.0, 5.02, 0.0), Twist(0.5, 0.0), goal=(7.0, 5.0), path=path, sigma=1.0
    )
    beside = choose(empty(), (1.0, 4.0, 0.0), Twist(0.5, 0.0), path=path, sigma=5.0)
    simi = there.terms[np.argmax(there.score), 3]
    assert 0.8 < simi <= 1.0
    assert beside.terms[np.argmax(beside.score), 3] < simi
    assert beside.command.omega > 0.1
    alone = choose(empty(), (1.0, 4.0, 0.0), Twist(0.5, 0.0))
    assert alone.command.omega < beside.command.omega


def risk_of(choice_twist, scene, pose):
    """The risk of holding a twist for 3 s."""
    worst = np.zeros((len(scene.people.now), 3))
    for k in range(30):
        at = arc(pose, choice_twist, STEP * (k + 1))
        note_risk(scene.people, k, STEP * (k + 1), at.x, at.y, 0.3, worst)
    return risk(scene.people, worst)


@pytest.mark.parametrize("lateral", [-0.15, 0.15])
def test_a_mover_head_on_is_run_less_risk_with_than_straight_on(lateral):
    mover = MovingObstacle(4.2, 4.0 + lateral, -0.8, 0.0, 0.3)
    twist = Twist(0.6, 0.0)
    choice = choose(empty(), (1.5, 4.0, 0.0), twist, movers=[mover])
    scene = scene_of(empty(), movers=[mover])
    pose = Pose2D(1.5, 4.0, 0.0)
    assert choice.manoeuvre is not None
    assert risk_of(Twist(*choice.manoeuvre[:2]), scene, pose) < 0.7 * risk_of(twist, scene, pose)
    careless = choose(
        empty(), (1.5, 4.0, 0.0), twist, movers=[mover], config=DwaConfig(Weights(risk=0.0))
    )
    assert careless.manoeuvre.v > 0.6
    assert abs(careless.manoeuvre.omega) < 0.2


def test_the_robot_passes_before_somebody_where_a_stop_would_end_in_their_way():
    mover = MovingObstacle(3.6, 2.6, 0.0, 0.7, 0.3)
    pose, twist = Pose2D(3.0, 4.0, 0.0), Twist(1.0, 0.0)
    scene = scene_of(empty(), movers=[mover], last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW))
    window = DynamicWindow(ROUND, DwaConfig(), PERIOD)
    assert not window.admits(pose, twist, scene, Twist(1.0, 0.0))
    choice = window.choose(pose, twist, scene)
    assert choice.command is not None
    assert choice.command.v > 0.9
    assert choice.refusals["moving obstacle"] > 0


def test_the_robot_brakes_for_whom_it_cannot_pass():
    movers = [MovingObstacle(4.4, 4.0 + y, -1.0, 0.0, 0.3) for y in (-2.0, -1.0, 0.0, 1.0, 2.0)]
    choice = choose(empty(), (3.0, 4.0, 0.0), Twist(1.0, 0.0), movers=movers)
    assert choice.command is None or choice.command.v < 0.95
    assert choice.refusals["moving obstacle"] > 0


def test_a_manoeuvre_has_to_be_clear_for_as_long_as_a_stop_takes():
    """Head-on at 1 m/s each, contact in 1.75 s and in 1 s; a stop takes 1.25 s and a period."""
    pose, twist = Pose2D(1.5, 4.0, 0.0), Twist(1.0, 0.0)
    shut = boxed((0.5, 3.0, 7.5, 3.3), (0.5, 4.7, 7.5, 5.0))  # a corridor without room to pass
    for gap, refused in ((2.0 * 1.75, False), (2.0 * 1.0, True)):
        mover = MovingObstacle(pose.x + 0.6 + gap, 4.0, -1.0, 0.0, 0.3)
        scene = scene_of(shut, movers=[mover], last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW))
        choice = DynamicWindow(ROUND, DwaConfig(), PERIOD).survey(pose, twist, scene)
        fast = choice.samples[:, 0] > 0.99
        assert fast.any()
        assert (choice.refused[fast] == MOVER).all() == refused


def test_unseen_space_gives_way_only_where_a_stop_would_end_in_somebodys_way():
    """All that the robot can do brings it nearer to unseen space than it can rest in time."""
    distance = np.repeat(np.linspace(6.0, -2.0, 80, dtype=np.float32)[None], 80, axis=0)
    hidden = Hidden(distance, 0.0, 0.0, 0.1, 0.25, 2.0, 0.1)
    pose, twist = Pose2D(4.0, 4.0, 0.0), Twist(1.0, 0.0)
    crossing = MovingObstacle(4.7, 6.4, 0.0, -1.0, 0.3)
    aside = MovingObstacle(1.0, 7.0, 0.0, 0.3, 0.3)
    for movers, drives in (([], False), ([aside], False), ([crossing], True)):
        scene = scene_of(
            empty(), movers=movers, hidden=hidden, last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW)
        )
        choice = DynamicWindow(ROUND, DwaConfig(), PERIOD).choose(pose, twist, scene)
        assert (choice.command is not None) == drives
        assert (choice.refusals["unseen space"] > 0) == (not drives)


@given(st.sampled_from(sorted(ROBOTS)), st.floats(0, 1), st.floats(-1, 1), st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_the_choice_is_the_admissible_sample_with_the_highest_score(name, v, omega, seed):
    robot, random = ROBOTS[name], np.random.default_rng(seed)
    closed = empty() | (random.random(empty().shape) < 0.001)
    limits = robot.limits
    twist = Twist(v * limits.v_max, omega * limits.omega_max)
    choice = choose(closed, (*random.uniform(2, 6, 2), random.uniform(-3, 3)), twist, robot)
    admitted = choice.refused == 0
    assert sum(choice.refusals.values()) == (~admitted).sum()
    assert (choice.score[~admitted] == -np.inf).all()
    if choice.command is None:
        assert not np.isfinite(choice.score).any()
        return
    best = int(np.argmax(choice.score))
    assert choice.score[best] == choice.score.max()
    assert choice.manoeuvre[:2] in [
        tuple(s) for s in choice.samples[choice.score == choice.score[best]]
    ]
    assert limits.v_min - 1e-9 <= choice.command.v <= limits.v_max + 1e-9
    assert abs(choice.command.omega) <= limits.omega_max + 1e-9
    wanted = choice.manoeuvre
    assert choice.command.v == pytest.approx(
        slew(twist.v, wanted.v, limits.v_accel, limits.v_brake, PERIOD)
    )
    assert choice.command.omega == pytest.approx(
        slew(twist.omega, wanted.omega, limits.omega_accel, limits.omega_brake, PERIOD)
    )
