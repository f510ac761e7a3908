"""Ways over poses: each move is free by the slow oracle, and long robots get out of where they stand."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa.motion import moved, state_at
from dynastar.dwa.pose_search import STEP, TURN, search_poses
from dynastar.footprint import Footprint
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from naive import slack_of_constraint
from scenes import CELL, boxed, boxes_of, rules_for, scattered, scene_of

LIMITS = Limits(0.6, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3)
SHAPE = Footprint.polygon([(0.85, -0.25), (0.85, 0.25), (-0.15, 0.25), (-0.15, -0.25)])
CART = Robot("cart", LIMITS, SHAPE, Lidar())
MARGIN, GAIN = 0.03, 1.0


def way_from(scene, robot, x, y, theta):
    return search_poses(scene, rules_for(robot), state_at(x, y, theta, 0.0, 0.0), GAIN, 0.0)


def moves_of(way, x, y, theta):
    """Each move of a way: the pose before it, its length (m) and its angle (rad)."""
    before = state_at(x, y, theta, 0.0, 0.0).pose
    for row in way:
        after = state_at(*row[:3], 0.0, 0.0).pose
        sin = before.cos * after.sin - before.sin * after.cos
        angle = math.atan2(sin, before.cos * after.cos + before.sin * after.sin)
        yield before, row[3] * STEP * CELL, angle, after
        before = after


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_every_move_is_one_that_the_robot_can_make_and_keeps_clear(seed):
    random = np.random.default_rng(seed)
    scene = scene_of(scattered(random, random.choice([0.001, 0.004])), margin=MARGIN)
    x, y, theta = *random.uniform(1.5, 6.5, 2), random.uniform(-4, 4)
    start, boxes = state_at(x, y, theta, 0.0, 0.0).pose, boxes_of(scene.around.closed)
    for before, length, angle, after in moves_of(way_from(scene, CART, x, y, theta), x, y, theta):
        assert round(angle / TURN, 6) in (-1, 0, 1)
        end = moved(before, length, angle)
        assert math.dist(end[:2], after[:2]) < 1e-9
        for part in np.linspace(0.0, 1.0, 9):
            at = moved(before, part * length, part * angle)
            slack = slack_of_constraint(boxes, CART.footprint, MARGIN, start, at)
            assert slack > -0.5 * CELL  # between the poses that are looked at


JUNCTION = boxed((0.0, 4.5, 8.0, 8.0), (0.0, 0.0, 3.5, 3.5), (4.5, 0.0, 8.0, 3.5))


def test_a_cart_backs_out_of_a_corridor_whose_junction_it_has_passed():
    x, y, theta = 3.9, 4.0, math.pi  # the nose is 0.4 m behind the corner
    scene = scene_of(JUNCTION, goal=(4.0, 0.5), radius=0.28, margin=MARGIN)
    way = way_from(scene, CART, x, y, theta)
    assert len(way) > 0
    assert way[0, 3] < 0.0
    assert way[-1, 1] < 3.5
    assert abs(math.remainder(way[-1, 2] + 0.5 * math.pi, math.tau)) < 0.6


def test_a_robot_that_does_not_reverse_is_not_led_back():
    limits = LIMITS._replace(v_min=0.0)
    robot = Robot("cart", limits, SHAPE, Lidar())
    scene = scene_of(JUNCTION, goal=(4.0, 0.5), radius=0.28, margin=MARGIN)
    assert len(way_from(scene, robot, 3.9, 4.0, math.pi)) == 0


def test_from_where_the_way_is_clear_it_drives_straight_ahead():
    way = way_from(scene_of(boxed()), ROBOTS["jackal"], 2.0, 4.0, 0.0)
    assert set(way[:, 3]) == {1.0}
    assert GAIN <= way[-1, 0] - 2.0 <= GAIN + 2.0 * STEP * CELL
    assert np.ptp(way[:, 1]) < 0.2


def test_none_leads_through_a_gap_as_narrow_as_the_robot():
    closed = boxed((4.0, 0.0, 4.2, 3.75), (4.0, 4.25, 4.2, 8.0))
    scene = scene_of(closed, goal=(7.0, 4.0), radius=0.2, margin=MARGIN)
    assert len(way_from(scene, CART, 2.9, 4.0, 0.0)) == 0


@pytest.mark.parametrize("y", [4.0, 4.6])
def test_it_keeps_away_from_somebody_who_moves(y):
    walker = MovingObstacle(4.0, y, 0.0, 0.0, 0.3)
    scene, robot = scene_of(boxed(), moving=(walker,), margin=MARGIN), ROBOTS["jackal"]
    for x, py, *_ in way_from(scene, robot, 2.0, 4.0, 0.0):
        away = robot.footprint.circumscribed + 0.3 + rules_for(robot).config.personal_space
        assert math.hypot(x - 4.0, py - y) >= away
