"""The way past movers: what it is worth, and that it is safe for what stands."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import DwaConfig, DynamicWindow, Margins, Surroundings, stop_kernels
from dynastar.dwa.dwa import Body
from dynastar.dwa.manoeuvre_kernels import (
    FOLLOW,
    MANOEUVRES,
    PATH_SPEEDS,
    STEP,
    TOUCH,
    drive,
    may_pass,
)
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Footprint, Limits, Robot, arc, slew

LIMITS = Limits(1.0, 1.5, 1.0, 2.0, 1.0, 2.0)
ROBOT = Robot("round", LIMITS, Footprint.disc(0.3))
BODY = Body(ROBOT.footprint.vertices, 0.3, 0.3)
MARGINS = Margins(0.05, 0.15, 0.1)
HERE = Pose2D(5.0, 5.0, 0.0)
OPEN = np.full((200, 200), 9.0, np.float32)
PATH = np.column_stack([5.0 + 0.1 * np.arange(30), np.full(30, 5.0)])
NOBODY = np.empty((0, 6))


def driven(manoeuvre, movers=NOBODY, field=OPEN, twist=(0.0, 0.0), spread=0.0, need=0.0, path=PATH):
    low = 5.0 - 0.025 * len(field)
    around = Surroundings(field, low, low, 0.05, np.array(movers, float).reshape(-1, 6))
    return drive(
        np.array(manoeuvre, float),
        (*HERE, *twist),
        path,
        6.0,
        around,
        BODY,
        spread,
        need,
        0.0,
        LIMITS,
    )


@given(
    st.sampled_from(range(len(PATH_SPEEDS), len(MANOEUVRES))),
    st.tuples(st.floats(-4, 4), st.floats(-4, 4), st.floats(-1, 1), st.floats(-1, 1)),
)
@settings(max_examples=150, deadline=None)
def test_the_gap_is_that_of_a_drive_step_by_step(index, mover):
    first_v, first_w, switch, then_v, then_w = MANOEUVRES[index]
    x, y, vx, vy = mover
    at, v, omega, least, touched = HERE, 0.0, 0.0, math.inf, False
    for k in range(30):
        want = (first_v, first_w) if k * STEP < switch - 1e-9 else (then_v, then_w)
        next_v = slew(v, want[0] * 1.0, 1.0, 1.0, STEP)
        next_w = slew(omega, want[1] * 1.5, 2.0, 2.0, STEP)
        at = arc(at, Twist(0.5 * (v + next_v), 0.5 * (omega + next_w)), STEP)
        t, moves = (k + 1) * STEP, v > 0.0 or next_v > 0.0
        v, omega = next_v, next_w
        for way in (1.0, -1.0):
            gap = math.hypot(5 + x + way * vx * t - at.x, 5 + y + way * vy * t - at.y) - 0.6
            least, touched = min(least, gap), touched or (gap <= 0.0 and moves)
    wide = np.full((500, 500), 9.0, np.float32)
    found, end_x, end_y = driven(MANOEUVRES[index], [(5 + x, 5 + y, vx, vy, 0.3, 0.0)], wide)
    if abs(least) > 0.02:
        assert (found < 0.5 * TOUCH) == touched
    assert (end_x, end_y) == pytest.approx((at.x, at.y), abs=1e-9)
    if not touched:
        assert found == pytest.approx(least, abs=0.01)  # below 1 mm/s a mover stands


def test_following_stays_on_the_path_and_stops_at_its_end():
    bend = np.vstack([PATH[:10], PATH[9] + 0.1 * np.outer(np.arange(1, 12), (0.0, 1.0))])
    _, x, y = driven((0.5, 0.0, FOLLOW, 0.5, 0.0), path=bend)
    assert math.dist((x, y), bend[-1]) < 0.25


def test_a_wall_on_the_way_is_no_way():
    closed = np.zeros((200, 200), bool)
    closed[:, 118:] = True
    field = distance_field(closed, 0.05)
    assert driven((1.0, 0.0, 4.0, 1.0, 0.0), field=field)[0] == -math.inf
    assert driven((0.0, 1.0, 4.0, 0.0, 0.0), field=field)[0] == math.inf


def test_it_gets_less_sure_with_every_second_of_driving():
    beside = [(5.0, 7.0, 0.0, 0.0, 0.3, 0.0)]
    standing = (0.0, 0.0, 1.0, 0.0, 0.0)
    assert driven(standing, beside, spread=0.1)[0] == pytest.approx(1.4)
    circling = (0.05, 1.0, 4.0, 0.05, 0.5)
    sure, unsure = (driven(circling, beside, spread=spread)[0] for spread in (0.0, 0.1))
    assert sure - 0.3 - 1e-9 <= unsure < sure - 0.1


def passes(movers, field=OPEN):
    around = Surroundings(field, 0.0, 0.0, 0.05, np.array(movers, float))
    return may_pass((*HERE, 0.3, 0.0), PATH, 8.0, around, BODY, MARGINS, 1.0, 0.0, LIMITS)


def test_it_may_pass_before_who_comes_late_not_who_comes_head_on_nor_through_a_wall():
    late, head_on = (6.5, 9.0, 0.0, -0.5, 0.3, 0.5), (7.5, 5.0, -0.5, 0.0, 0.3, 0.5)
    assert passes([late])
    assert not passes([head_on])
    closed = np.zeros((200, 200), bool)
    closed[:, 124:] = True
    assert not passes([late], distance_field(closed, 0.05))


# -- the way out -----------------------------------------------------------------------------------


def evade(movers, twist=Twist(0.0, 0.0), field=OPEN):
    around = Surroundings(field, 0.0, 0.0, 0.05, np.array(movers, float))
    window = DynamicWindow(ROBOT, DwaConfig(v_samples=7, omega_samples=9), 0.1)
    return window.evade(HERE, twist, around, PATH, MARGINS)


@pytest.mark.parametrize("angle", [1.2, 1.6, 2.0, -1.6])
def test_a_robot_at_rest_leaves_the_way_of_what_comes_from_the_side(angle):
    """Taken again and again as it is taken, the way out keeps the mover off."""
    side = np.array([math.cos(angle), math.sin(angle)])
    mover, velocity = HERE[:2] + 2.5 * side, -0.8 * side
    at, twist, least = HERE, Twist(0.0, 0.0), math.inf
    window = DynamicWindow(ROBOT, DwaConfig(v_samples=7, omega_samples=9), 0.1)
    for _ in range(60):
        rows = np.array([(*mover, *velocity, 0.3, 0.8)])
        around = Surroundings(OPEN, 0.0, 0.0, 0.05, rows)
        command = window.evade(at, twist, around, PATH, MARGINS)
        assert least < math.inf or command is not None
        command = Twist(0.0, 0.0) if command is None else command
        assert 0.0 <= command.v <= twist.v + LIMITS.v_accel * 0.1 + 1e-9
        assert abs(command.omega - twist.omega) <= LIMITS.omega_accel * 0.1 + 1e-9
        mean = Twist(0.5 * (twist.v + command.v), 0.5 * (twist.omega + command.omega))
        at = arc(at, mean, 0.1)
        twist, mover = command, mover + 0.1 * velocity
        least = min(least, math.dist(mover, at[:2]) - 0.6)
    assert least > 0.0


def test_who_passes_at_a_distance_or_is_slow_to_come_is_not_evaded():
    assert evade([(5.0, 7.0, 0.8, 0.0, 0.3, 0.8)]) is None
    assert evade([(5.0, 9.0, 0.0, -0.3, 0.3, 0.3)]) is None


def test_with_walls_on_either_side_there_is_no_way_out():
    closed = np.zeros((200, 200), bool)
    closed[:, :92] = closed[:, 108:] = closed[:90] = closed[110:] = True
    mover = (5.0, 7.0, 0.0, -0.8, 0.3, 0.8)
    assert evade([mover], field=distance_field(closed, 0.05)) is None


@given(st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_a_way_out_can_stop_for_what_stands(seed):
    rng = np.random.default_rng(seed)
    closed = rng.random((200, 200)) < 0.004
    closed[90:110, 90:110] = False
    side = np.array([math.cos(seed), math.sin(seed)])
    mover = (*(HERE[:2] + 2.0 * side), *(-0.9 * side), 0.3, 0.9)
    field = distance_field(closed, 0.05)
    command = evade([mover], field=field)
    if command is None:
        return
    around = Surroundings(field, 0.0, 0.0, 0.05, NOBODY)
    code = stop_kernels.certify(
        around, BODY, MARGINS, 1.0, 0.0, (*HERE, 0.0, 0.0), *command, LIMITS, 0.1
    )
    assert code == stop_kernels.ADMISSIBLE
