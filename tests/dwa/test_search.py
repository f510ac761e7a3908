"""The search over the candidates, and the window of speeds they are taken from."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import DynamicWindow
from dynastar.dwa.admissible import (
    ADMISSIBLE,
    HIDDEN,
    MOVING,
    NO_STOP,
    certified_stop,
    rests_in_time,
)
from dynastar.dwa.clearance import least_clearance
from dynastar.dwa.config import DwaConfig, Weights
from dynastar.dwa.dwa import TERMS, StopStart
from dynastar.dwa.motion import state_at, stopping_time
from dynastar.dwa.rollout import ROW, roll_out, tail_speeds
from dynastar.dwa.scene import AT_REST, BACK, FOLLOW, STOP, Manoeuvre
from dynastar.dwa.search import FOLLOW_NOW, LAST, SAMPLES
from dynastar.dwa.terms import evaluate, objective, passes_clear, risk, state_value
from dynastar.dwa.window import possible, reachable
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS, Limits, Robot, arc, slew
from scenes import (
    PERIOD,
    boxed,
    empty,
    field_of,
    hidden_in,
    rules_for,
    scattered,
    scene_of,
    start_of,
)

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


def test_a_robot_that_is_shut_in_stands():
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
    path, simi = field_of(~line), TERMS.index("simi")
    on_it = {"goal": (7.0, 5.0), "distance_to_path": path, "path_weight": 1.0}
    there = choose(empty(), (1.0, 5.02, 0.0), Twist(0.5, 0.0), **on_it)
    off_it = {"distance_to_path": path, "path_weight": 5.0}
    beside = choose(empty(), (1.0, 4.0, 0.0), Twist(0.5, 0.0), **off_it)
    assert 0.8 < there.terms[np.argmax(there.score), simi] <= 1.0
    assert beside.terms[np.argmax(beside.score), simi] < 0.8
    assert beside.command.omega > 0.1
    alone = choose(empty(), (1.0, 4.0, 0.0), Twist(0.5, 0.0))
    assert alone.command.omega < beside.command.omega


def risk_of(twist, scene, pose):
    """The risk of holding a twist."""
    rules = rules_for(ROUND)
    rows = np.zeros(len(rules.schedule.step), ROW)
    start = start_of(rules, state_at(*pose, *twist), 1.0, 5.0)
    roll_out(scene, rules, start, Manoeuvre(*twist, 9.0, FOLLOW), rows)
    return risk(scene.around.moving, rules, rows)


@pytest.mark.parametrize("lateral", [-0.15, 0.15])
def test_an_obstacle_head_on_is_passed_with_less_risk_than_straight_on(lateral):
    obstacle = MovingObstacle(4.2, 4.0 + lateral, -0.8, 0.0, 0.3)
    pose, twist = Pose2D(1.5, 4.0, 0.0), Twist(0.6, 0.0)
    choice = choose(empty(), pose, twist, moving=[obstacle])
    scene = scene_of(empty(), moving=[obstacle])
    assert choice.manoeuvre is not None
    assert risk_of(Twist(*choice.manoeuvre[:2]), scene, pose) < 0.7 * risk_of(twist, scene, pose)
    no_risk = DwaConfig(Weights(risk=0.0, nearness=0.0))
    careless = choose(empty(), pose, twist, moving=[obstacle], config=no_risk)
    assert careless.manoeuvre.v > 0.6
    assert abs(careless.manoeuvre.omega) < 0.2


def test_the_robot_passes_before_an_obstacle_where_a_stop_would_end_in_its_way():
    obstacle = MovingObstacle(3.6, 2.6, 0.0, 0.7, 0.3)
    pose, twist = Pose2D(3.0, 4.0, 0.0), Twist(1.0, 0.0)
    scene = scene_of(empty(), moving=[obstacle], last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW))
    window = DynamicWindow(ROUND, DwaConfig(), PERIOD)
    assert not window.admits(scene.around, [StopStart(pose, twist, PERIOD)], Twist(1.0, 0.0))
    choice = window.choose(pose, twist, scene)
    assert choice.command is not None
    assert choice.command.v > 0.9
    assert choice.refusals["moving obstacle"] > 0


def test_the_robot_brakes_for_obstacles_that_it_cannot_pass():
    row = [MovingObstacle(4.4, 4.0 + y, -1.0, 0.0, 0.3) for y in (-2.0, -1.0, 0.0, 1.0, 2.0)]
    choice = choose(empty(), (3.0, 4.0, 0.0), Twist(1.0, 0.0), moving=row)
    assert choice.command is None or choice.command.v < 0.95
    assert choice.refusals["moving obstacle"] > 0


def test_a_manoeuvre_has_to_be_clear_for_as_long_as_a_stop_takes():
    """Head-on at 1 m/s each, contact in 1.75 s and in 1 s; a stop takes 1.25 s and a period."""
    pose, twist = Pose2D(1.5, 4.0, 0.0), Twist(1.0, 0.0)
    shut = boxed((0.5, 3.0, 7.5, 3.3), (0.5, 4.7, 7.5, 5.0))  # a corridor without room to pass
    for gap, refused in ((2.0 * 1.75, False), (2.0 * 1.0, True)):
        obstacle = MovingObstacle(pose.x + 0.6 + gap, 4.0, -1.0, 0.0, 0.3)
        scene = scene_of(shut, moving=[obstacle], last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW))
        choice = DynamicWindow(ROUND, DwaConfig(), PERIOD).choose(pose, twist, scene)
        fast = choice.samples[:, 0] > 0.99
        assert fast.any()
        assert (choice.refused[fast] == MOVING).all() == refused


def test_a_command_that_leads_into_unseen_space_is_refused_whatever_else_moves():
    """All that the robot can do brings it nearer to unseen space than it can rest in time."""
    distance = np.repeat(np.linspace(6.0, -2.0, 80)[None], 80, axis=0)
    pose, twist = Pose2D(4.0, 4.0, 0.0), Twist(1.0, 0.0)
    for moving in ([], [MovingObstacle(1.0, 7.0, 0.0, 0.3, 0.3)]):
        for speed, drives in ((2.0, False), (0.0, True)):
            scene = scene_of(
                empty(),
                moving=moving,
                hidden=hidden_in(distance, speed),
                last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW),
            )
            choice = DynamicWindow(ROUND, DwaConfig(), PERIOD).choose(pose, twist, scene)
            assert (choice.command is not None) == drives
            assert (choice.refusals["unseen space"] > 0) == (not drives)


def test_who_is_there_counts_for_more_than_who_may_step_out():
    """The robot drives on towards unseen space where a stop would end in a walker's way, and else not."""
    distance = np.repeat(np.linspace(6.0, -2.0, 80)[None], 80, axis=0)
    pose, twist = Pose2D(3.0, 4.0, 0.0), Twist(1.0, 0.0)
    stops_at = pose.x + 0.5 / LIMITS.v_brake
    for x, drives in ((stops_at - 0.4, True), (stops_at + 2.0, False)):
        walker = MovingObstacle(x, 4.0 + 2.4, 0.0, -1.0, 0.3)
        scene = scene_of(
            empty(), moving=[walker], hidden=hidden_in(distance, 2.0),
            last=Manoeuvre(1.0, 0.0, 0.5, FOLLOW),
        )  # fmt: skip
        choice = DynamicWindow(ROUND, DwaConfig(), PERIOD).choose(pose, twist, scene)
        assert (choice.command is not None) == drives


