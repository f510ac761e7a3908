"""Past movers: out of their way, on before them, and always able to stop for what stands."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import Margins, Passing, Start, Surroundings, stop_kernels
from dynastar.dwa.dwa import body_of
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Footprint, Limits, Robot, arc, slew

LIMITS = Limits(1.0, 1.5, 1.0, 2.0, 1.0, 2.0)
ROBOT = Robot("round", LIMITS, Footprint.disc(0.3))
MARGINS = Margins(0.05, 0.15, 0.1)
HERE = Pose2D(5.0, 5.0, 0.0)
OPEN = np.full((200, 200), 9.0, np.float32)
PATH = np.column_stack([5.0 + 0.1 * np.arange(30), np.full(30, 5.0), np.full(30, 9.0)])


def past(movers, field=OPEN):
    return Surroundings(field, 0.0, 0.0, 0.05, np.array(movers, float).reshape(-1, 6))


def evade(movers, twist=Twist(0.0, 0.0), field=OPEN, robot=ROBOT):
    return Passing(robot, 0.1).evade(Start(HERE, twist, past(movers, field), PATH, MARGINS))


@pytest.mark.parametrize("v_min", [0.0, -0.5])
@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2, 1.6, 2.0, -1.6, math.pi])
def test_a_robot_at_rest_leaves_the_way_of_what_comes(angle, v_min):
    """Taken again and again as it is taken, the way out keeps the mover off."""
    side = np.array([math.cos(angle), math.sin(angle)])
    mover, velocity = HERE[:2] + 3.0 * side, -0.8 * side
    at, twist, least = HERE, Twist(0.0, 0.0), math.inf
    passing = Passing(Robot("", LIMITS._replace(v_min=v_min), ROBOT.footprint), 0.1)
    for _ in range(70):
        around = past([(*mover, *velocity, 0.3, 0.8)])
        command = passing.evade(Start(at, twist, around, PATH, MARGINS))
        assert least < math.inf or command is not None
        if command is None:
            command = Twist(
                slew(twist.v, 0.0, 1.0, 1.0, 0.1), slew(twist.omega, 0.0, 2.0, 2.0, 0.1)
            )
        assert v_min <= command.v <= twist.v + LIMITS.v_accel * 0.1 + 1e-9
        assert abs(command.omega - twist.omega) <= LIMITS.omega_accel * 0.1 + 1e-9
        mean = Twist(0.5 * (twist.v + command.v), 0.5 * (twist.omega + command.omega))
        at = arc(at, mean, 0.1)
        twist, mover = command, mover + 0.1 * velocity
        least = min(least, math.dist(mover, at[:2]) - 0.6)
    assert least > 0.0


def test_one_that_braking_cannot_stop_for_is_driven_past():
    """Too fast to stop before the mover's way, it is across before the mover is."""
    crossing = [(6.2, 6.3, 0.0, -0.6, 0.3, 0.6)]
    robot = Robot("", LIMITS._replace(v_accel=0.4, v_brake=0.4), ROBOT.footprint)
    command = evade(crossing, Twist(0.9, 0.0), robot=robot)
    assert command is not None
    assert command.v > 0.9


def test_who_passes_at_a_distance_or_is_slow_to_come_is_not_evaded():
    assert evade([(5.0, 7.0, 0.8, 0.0, 0.3, 0.8)]) is None
    assert evade([(5.0, 9.9, 0.0, -0.3, 0.3, 0.3)]) is None


def test_with_walls_on_either_side_there_is_no_way_out():
    closed = np.zeros((200, 200), bool)
    closed[:, :93] = closed[:, 107:] = closed[:93] = closed[107:] = True
    mover = (5.0, 7.0, 0.0, -0.8, 0.3, 0.8)
    assert evade([mover], field=distance_field(closed, 0.05)) is None


@pytest.mark.parametrize("v_limit", [0.1, 0.3])
def test_the_maps_speed_limit_holds_for_ways_past_movers(v_limit):
    around = past([(6.5, 9.5, 0.0, -0.4, 0.3, 0.4)])
    passing, twist = Passing(ROBOT, 0.1), Twist(v_limit, 0.0)
    command = passing.go_on(Start(HERE, twist, around, PATH, MARGINS), v_limit=v_limit)
    assert command is not None
    assert command.v <= v_limit + 1e-9
    comes = past([(5.2, 8.0, 0.0, -0.6, 0.3, 0.6)])
    away = passing.evade(Start(HERE, twist, comes, PATH, MARGINS), v_limit)
    assert away is not None
    assert abs(away.v) <= v_limit + 1e-9


def test_setting_out_asks_for_more_of_a_gap_than_carrying_on():
    passing = Passing(ROBOT, 0.1)
    outcomes = []
    for y in np.arange(6.5, 12.0, 0.02):
        around = past([(6.5, y, 0.0, -0.4, 0.3, 0.4)])
        outcomes.append(
            tuple(
                passing.go_on(
                    Start(HERE, Twist(0.3, 0.0), around, PATH, MARGINS), faster_than=faster
                )
                is not None
                for faster in (0.0, -math.inf)
            )
        )
    assert (False, True) in outcomes
    assert (True, True) in outcomes
    assert (True, False) not in outcomes


def test_what_is_out_of_sight_is_driven_through_only_when_hoped_to_be_free():
    unseen = np.zeros((200, 200), bool)
    unseen[:, 140:] = True  # from x = 7, where the path ends at 7.9
    seen = past([(6.0, 9.0, 0.0, 0.4, 0.3, 0.4)], distance_field(unseen, 0.05))
    start = Start(HERE, Twist(0.0, 0.0), seen, PATH, MARGINS)
    passing = Passing(ROBOT, 0.1)
    assert passing.go_on(start) is None
    command = passing.go_on(start, hoped=seen._replace(field=OPEN))
    assert command is not None
    assert command.v > 0.0
    there = start._replace(pose=Pose2D(6.5, 5.0, 0.0), twist=Twist(0.7, 0.0))
    assert passing.go_on(there, hoped=seen._replace(field=OPEN)) is None  # it could not stop


@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.5]))
@settings(max_examples=80, deadline=None)
def test_a_way_out_can_stop_for_what_stands(seed, v):
    rng = np.random.default_rng(seed)
    closed = rng.random((200, 200)) < 0.004
    closed[90:110, 90:115] = False
    side = np.array([math.cos(seed), math.sin(seed)])
    mover = (*(HERE[:2] + 2.0 * side), *(-0.9 * side), 0.3, 0.9)
    field = distance_field(closed, 0.05)
    robot = Robot("", LIMITS._replace(v_min=-0.5), ROBOT.footprint)
    command = evade([mover], Twist(v, 0.0), field, robot)
    if command is None:
        return
    code = stop_kernels.certify(
        past([], field),
        body_of(robot),
        MARGINS,
        1.0,
        0.0,
        (*HERE, v, 0.0),
        *command,
        robot.limits,
        0.1,
    )
    assert code == stop_kernels.ADMISSIBLE
