"""A robot that is stuck although a path leads on backs and turns to where it goes on."""

import math

import numpy as np
import pytest

from driving import room
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D
from dynastar.navigator.way_out import LOST, NEAR, TURNED, WayOut, Waypoint, joined
from dynastar.robot import Lidar, Limits, Robot
from dynastar.simulation import Noise, Scenario, run

LIMITS = Limits(0.6, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3)


def cart(length=1.0, behind=0.15, width=0.5, **limits):
    """A robot with its axle ``behind`` (m) before its back."""
    ahead, half = length - behind, 0.5 * width
    corners = [(ahead, -half), (ahead, half), (-behind, half), (-behind, -half)]
    lidar = Lidar(720, math.radians(270.0), 0.05, 10.0, x=ahead - 0.05)
    return Robot("cart", LIMITS._replace(**limits), Footprint.polygon(corners), lidar)


def junction(width):
    """A corridor of a ``width`` (m) along x with one to the south, from x = 4 m on."""
    return room(
        9.0, 6.0, (0.0, 4.0 + width, 9.0, 6.0), (0.0, 0.0, 4.0, 4.0), (4.0 + width, 0.0, 9.0, 4.0)
    )


@pytest.mark.parametrize("robot", [cart(), cart(behind=0.05), cart(behind=0.4), cart(v_least=0.05)])
@pytest.mark.parametrize("x", [5.2, 4.6])
def test_a_long_robot_turns_into_a_corridor_as_wide_as_itself_is_long(robot, x):
    scenario = Scenario(
        "junction", junction(1.0), robot, (x, 4.5, math.pi), (Goal(4.5, 1.6),),
        noise=Noise(0.01, 0.01), latency=0.1, time_limit=90.0,
    )  # fmt: skip
    episode = run(scenario)
    assert episode.outcome == "arrived", episode.reason


@pytest.mark.parametrize(("apart", "second"), [(1.4, 0.8), (1.5, 3.2)])
def test_a_long_robot_gets_through_two_doors_that_are_not_opposite(apart, second):
    wall = 3.2 + apart
    doors = room(
        9.0, 6.0, (3.0, 0.0, 3.2, 2.0), (3.0, 2.8, 3.2, 6.0),
        (wall, 0.0, wall + 0.2, second), (wall, second + 0.8, wall + 0.2, 6.0),
    )  # fmt: skip
    scenario = Scenario(
        "doors", doors, cart(), (1.2, 2.4, 0.0), (Goal(7.0, second + 0.4),),
        noise=Noise(0.01, 0.01), latency=0.1, time_limit=90.0,
    )  # fmt: skip
    episode = run(scenario)
    assert episode.outcome == "arrived", episode.reason


def on_a_way(*rows):
    """A way out that has been found."""
    way_out = WayOut(LIMITS, 6.0)
    way_out.way, way_out._since = [Waypoint(*row) for row in rows], 0.0
    return way_out


def test_moves_end_in_order_where_the_robot_has_come_to_them():
    way_out = on_a_way((0.9, 0.0, 0.0, -1), (0.9, 0.0, 0.4, 0), (1.0, 0.04, 0.4, 1))
    assert way_out.goes_on(Pose2D(1.0, 0.0, 0.0), 1.0)
    assert len(way_out.way) == 3
    assert way_out.goes_on(Pose2D(0.9 + 0.5 * NEAR, 0.0, 0.0), 2.0)
    assert way_out.way[0].ahead == 0.0
    assert way_out.goes_on(Pose2D(0.9, 0.0, 0.4 - 0.5 * TURNED), 3.0)
    assert len(way_out.way) == 1
    assert not way_out.goes_on(Pose2D(1.0, 0.04, 0.4), 4.0)


def test_a_way_ends_where_a_move_takes_too_long_or_the_robot_is_elsewhere():
    row = (2.0, 0.0, 0.0, 1)
    assert on_a_way(row).goes_on(Pose2D(1.8, 0.0), 5.9)
    assert not on_a_way(row).goes_on(Pose2D(1.8, 0.0), 6.1)
    assert not on_a_way(row).goes_on(Pose2D(1.9 - LOST, 0.0), 1.0)


@pytest.mark.parametrize("count", [1, 3, 15, 16, 20, 31])
@pytest.mark.parametrize("side", [1, -1])
def test_turns_are_joined_but_still_lead_the_same_way_round(count, side):
    step = side * math.tau / 32
    rows = [
        (0.1, 0.0, 0.0, 1),
        *((0.1, 0.0, step * (k + 1), 0) for k in range(count)),
        (0.2, 0.0, 0.0, -1),
    ]
    found = joined([Waypoint(*row) for row in rows])
    headings = np.array([move.heading for move in found if move.ahead == 0.0])
    assert len(headings) == -(-count // 15)
    turned = np.diff(headings, prepend=0.0)
    assert np.all(side * turned > 0.0)
    assert np.all(np.abs(turned) < math.pi)
    assert headings[-1] == step * count
    assert (found[0].ahead, found[-1].ahead) == (1, -1)