def test_samples_are_all_pairs_of_reachable_speeds():
    twist = Twist(0.4, 0.2)
    choice = choose(empty(), (4.0, 4.0, 0.0), twist, config=DwaConfig(reach=0.5))
    samples = choice.samples[SAMPLES:]
    speeds, rates = np.unique(samples[:, 0]), np.unique(samples[:, 1])
    assert len(samples) == len(speeds) * len(rates) == len({tuple(s) for s in samples})
    state = state_at(4.0, 4.0, 0.0, *twist)
    window = reachable(state, LIMITS, possible(LIMITS, LIMITS.v_max), 0.5)
    assert (speeds[0], speeds[-1]) == pytest.approx((window.low_v, window.high_v))
    assert (rates[0], rates[-1]) == pytest.approx((window.low_omega, window.high_omega))
    assert 0.0 in rates


def test_without_room_in_the_window_there_is_one_sample():
    tight = Limits(1.0, 1.5, 0.01, 0.01, 0.01, 0.01)
    scene = scene_of(empty(), v_cap=0.0)
    window = DynamicWindow(Robot("tight", tight, Footprint.disc(0.3)), DwaConfig(reach=0.0), 1e-9)
    choice = window.choose(Pose2D(4.0, 4.0, 0.0), Twist(0.0, 0.3), scene)
    assert len(choice.samples) == SAMPLES + 1
    assert choice.samples[SAMPLES] == pytest.approx((0.0, 0.3))


