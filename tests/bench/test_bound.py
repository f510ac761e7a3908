import math
from dataclasses import replace

import numpy as np
import pytest

from driving import LIMITS, ROUND, room
from dynastar.bench import bound
from dynastar.bench.bound import least_time, shortest_length, time_bound
from dynastar.footprint import Footprint
from dynastar.geometry import Goal
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import Robot
from dynastar.simulation import Mover, Scenario

TOLERANCE = 0.25


def made(grid, *goals, start=(1.0, 3.0), **more):
    return Scenario(
        "test", grid, ROUND, (*start, 0.0), tuple(Goal(*goal) for goal in goals), **more
    )


def box(x0, y0, x1, y1):
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def test_time_from_rest():
    ramp = 1.0 / (2 * 0.8)  # v_max 1 m/s, 0.8 m/s2
    assert least_time(ramp + 3.0, LIMITS) == pytest.approx(1.0 / 0.8 + 3.0)
    assert least_time(0.1, LIMITS) == pytest.approx(math.sqrt(2 * 0.1 / 0.8))
    assert least_time(0.0, LIMITS) == 0.0


def test_the_straight_line_less_the_tolerance():
    scenario = made(room(), (7.0, 3.0))
    assert shortest_length(scenario) == pytest.approx(6.0 - TOLERANCE)
    assert time_bound(scenario) == least_time(shortest_length(scenario), LIMITS)


def test_goals_in_turn_take_the_tolerance_twice():
    scenario = made(room(), (4.0, 3.0), (7.0, 3.0))
    assert shortest_length(scenario) == pytest.approx(6.0 - 3 * TOLERANCE)


@pytest.mark.parametrize("mapped", [True, False])
def test_round_a_box_known_or_not(mapped):
    there = (3.5, 2.0, 4.5, 4.0)
    scenario = (
        made(room(8.0, 6.0, there), (7.0, 3.0))
        if mapped
        else made(room(), (7.0, 3.0), obstacles=(box(*there),))
    )
    # Tangents to the corner's arc of the robot's radius, and its arc.
    side = math.hypot(2.5, 1.0)
    turn = math.atan2(1.0, 2.5) + math.asin(0.25 / side)
    exact = 2 * math.sqrt(side**2 - 0.25**2) + 2 * turn * 0.25 + 1.0 - TOLERANCE
    assert shortest_length(scenario) == pytest.approx(exact, rel=0.02)
    assert shortest_length(scenario) <= exact + 0.02


def test_the_true_world_counts_and_movers_do_not():
    mover = Mover(0.5, np.array([0.0, 1.0]), np.array([[4.0, 3.0], [4.0, 3.1]]))
    blocked = made(room(8.0, 6.0, (3.5, 0.0, 4.0, 6.0)), (7.0, 3.0), world=room(), movers=(mover,))
    assert shortest_length(blocked) == pytest.approx(6.0 - TOLERANCE)


def test_no_way_is_none():
    scenario = made(room(), (7.0, 3.0), obstacles=(box(3.5, 0.0, 4.0, 6.0),))
    assert time_bound(scenario) is None
    inside = made(room(), (7.0, 3.0), obstacles=(box(6.0, 2.0, 7.9, 4.0),))
    assert time_bound(inside) is None


def test_a_goal_within_the_tolerance_of_free_space_is_reached():
    scenario = made(room(), (7.6, 3.0), goal_tolerance=0.5)
    assert shortest_length(scenario) == pytest.approx(6.1, abs=0.1)


def test_unknown_cells_are_free_and_a_turned_map_is_honoured():
    values = np.where(room().occupied, 100, -1).astype(np.int8)
    frame = GridFrame(0.1, 2.0, 1.0, math.pi / 2)
    grid = OccupancyGrid(values, frame)
    start, goal = (frame.to_world(30, 10 + 60 * end) for end in (0, 1))
    scenario = made(grid, goal, start=start, obstacles=())
    assert shortest_length(scenario) == pytest.approx(6.0 - TOLERANCE)
    corners = np.array([[0.0, 38.0], [60.0, 38.0], [60.0, 40.0], [0.0, 40.0]])
    walled = replace(scenario, obstacles=(frame.points_to_world(corners),))
    assert shortest_length(walled) is None


def test_a_polygon_fits_where_its_inscribed_disc_does():
    long_robot = Robot(
        "long", LIMITS, Footprint.polygon([(-0.6, -0.2), (0.6, -0.2), (0.6, 0.2), (-0.6, 0.2)]),
        ROUND.lidar,
    )  # fmt: skip
    wall = (box(4.0, 0.0, 4.1, 2.75), box(4.0, 3.25, 4.1, 6.0))
    scenario = replace(made(room(), (7.0, 3.0), obstacles=wall), robot=long_robot)
    assert shortest_length(scenario) == pytest.approx(6.0 - TOLERANCE, abs=0.02)


def test_repeats_are_computed_once(monkeypatch):
    scenario = made(room(), (6.9, 3.0))
    first = shortest_length(scenario)
    monkeypatch.setattr(bound, "_shortest_length", None)
    assert shortest_length(replace(scenario, seed=9, time_limit=7.0)) == first
    with pytest.raises(TypeError):
        shortest_length(made(room(), (6.8, 3.0)))


def test_a_large_map_with_a_wall_across():
    scenario = made(room(60.0, 60.0, (30.0, 5.0, 31.0, 55.0)), (55.0, 30.0), start=(5.0, 30.0))
    assert 60.0 < shortest_length(scenario) < 75.0
