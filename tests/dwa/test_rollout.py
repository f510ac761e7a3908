import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from dynastar import robot as drive
from dynastar.dwa import DwaConfig
from dynastar.dwa.clearance import ROUNDING, clearance_slack, least_clearance
from dynastar.dwa.motion import Pose, state_at
from dynastar.dwa.rollout import (
    RIM,
    ROW,
    follow,
    is_on_map,
    roll_out,
    schedule_of,
    tail_speeds,
)
from dynastar.dwa.scene import BACK, FOLLOW, STOP, TAILS, Manoeuvre
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import ROBOTS, Limits, Robot
from naive import mean_speed
from scenes import CELL, boxed, empty, field_of, rules_for, scattered, scene_of, start_of

LIMITS = Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0, v_min=-0.3)
ROUND = Robot("round", LIMITS, Footprint.disc(0.3))
SHAPES = {"round": ROUND, "box": Robot("box", LIMITS, ROBOTS["jackal"].footprint)}
EMPTY = scene_of(empty(), goal=(4.0, 4.0))


@given(st.integers(1, 40), st.integers(2, 20), st.integers(1, 8))
def test_the_schedule_has_every_step_while_a_sample_is_held_and_then_every_second(held, n, looks):
    steps = looks * n
    schedule = schedule_of(0.1, held, steps, looks)
    rows, k = [], 0
    while k < max(held, steps):
        k = k + 1 if k < held else min(k + 2, steps)
        rows.append(k)
    assert schedule.step.tolist() == rows
    durations = [0.1 * (after - before) for before, after in pairwise([0, *rows])]
    assert schedule.duration == pytest.approx(durations)
    for look, row in enumerate(schedule.lookups):  # the first row at or after each eighth
        due = (look + 1) * n
        assert rows[row] >= due
        assert row == 0 or rows[row - 1] < due
    assert (schedule.held, schedule.period, len(schedule.lookups)) == (held, 0.1, looks)


def rolled(scene, rules, state, manoeuvre):
    """The rows of a roll-out, and its start."""
    gap = least_clearance(scene.distance_to_obstacle, rules.body, state.pose) - scene.margin
    start, rows = start_of(rules, state, gap, 3.0), np.zeros(len(rules.schedule.step), ROW)
    roll_out(scene, rules, start, manoeuvre, rows)
    return rows, start


def slow_roll_out(scene, rules, start, manoeuvre):
    """The same in Python, rows as tuples."""
    limits, schedule, at = rules.limits, rules.schedule, start.state.pose
    pose = Pose2D(at.x, at.y, math.atan2(at.sin, at.cos))
    twist, gap = Twist(start.state.v, start.state.omega), start.gap
    held = max(1, round(manoeuvre.hold / schedule.period))
    solid = scene.around.closed._replace(distance=scene.distance_to_obstacle)
    rows, rests, inside = [], False, True
    for i, duration in enumerate(schedule.duration):
        wanted = manoeuvre.v, manoeuvre.omega
        if (schedule.step[i - 1] if i else 0) >= held:
            state = state_at(*pose, *twist)
            wanted = tail_speeds(scene.cost_to_go, rules, state, gap, manoeuvre.tail)
        if (*twist, *wanted) != (0.0, 0.0, 0.0, 0.0) and inside and not rests:
            after = Twist(
                drive.slew(twist.v, wanted[0], limits.v_accel, limits.v_brake, duration),
                drive.slew(
                    twist.omega, wanted[1], limits.omega_accel, limits.omega_brake, duration
                ),
            )
            mean = Twist(
                mean_speed(twist.v, wanted[0], limits.v_accel, limits.v_brake, duration),
                mean_speed(
                    twist.omega, wanted[1], limits.omega_accel, limits.omega_brake, duration
                ),
            )
            pose, twist = drive.arc(pose, mean, duration), after
            at = Pose(pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta))
            inside = all(RIM * 2 * CELL <= c <= 8.0 - RIM * 2 * CELL for c in pose[:2])
            gap = least_clearance(scene.distance_to_obstacle, rules.body, at) - scene.margin
            slack = clearance_slack(
                solid, rules.body, scene.around.margin_to_closed, start.state.pose, at
            )
            rests = inside and slack < -ROUNDING
        rows.append((*at, twist.v, gap, inside))
    return rows


def random_case(seed, names):
    """A random scene, state and manoeuvre of a robot."""
    random = np.random.default_rng(seed)
    robot = SHAPES[names]
    rules = rules_for(robot)
    closed = scattered(random, random.choice([0.0, 0.0005, 0.002]))
    scene = scene_of(closed, tuple(random.uniform(1.0, 7.0, 2)), radius=robot.footprint.inscribed)
    v, omega = random.uniform(-0.3, 1.0), random.uniform(-1.5, 1.5)
    state = state_at(*random.uniform(0.7, 7.3, 2), random.uniform(-4.0, 4.0), v, omega)
    hold = random.choice([0.0, 0.1, 0.32, rules.schedule.held * rules.schedule.period])
    manoeuvre = Manoeuvre(
        random.uniform(-0.3, 1.0), random.uniform(-1.5, 1.5), hold, int(random.choice(TAILS))
    )
    return scene, rules, state, manoeuvre