def test_a_stop_is_certified_from_every_state_given():
    near_wall = StopStart(Pose2D(5.2, 4.0, 0.0), Twist(1.0, 0.0), PERIOD)
    far = StopStart(Pose2D(2.0, 4.0, 0.0), Twist(1.0, 0.0), PERIOD)
    scene, window = scene_of(boxed((6.0, 0.0, 6.2, 8.0))), DynamicWindow(ROUND, DwaConfig(), PERIOD)
    for stops, admitted in (
        ([far], True), ([near_wall], False), ([near_wall, far], False), ([far, near_wall], False)
    ):  # fmt: skip
        assert window.admits(scene.around, stops, Twist(1.0, 0.0)) == admitted
        choice = window.choose(far.pose, far.twist, scene, stops)
        assert (choice.refusals["no certified stop"] == 0) == admitted


def test_no_command_is_below_the_least_speeds_of_the_drive():
    slow = LIMITS._replace(v_accel=0.3, omega_accel=0.5, v_least=0.1, omega_least=0.2)
    robot = Robot("deadband", slow, Footprint.disc(0.3))
    commands = [
        choice.command
        for _, _, choice in drive(empty(), (1.0, 2.0, 2.5), (7.0, 4.0), 12.0, robot)
        if choice.command is not None
    ]
    assert len(commands) > 100
    for v, omega in commands:
        assert v == 0.0 or abs(v) >= 0.1
        assert omega == 0.0 or abs(omega) >= 0.2
    assert sum(v > 0.5 for v, _ in commands) > 20


def slow_choice(rules, state, scene, choice):
    """Refusals, best tails, scores and terms of a choice's candidates, one by one."""
    limits, schedule = rules.limits, rules.schedule
    gap = least_clearance(scene.distance_to_obstacle, rules.body, state.pose) - scene.margin
    rows = np.zeros(len(schedule.step), ROW)
    rows[0] = (*state.pose, state.v, gap, True)
    here = state_value(scene.cost_to_go, limits, rows.view(np.recarray)[0], rows[0]["v"])
    start, moving = start_of(rules, state, gap, here), scene.around.moving
    roll_out(scene, rules, start, Manoeuvre(0.0, 0.0, 0.0, STOP), rows)
    in_the_way = not passes_clear(moving, rules, rows, 99.0)
    for i, (v, omega) in enumerate(choice.samples):
        command = (
            slew(state.v, v, limits.v_accel, limits.v_brake, PERIOD),
            slew(state.omega, omega, limits.omega_accel, limits.omega_brake, PERIOD),
        )
        code = rests_in_time(scene.around, rules, state, command)
        clear_for = {
            MOVING: scene.around.latency + PERIOD + stopping_time(*command, limits),
            HIDDEN: 99.0,
        }
        short = schedule.held * schedule.period
        kinds = [(short, tail) for tail in (FOLLOW, STOP, BACK)]
        if abs(v) >= 0.1 * limits.v_max and abs(omega) <= 2.0:
            kinds += [(1.5, tail) for tail in (FOLLOW, STOP)]
        if i == FOLLOW_NOW:
            kinds = [(schedule.period, FOLLOW)]
        if i == LAST:
            kinds = [(scene.last.hold, scene.last.tail)]
        best, risked = (-np.inf, None), True
        for hold, tail in kinds if code != HIDDEN or in_the_way else []:
            risked |= tail == FOLLOW
            if not risked:
                continue
            manoeuvre = Manoeuvre(v, omega, hold, tail)
            roll_out(scene, rules, start, manoeuvre, rows)
            if code in clear_for and not passes_clear(moving, rules, rows, clear_for[code]):
                continue
            terms = evaluate(scene, rules, start, manoeuvre, rows)
            risked = tail != FOLLOW or terms.risk > 0.0
            total = objective(scene, rules, terms) - (0.0 if i == LAST else rules.config.hysteresis)
            if total > best[0]:
                best = total, terms
        stops = certified_stop(scene.around, rules, state, command, PERIOD) == ADMISSIBLE
        yield ADMISSIBLE if best[1] else code, *best, stops


