"""The planners of several clearances, on a planning map that changes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynastar.errors import GoalObstructed, GoalOccupied, NoPath
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.planners import Planners
from dynastar.path import Path
from dynastar.perception import LocalMap, PlanningMap
from dynastar.perception.local_map import SEEN_FREE, SEEN_OCCUPIED
from dynastar.planning import GridPlanner

START, GOAL = (1.0, 3.0), (7.0, 3.0)
CONFIG = NavigatorConfig(comfort=0.2, resolution=0.1)


def room(values=None, **masks):
    """8 x 6 m in cells of 0.1 m with a wall all round."""
    values = np.zeros((60, 80), np.int8) if values is None else values
    values[[0, -1]] = values[:, [0, -1]] = 100
    return OccupancyGrid(values, GridFrame(0.1), **masks)


def planners(grid=None):
    return Planners(PlanningMap(room() if grid is None else grid, 0.1), CONFIG, (0.3, 0.25))


def show(made, state, x0, y0, x1, y1):
    """Takes in a local map that shows a box as ``state``."""
    local_map = LocalMap(CONFIG.local_map, *made.planning_map.lattice)
    local_map.follow(4.0, 3.0)
    a, (left, low) = local_map.resolution, local_map.origin
    at = (np.arange(len(local_map.states)) + 0.5) * a
    x, y = at + left, at[:, None] + low
    local_map.states[(x0 <= x) & (x < x1) & (y0 <= y) & (y < y1)] = state
    return made.mark(made.planning_map.merge(local_map))


def least_distance(path, x, y):
    points = path.resampled(0.0, path.length, 0.02)
    return np.hypot(points[:, 0] - x, points[:, 1] - y).min()


def test_what_was_seen_is_gone_round_until_it_is_forgotten():
    made = planners()
    straight = made.plan(START, GOAL).path
    assert straight.length == pytest.approx(6.0, abs=0.01)
    assert show(made, SEEN_OCCUPIED, 3.8, 2.6, 4.2, 3.4)
    assert not show(made, SEEN_OCCUPIED, 3.8, 2.6, 4.2, 3.4)
    assert made.blocked_at(straight.points) == pytest.approx(2.8 - 0.25, abs=0.15)
    around = made.plan(START, GOAL).path
    assert around.length > 6.1
    assert made.blocked_at(around.points) is None
    assert least_distance(around, 4.0, 3.35) >= 0.25
    made.forget()
    assert made.plan(START, GOAL).path.length == pytest.approx(6.0, abs=0.01)


def test_room_to_spare_is_not_worth_a_detour():
    values = np.zeros((60, 80), np.int8)
    values[:, 38:42] = 100
    values[28:33, 38:42] = 0  # 0.5 m wide on the straight way, and a wide gap higher up
    values[45:57, 38:42] = 0
    plan = planners(room(values)).plan(START, GOAL)
    assert plan.radius == 0.25
    assert plan.path.length < 6.1


def test_unknown_space_seen_free_is_planned_through_and_a_keepout_never():
    values = np.zeros((60, 80), np.int8)
    values[:, 35:45] = -1
    made = planners(room(values.copy()))
    with pytest.raises(NoPath):
        made.plan(START, GOAL)
    assert show(made, SEEN_FREE, 3.0, 0.3, 5.0, 5.7)
    assert made.plan(START, GOAL).path.length == pytest.approx(6.0, abs=0.01)
    keepout = np.zeros((60, 80), bool)
    keepout[:, 38:42] = True
    barred = planners(room(values, keepout=keepout))
    show(barred, SEEN_FREE, 3.0, 0.3, 5.0, 5.7)
    with pytest.raises(NoPath):
        barred.plan(START, GOAL)


def test_the_planners_know_after_many_sights_what_fresh_ones_would():
    made, rng = planners(), np.random.default_rng(4)
    for _ in range(8):
        x, y = rng.uniform(0.5, 7.0), rng.uniform(0.5, 5.0)
        state = rng.choice([SEEN_OCCUPIED, SEEN_OCCUPIED, SEEN_FREE])
        show(made, state, x, y, x + rng.uniform(0.1, 1.0), y + 0.4)
    blocked = made.planning_map.blocked
    fresh_grid = OccupancyGrid(np.where(blocked, 100, 0).astype(np.int8), GridFrame(0.1))
    for planner in made.by_width:
        fresh = GridPlanner(fresh_grid, planner.radius, "blocked", CONFIG.planner)
        assert np.array_equal(planner.blocked, blocked)
        assert np.array_equal(planner.inflated, fresh.inflated)


def test_there_is_room_to_spare_where_there_is_room():
    values = np.zeros((60, 80), np.int8)
    values[:28, 38:42] = 100
    values[32:, 38:42] = 100  # a door of 0.4 m
    with pytest.raises(NoPath):
        planners(room(values)).plan(START, GOAL)
    values = np.zeros((60, 80), np.int8)
    values[:27, 38:42] = 100
    values[33:, 38:42] = 100  # a door of 0.6 m: only just
    assert planners(room(values)).plan(START, GOAL).radius == 0.25
    assert planners().plan(START, GOAL).radius == pytest.approx(0.5)


def test_a_goal_that_is_seen_occupied_is_waited_for_near_by():
    made = planners()
    show(made, SEEN_OCCUPIED, 6.8, 2.8, 7.2, 3.2)
    plan = made.plan(START, GOAL)
    end = tuple(plan.path.points[-1])
    assert 0.4 < math.dist(end, GOAL) < 1.0
    assert made.blocked_at(plan.path.points) is None
    with pytest.raises(GoalObstructed, match="an obstacle occupies the goal"):
        made.plan(end, GOAL)
    show(made, SEEN_FREE, 6.8, 2.8, 7.2, 3.2)
    assert tuple(made.plan(end, GOAL).path.points[-1]) == GOAL


def test_a_goal_that_sensed_obstacles_enclose_is_waited_for_near_by():
    """It is free itself, and cannot be reached; the same far from it is no way at all."""
    made = planners()
    for box in (6.0, 2.0, 6.2, 4.0), (6.0, 2.0, 8.0, 2.2), (6.0, 3.8, 8.0, 4.0):
        show(made, SEEN_OCCUPIED, *box)
    end = made.plan(START, GOAL).path.points[-1]
    assert end[0] < 6.0 or abs(end[1] - 3.0) > 1.0
    assert math.dist(end, GOAL) < 1.7
    made = planners()
    show(made, SEEN_OCCUPIED, 3.8, 0.0, 4.2, 6.0)
    with pytest.raises(NoPath):
        made.plan(START, GOAL)


@pytest.mark.parametrize("goal", [(7.95, 3.0), (7.8, 3.0)])
def test_a_goal_that_the_map_rules_out_is_not_waited_for(goal):
    made = Planners(PlanningMap(room(), 0.1), CONFIG._replace(goal_tolerance=0.05), (0.3, 0.25))
    show(made, SEEN_OCCUPIED, 3.8, 2.6, 4.2, 3.4)
    with pytest.raises(GoalOccupied):
        made.plan(START, goal)


@pytest.mark.parametrize(("gap", "radius"), [(0.7, 0.5), (0.35, 0.3), (0.12, 0.25)])
def test_a_path_to_the_wall_ends_where_the_robot_gets_near_enough(gap, radius):
    """A roomy plan is not taken if it ends at the rim of the tolerance."""
    goal = 7.9 - gap, 3.0
    config = CONFIG._replace(resolution=0.05)
    made = Planners(PlanningMap(room(), 0.05), config, (0.3, 0.25)).plan(START, goal)
    assert made.radius == pytest.approx(radius)
    assert math.dist(made.path.points[-1], goal) <= 0.15


def test_a_bent_way_out_is_judged_along_its_bend():
    """Its chord is clear of the pillar that it leads round, or the other way about."""
    made = planners()
    plan = made.by_width[0].plan(START, GOAL)

    def bent(corner):
        points = np.array([START, corner, (3.0, 3.0), GOAL])
        length = math.dist(START, corner) + math.dist(corner, (3.0, 3.0))
        return replace(plan, path=Path(points), clear_from=length)

    tight = made.by_width[-1].plan(START, GOAL)
    show(made, SEEN_OCCUPIED, 1.9, 3.4, 2.1, 3.6)
    for corner, kept in ((2.0, 3.3), False), ((2.0, 2.9), True):
        made._ask = lambda width, *_, lead=bent(corner): (
            tight if width is made.by_width[-1] else lead
        )
        assert (made.plan(START, GOAL) is not tight) == kept


@pytest.mark.parametrize("finer", [1, 4])
def test_a_local_map_shows_where_no_plan_leads(finer):
    grid = room().refined(finer)
    made = Planners(PlanningMap(grid, 0.1), CONFIG, (0.3, 0.25))
    show(made, SEEN_OCCUPIED, 3.0, 2.0, 3.5, 4.0)
    local_map = LocalMap(CONFIG.local_map, *made.planning_map.lattice)
    local_map.follow(6.0, 3.0)
    closed = made.closed_under(local_map)
    tight = made.by_width[-1]
    a, (left, low) = local_map.resolution, local_map.origin
    for row, column in np.argwhere(np.ones_like(closed)):
        x, y = left + column * a, low + row * a
        if not (0.0 <= x < 8.0 and 0.0 <= y < 6.0):
            assert closed[row, column]
            continue
        first = np.round(np.array([y, x]) / grid.resolution).astype(int)
        part = tight.inflated[first[0] : first[0] + finer, first[1] : first[1] + finer]
        assert closed[row, column] == part.all()
    assert 0 < np.count_nonzero(~closed) < closed.size / 2