@given(st.integers(0, 10**6), st.sampled_from(sorted(SHAPES)))
@example(2722, "box")  # a contact half-way between two probes
@settings(max_examples=100, deadline=None)
def test_a_roll_out_is_what_the_robots_own_motion_gives(seed, name):
    scene, rules, state, manoeuvre = random_case(seed, name)
    rows, start = rolled(scene, rules, state, manoeuvre)
    for row, by_hand in zip(rows, slow_roll_out(scene, rules, start, manoeuvre), strict=True):
        assert row.item() == pytest.approx(by_hand, abs=1e-6)


@given(st.integers(0, 10**6), st.sampled_from(sorted(SHAPES)))
@settings(max_examples=100, deadline=None)
def test_every_row_keeps_the_limits_of_the_robot(seed, name):
    scene, rules, state, manoeuvre = random_case(seed, name)
    rows, start = rolled(scene, rules, state, manoeuvre)
    before = start.state.pose.x, start.state.pose.y, state.v
    for row, duration in zip(rows, rules.schedule.duration, strict=True):
        assert math.hypot(row["cos"], row["sin"]) == pytest.approx(1.0)
        assert LIMITS.v_min - 1e-9 <= row["v"] <= LIMITS.v_max + 1e-9
        assert abs(row["v"] - before[2]) <= LIMITS.v_brake * duration + 1e-9  # as accelerating
        driven = math.dist((row["x"], row["y"]), before[:2])
        assert driven <= max(abs(row["v"]), abs(before[2])) * duration + 1e-9
        before = row["x"], row["y"], row["v"]
    assert (np.diff(rows["on_map"].astype(int)) <= 0).all()  # no return onto the map
    assert (rows["gap"] >= min(0.0, start.gap) - LIMITS.v_max * 0.2 - CELL).all()


@pytest.mark.parametrize("way", [0.2, 0.45])  # m, before and after the sample's end
def test_a_roll_out_stays_where_it_touches_whenever_that_is(way):
    rules, ahead = rules_for(ROUND), state_at(3.0, 4.0, 0.0, 0.8, 0.0)
    scene = scene_of(boxed((3.3 + 0.05 + way, 0.0, 8.0, 8.0)))
    rows, _ = rolled(scene, rules, ahead, Manoeuvre(0.8, 0.0, 0.5, FOLLOW))
    assert rows["x"].max() == rows["x"][-1] == pytest.approx(3.0 + way, abs=0.1)


def test_a_wall_on_the_map_that_lies_deep_in_unseen_space_ends_a_roll_out():
    """Nothing beyond x = 3.5 m was seen; on the map there is a wall 1.5 m behind that."""
    rules, ahead = rules_for(ROUND), state_at(3.0, 4.0, 0.0, 0.8, 0.0)
    wall, unseen = boxed((5.0, 0.0, 5.2, 8.0)), boxed((3.5, 0.0, 8.0, 8.0))
    scene = scene_of(wall)
    hidden = scene.around.closed._replace(distance=field_of(unseen), occupied=unseen & False)
    scene = scene._replace(around=scene.around._replace(closed=hidden))
    rows, _ = rolled(scene, rules, ahead, Manoeuvre(0.8, 0.0, 9.0, FOLLOW))
    assert 4.4 < rows["x"].max() <= 5.0 - 0.3 + CELL


def pose_columns(rows):
    return np.column_stack([rows[name] for name in ("x", "y", "cos", "sin")])


def test_rows_after_a_contact_of_the_tail_and_off_the_map_repeat_the_last_pose():
    rules = rules_for(ROUND)
    scene = scene_of(boxed((1.9, 0.0, 2.1, 8.0)))
    state, reverse = state_at(2.8, 4.0, 0.0, 0.0, 0.0), Manoeuvre(0.0, 0.0, 0.5, BACK)
    rows, _ = rolled(scene, rules, state, reverse)
    blocked = int(np.argmax(rows["gap"] < 0.0))
    assert 0 < blocked < len(rows) - 2
    assert (pose_columns(rows)[blocked:] == pose_columns(rows)[blocked]).all()
    assert rows["on_map"].all()
    away, held = state_at(7.4, 4.0, 0.0, 0.8, 0.0), Manoeuvre(1.0, 0.0, 4.0, STOP)
    free = scene_of(np.zeros_like(empty()), radius=0.3, cost_to_go=EMPTY.cost_to_go)
    rows, _ = rolled(free, rules, away, held)
    left = int(np.argmin(rows["on_map"]))
    assert 0 < left < len(rows) - 2
    assert rows["x"][left - 1] <= 8.0 - RIM * 2 * CELL < rows["x"][left]
    assert (pose_columns(rows)[left:] == pose_columns(rows)[left]).all()
    assert not rows["on_map"][left:].any()