@given(st.integers(0, 10**6), st.sampled_from([0, 1, 2]), st.sampled_from([1.0, 1.8, 4.0]))
@settings(max_examples=60, deadline=None)
def test_every_candidate_is_refused_or_scored_by_its_best_manoeuvre(seed, count, spread):
    random = np.random.default_rng(seed)
    pose = Pose2D(*random.uniform(2.0, 6.0, 2), random.uniform(-3.0, 3.0))
    twist = Twist(random.uniform(-0.3, 1.0), random.uniform(-1.0, 1.0))
    moving = [
        MovingObstacle(*random.normal(pose[:2], spread), *random.uniform(-1.2, 1.2, 2), 0.3)
        for _ in range(count)
    ]
    last = Manoeuvre(0.4, 0.1, random.choice([0.0, 0.3]), int(random.choice([FOLLOW, STOP, BACK])))
    closed, latency = scattered(random, random.choice([0.0, 0.001])), random.uniform(0.0, 0.6)
    ahead = twist.v * random.uniform(0.5, 1.5)  # m, to where a stop ends, more or less
    place = pose.x + ahead * math.cos(pose.theta), pose.y + ahead * math.sin(pose.theta)
    if count > 0:  # somebody gets there soon
        late, way = random.uniform(0.5, 3.0), random.uniform(-3.0, 3.0)
        v = math.cos(way), math.sin(way)
        moving[0] = MovingObstacle(place[0] - late * v[0], place[1] - late * v[1], *v, 0.3)
    corner = np.hypot(*np.indices((80, 80)) * 0.1 - np.reshape(place[::-1], (2, 1, 1))) + ahead
    hidden = hidden_in(corner, random.choice([0.0, 0.5, 2.0]))
    scene = scene_of(closed, moving=moving, latency=latency, last=last, hidden=hidden)
    window = DynamicWindow(ROUND, DwaConfig(), PERIOD)
    choice, state = window.choose(pose, twist, scene), state_at(*pose, *twist)
    refused, score, terms, stops = zip(
        *slow_choice(window.rules, state, scene, choice), strict=True
    )
    highest = max((s for s, stop in zip(score, stops, strict=True) if stop), default=-np.inf)
    above = np.array(score) > highest  # of no use: without a certified stop
    assert choice.refused.tolist() == np.where(above, NO_STOP, refused).tolist()
    assert choice.score == pytest.approx(np.where(above, -np.inf, score))
    assert (choice.command is None) == (highest == -np.inf)
    if choice.command is not None:
        assert (choice.samples[choice.score.argmax()] == choice.manoeuvre[:2]).all()
    for found, wanted in zip(choice.terms, terms, strict=True):
        assert wanted is None or found == pytest.approx(np.array(wanted))


def test_the_first_two_candidates_are_the_last_manoeuvre_and_to_follow_at_once():
    rules, pose, twist = rules_for(ROUND), Pose2D(2.0, 4.0, 0.4), Twist(0.3, 0.1)
    scene = scene_of(empty(), last=Manoeuvre(0.35, 0.2, 0.3, BACK))
    window = DynamicWindow(ROUND, DwaConfig(), PERIOD)
    state = state_at(*pose, *twist)
    gap = least_clearance(scene.distance_to_obstacle, rules.body, state.pose) - scene.margin
    follow = tail_speeds(scene.cost_to_go, rules, state, gap, FOLLOW)
    back = tail_speeds(scene.cost_to_go, rules, state, gap, BACK)
    lowest = slew(0.3, LIMITS.v_min, LIMITS.v_accel, LIMITS.v_brake, rules.config.reach)
    samples = window.choose(pose, twist, scene).samples
    assert samples[LAST] == pytest.approx((0.35, 0.2))
    assert samples[FOLLOW_NOW] == pytest.approx(follow)
    ended = window.choose(pose, twist, scene._replace(last=Manoeuvre(0.35, 0.2, 0.0, BACK)))
    assert ended.samples[LAST] == pytest.approx((max(back[0], lowest), back[1]))


@given(st.sampled_from(sorted(ROBOTS)), st.floats(0, 1), st.floats(-1, 1), st.integers(0, 10**6))
@settings(max_examples=40, deadline=None)
def test_the_choice_is_the_admissible_sample_with_the_highest_score(name, v, omega, seed):
    robot, random = ROBOTS[name], np.random.default_rng(seed)
    closed = scattered(random, 0.001)
    limits = robot.limits
    twist = Twist(v * limits.v_max, omega * limits.omega_max)
    choice = choose(closed, (*random.uniform(2, 6, 2), random.uniform(-3, 3)), twist, robot)
    admitted = choice.refused == 0
    assert sum(choice.refusals.values()) == (~admitted).sum()
    assert (np.isfinite(choice.score) == admitted).all()  # what ends early is scored, too
    if choice.command is None:
        assert not np.isfinite(choice.score).any()
        return
    best = int(np.argmax(choice.score))
    assert choice.manoeuvre[:2] == tuple(choice.samples[best])
    assert limits.v_min - 1e-9 <= choice.command.v <= limits.v_max + 1e-9
    assert abs(choice.command.omega) <= limits.omega_max + 1e-9
    wanted = choice.manoeuvre
    assert choice.command.v == pytest.approx(
        slew(twist.v, wanted.v, limits.v_accel, limits.v_brake, PERIOD)
    )
    assert choice.command.omega == pytest.approx(
        slew(twist.omega, wanted.omega, limits.omega_accel, limits.omega_brake, PERIOD)
    )
