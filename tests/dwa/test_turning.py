import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa.motion import Pose, state_at
from dynastar.dwa.turning import KEPT_WITHIN, has_room_to_turn, place_to_turn
from dynastar.footprint import Footprint
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from naive import slack_of_constraint
from scenes import CELL, boxed, boxes_of, rules_for, scattered, scene_of

LIMITS = Limits(0.6, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3)
CART = Robot(
    "cart",
    LIMITS,
    Footprint.polygon([(0.85, -0.25), (0.85, 0.25), (-0.15, 0.25), (-0.15, -0.25)]),
    Lidar(),
)
JACKAL = ROBOTS["jackal"]
MARGIN = 0.03


def at(x, y, theta):
    return state_at(x, y, theta, 0.0, 0.0).pose


def room_to_turn(scene, robot, pose, angle, spare=0.0, short_by=0.0):
    return has_room_to_turn(scene, rules_for(robot), pose, pose, angle, (spare, short_by))


@given(st.sampled_from([CART, JACKAL]), st.integers(0, 10**6), st.floats(-6.3, 6.3))
@settings(max_examples=30, deadline=None)
def test_there_is_room_if_and_only_if_the_footprint_keeps_clear_all_the_way_round(
    robot, seed, angle
):
    random = np.random.default_rng(seed)
    scene = scene_of(scattered(random, random.choice([0.0005, 0.003])), margin=MARGIN)
    x, y, theta = *random.uniform(1.5, 6.5, 2), random.uniform(-4, 4)
    start, boxes = at(x, y, theta), boxes_of(scene.around.closed)
    least = min(
        slack_of_constraint(boxes, robot.footprint, MARGIN, start, at(x, y, theta + part * angle))
        for part in np.linspace(0.0, 1.0, 200)
    )
    found = room_to_turn(scene, robot, start, angle)
    assert found == (least >= 0.0) or abs(least) < 0.3 * CELL


def test_a_long_robot_beside_a_wall_turns_the_way_round_that_leads_away_from_it():
    scene = scene_of(boxed((0.0, 4.6, 8.0, 8.0)), margin=MARGIN)
    pose = at(4.0, 4.0, 0.0)
    assert not room_to_turn(scene, CART, pose, math.pi)
    assert room_to_turn(scene, CART, pose, -math.pi)
    assert room_to_turn(scene, CART, pose, 0.4)
    assert not room_to_turn(scene, CART, pose, 0.9)
    assert room_to_turn(scene, CART, pose, 0.9, short_by=0.5)
    gap = 4.625 - 4.0 - (0.85 * math.sin(0.4) + 0.25 * math.cos(0.4))
    assert not room_to_turn(scene, CART, pose, 0.4, spare=gap - MARGIN + 0.02)


def test_the_place_to_turn_is_the_nearest_to_the_goal_with_room():
    scene = scene_of(boxed((0.0, 4.6, 8.0, 8.0)), margin=MARGIN)
    pose, heading, tolerance, need = at(3.7, 4.0, 0.0), 2.4, 0.5, (0.02, 0.0)
    found, x, y = place_to_turn(scene, rules_for(CART), pose, (4.0, 4.0, heading), tolerance, need)
    assert found
    assert math.dist((x, y), (4.0, 4.0)) <= KEPT_WITHIN * tolerance
    reach = 0.85 * math.sin(heading) - 0.25 * math.cos(heading)
    highest = 4.625 - MARGIN - 0.02 - reach  # from where the nose does not touch the wall
    assert highest - 0.1 < y <= highest + 1e-6


@pytest.mark.parametrize("tolerance", [0.05, 0.15])
def test_in_a_corridor_narrower_than_the_diagonal_there_is_no_place_to_turn(tolerance):
    scene = scene_of(boxed((0.0, 4.3, 8.0, 8.0), (0.0, 0.0, 8.0, 3.7)), margin=MARGIN)
    found, _, _ = place_to_turn(
        scene, rules_for(JACKAL), at(3.0, 4.0, 0.0), (4.0, 4.0, math.pi), tolerance, (0.0, 0.1)
    )
    assert not found


def test_an_obstacle_at_the_place_is_not_excused_by_standing_in_it():
    """Only what the robot is near to already may be as near."""
    scene = scene_of(boxed((3.9, 3.9, 4.1, 4.1)), margin=MARGIN)
    start, place = at(2.0, 4.0, 0.0), Pose(4.0, 4.0, 1.0, 0.0)
    rules, need = rules_for(JACKAL), (0.0, 0.0)
    assert not has_room_to_turn(scene, rules, start, place, 0.1, need)
    assert has_room_to_turn(scene, rules, start, start, math.tau, need)