@pytest.mark.parametrize("theta", [0.0, 1.0, 3.0, -2.0])
def test_the_tail_that_follows_the_cost_to_go_ends_near_the_goal(theta):
    """8 s are enough to turn round and drive 1.5 m."""
    rules = rules_for(ROUND, DwaConfig(horizon=8.0))
    state = state_at(2.5, 4.0, theta, 0.0, 0.0)
    rows, _ = rolled(EMPTY, rules, state, Manoeuvre(0.0, 0.0, 0.1, FOLLOW))
    assert math.dist((rows["x"][-1], rows["y"][-1]), (4.0, 4.0)) < 0.2
    assert abs(rows["v"][-1]) < 0.3


def test_the_tail_that_stops_is_at_rest_after_the_time_of_a_stop():
    rules = rules_for(ROUND)
    state, held = state_at(2.0, 4.0, 0.0, 0.9, 0.0), Manoeuvre(0.9, 1.0, 0.5, STOP)
    rows, _ = rolled(EMPTY, rules, state, held)
    stop = drive.stopping_time(Twist(0.9, 1.0), LIMITS)
    times = 0.1 * rules.schedule.step
    assert (rows["v"][times < 0.5 + 0.9 * stop] > 0.0).all()
    at_rest = times >= 0.5 + stop + 0.2  # the last step may end later than the stop
    assert at_rest.sum() > 3
    assert (rows["v"][at_rest] == 0.0).all()
    assert (pose_columns(rows)[at_rest] == pose_columns(rows)[at_rest][0]).all()


def test_the_tail_that_reverses_drives_straight_back_at_the_lowest_speed():
    rules = rules_for(ROUND)
    state, held = state_at(5.0, 4.0, 0.0, 0.4, 0.0), Manoeuvre(0.4, 0.0, 0.5, BACK)
    rows, _ = rolled(EMPTY, rules, state, held)
    assert rows["v"][-1] == pytest.approx(LIMITS.v_min)
    assert rows["y"] == pytest.approx(4.0)
    back = rows["v"] < 0.0
    assert back.sum() > 10
    assert (np.diff(rows["x"][back]) < 0.0).all()
    assert rows["x"][-1] < rows["x"].max() - 0.5


@given(
    st.tuples(st.floats(1.0, 7.0), st.floats(1.0, 7.0)), st.floats(-4, 4), st.floats(-0.3, 1.0),
    st.floats(-0.05, 1.0), st.floats(0.0, 0.5),
)  # fmt: skip
@settings(deadline=None)
def test_to_follow_is_to_turn_to_the_descent_and_to_be_able_to_stop_at_the_goal(
    place, theta, v, gap, step
):
    state, goal = state_at(*place, theta, v, 0.0), (4.0, 4.0)
    left = math.dist(place, goal)
    to_v, to_omega = follow(EMPTY.cost_to_go, LIMITS, 0.25, state, gap, step)
    assert 0.0 <= to_v <= LIMITS.v_max
    assert abs(to_omega) <= LIMITS.omega_max
    assert to_v * step + to_v**2 / (2.0 * LIMITS.v_brake) <= 1.1 * left + 0.15
    ahead = 0.5 * v * LIMITS.omega_max / LIMITS.omega_accel  # where the rate has changed
    from_there = place[0] + ahead * math.cos(theta), place[1] + ahead * math.sin(theta)
    bearing = math.atan2(goal[1] - from_there[1], goal[0] - from_there[0])
    off = math.remainder(bearing - theta, math.tau)
    if math.dist(from_there, goal) > 0.5 and 0.3 < abs(off) < 2.8:
        assert math.copysign(1.0, to_omega) == math.copysign(1.0, off)
    if math.dist(from_there, goal) > 0.5 and abs(off) > 1.0:
        assert to_v < 0.05  # it turns first
    assert follow(EMPTY.cost_to_go, LIMITS, 0.25, state, 0.0, step)[0] <= 0.2 * LIMITS.v_max + 1e-9


def test_tails_ask_for_their_speeds():
    rules, state = rules_for(ROUND), state_at(2.0, 4.0, 0.5, 0.4, 0.0)
    speeds = [tail_speeds(EMPTY.cost_to_go, rules, state, 0.2, tail) for tail in TAILS]
    assert speeds[STOP] == (0.0, 0.0)
    assert speeds[BACK] == (LIMITS.v_min, 0.0)
    step = 2.0 * rules.schedule.period
    expected = follow(EMPTY.cost_to_go, LIMITS, rules.config.comfort, state, 0.2, step)
    assert speeds[FOLLOW] == expected


@pytest.mark.parametrize(
    ("x", "y", "on_map"),
    [(0.2, 0.2, True), (0.19, 4.0, False), (4.0, 7.81, False), (7.8, 7.8, True), (9.0, 4.0, False)],
)
def test_the_map_ends_two_cells_inside_the_border_of_the_cost_to_go(x, y, on_map):
    assert is_on_map(EMPTY.cost_to_go.value, x, y) == on_map
