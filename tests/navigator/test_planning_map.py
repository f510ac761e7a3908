"""The planning map: the map and what was seen, for planning."""

import math

import numpy as np
import pytest

from dynastar.errors import GoalOccupied, NoPath
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.planning_map import PlanningMap
from dynastar.perception import LocalMap
from dynastar.perception.local_map import SEEN_FREE, SEEN_OCCUPIED
from dynastar.planning import GridPlanner

START, GOAL = (1.0, 3.0), (7.0, 3.0)
CONFIG = NavigatorConfig(comfort=0.2, planning_resolution=0.1)


def room(values=None, yaw=0.0, **masks):
    """8 x 6 m in cells of 0.1 m with a wall all round."""
    if values is None:
        values = np.zeros((60, 80), np.int8)
    values[[0, -1]] = values[:, [0, -1]] = 100
    return OccupancyGrid(values, GridFrame(0.1, 0.0, 0.0, yaw), **masks)


def mapped(grid=None, config=CONFIG):
    return PlanningMap(room() if grid is None else grid, config, (0.3, 0.25))


def local_map_showing(state, x0, y0, x1, y1, centre=(4.0, 3.0), frame=None):
    """A local_map round ``centre`` that shows a box of the frame, by default the world's, as ``state``."""
    local_map = LocalMap()
    local_map.follow(*centre)
    a = local_map.config.resolution
    rows, columns = np.mgrid[: len(local_map.states), : len(local_map.states)]
    points = np.stack(
        [(columns + 0.5) * a + local_map.origin[0], (rows + 0.5) * a + local_map.origin[1]], 2
    )
    if frame is not None:
        cells = frame.points_to_grid(points.reshape(-1, 2)).reshape(points.shape)
        points = cells[..., ::-1] * frame.resolution
    x, y = points[..., 0], points[..., 1]
    local_map.states[(x0 <= x) & (x < x1) & (y0 <= y) & (y < y1)] = state
    return local_map


def least_distance(path, x, y):
    points = path.resampled(0.0, path.length, 0.02)
    return np.hypot(points[:, 0] - x, points[:, 1] - y).min()


def test_what_was_seen_is_gone_round_until_it_is_forgotten():
    made = mapped()
    straight = made.plan(START, GOAL, explored=False).path
    assert straight.length == pytest.approx(6.0, abs=0.01)
    assert made.take_in(local_map_showing(SEEN_OCCUPIED, 3.8, 2.6, 4.2, 3.4))
    assert made.blocked_at(straight.points) == pytest.approx(2.8 - 0.25, abs=0.15)
    around = made.plan(START, GOAL, explored=False).path
    assert around.length > 6.1
    assert made.blocked_at(around.points) is None
    assert least_distance(around, 4.0, 3.35) >= 0.25
    made.forget()
    assert not made.seen.any()
    assert made.plan(START, GOAL, explored=False).path.length == pytest.approx(6.0, abs=0.01)


def test_what_is_seen_free_again_is_no_longer_in_the_way():
    made = mapped()
    box = 3.8, 2.6, 4.2, 3.4
    assert made.take_in(local_map_showing(SEEN_OCCUPIED, *box))
    assert not made.take_in(local_map_showing(SEEN_OCCUPIED, *box))  # nothing new
    assert not made.take_in(LocalMap())  # nothing seen changes nothing
    assert made.take_in(local_map_showing(SEEN_FREE, *box))
    assert not made.seen.any()


def test_what_the_map_shows_anyway_is_not_marked_twice():
    values = np.zeros((60, 80), np.int8)
    values[20:40, 40:44] = 100
    made = mapped(room(values))
    assert not made.take_in(local_map_showing(SEEN_OCCUPIED, 4.0, 2.0, 4.4, 4.0))
    assert not made.take_in(
        local_map_showing(SEEN_OCCUPIED, 3.92, 2.0, 4.0, 4.0)
    )  # a cell before it


def test_the_edge_of_the_map_is_not_marked_twice():
    """What stands outside is seen in the map's last cells; a way along the edge stays open."""
    bare = OccupancyGrid(np.zeros((60, 80), np.int8), GridFrame(0.1, 0.0, 0.0, 0.0))
    on = mapped(bare)
    on.take_in(local_map_showing(SEEN_OCCUPIED, 2.0, 5.9, 6.0, 6.2, centre=(4.0, 4.0)))
    assert not on.seen.any()
    on.take_in(local_map_showing(SEEN_OCCUPIED, 2.0, 5.7, 6.0, 6.2, centre=(4.0, 4.0)))
    assert on.seen.any()


def test_room_to_spare_is_not_worth_a_detour():
    values = np.zeros((60, 80), np.int8)
    values[:, 38:42] = 100
    values[28:33, 38:42] = 0  # 0.5 m wide on the straight way, and a wide gap higher up
    values[45:57, 38:42] = 0
    plan = mapped(room(values), CONFIG).plan(START, GOAL, explored=False)
    assert plan.radius == 0.25
    assert plan.path.length < 6.1


def test_unknown_space_seen_free_is_planned_through_and_a_keepout_never():
    values = np.zeros((60, 80), np.int8)
    values[:, 35:45] = -1
    seen = local_map_showing(SEEN_FREE, 3.0, 0.3, 5.0, 5.7)
    made = mapped(room(values.copy()))
    with pytest.raises(NoPath):
        made.plan(START, GOAL, explored=False)
    assert made.take_in(seen)
    assert made.plan(START, GOAL, explored=False).path.length == pytest.approx(6.0, abs=0.01)
    keepout = np.zeros((60, 80), bool)
    keepout[:, 38:42] = True
    barred = mapped(room(values, keepout=keepout))
    barred.take_in(seen)
    with pytest.raises(NoPath):
        barred.plan(START, GOAL, explored=False)


@pytest.mark.parametrize("yaw", [0.7, -2.0])
def test_a_map_that_is_turned_has_what_was_seen_in_the_right_place(yaw):
    made = mapped(room(yaw=yaw))
    frame = made.frame
    centre = frame.to_world(30.0, 40.0)
    made.take_in(local_map_showing(SEEN_OCCUPIED, 3.8, 2.6, 4.2, 3.4, centre, frame))
    rows, columns = np.nonzero(made.seen)
    assert (rows.min(), rows.max()) == pytest.approx((26, 33), abs=1)
    assert (columns.min(), columns.max()) == pytest.approx((38, 41), abs=1)
    assert len(rows) >= 0.9 * 8 * 4


def test_the_planners_know_after_many_sights_what_fresh_ones_would():
    made, rng = mapped(), np.random.default_rng(4)
    for _ in range(8):
        x, y = rng.uniform(0.5, 7.0), rng.uniform(0.5, 5.0)
        state = rng.choice([SEEN_OCCUPIED, SEEN_OCCUPIED, SEEN_FREE])
        made.take_in(local_map_showing(state, x, y, x + rng.uniform(0.1, 1.0), y + 0.4))
    fresh_grid = OccupancyGrid(np.where(made.blocked, 100, 0).astype(np.int8), made.frame)
    for planner in made.planners:
        fresh = GridPlanner(fresh_grid, planner.radius, "blocked", CONFIG.planner)
        assert np.array_equal(planner.blocked, made.blocked)
        assert np.array_equal(planner.inflated, fresh.inflated)


def test_there_is_room_to_spare_where_there_is_room():
    values = np.zeros((60, 80), np.int8)
    values[:28, 38:42] = 100
    values[32:, 38:42] = 100  # a door of 0.4 m
    with pytest.raises(NoPath):
        mapped(room(values)).plan(START, GOAL, explored=False)
    values = np.zeros((60, 80), np.int8)
    values[:27, 38:42] = 100
    values[33:, 38:42] = 100  # a door of 0.6 m: only just
    assert mapped(room(values)).plan(START, GOAL, explored=False).radius == 0.25
    assert mapped().plan(START, GOAL, explored=False).radius == pytest.approx(0.5)


def test_a_goal_that_is_seen_occupied_is_said():
    made = mapped()
    made.take_in(local_map_showing(SEEN_OCCUPIED, 6.8, 2.8, 7.2, 3.2))
    with pytest.raises(GoalOccupied):
        made.plan(START, GOAL, explored=False)


def test_coarse_maps_are_planned_on_finer_and_speed_limits_go_along():
    limit = np.full((6, 8), np.inf)
    limit[:, 4:] = 0.5
    grid = OccupancyGrid(np.zeros((6, 8), np.int8), GridFrame(1.0), speed_limit=limit)
    made = mapped(grid)
    assert made.frame.resolution == pytest.approx(0.1)
    assert made.blocked.shape == (60, 80)
    found = made.speed_limit(np.array([(3.9, 3.0), (4.1, 3.0), (-1.0, 3.0), (7.9, 99.0)]))
    assert found.tolist() == [math.inf, 0.5, math.inf, math.inf]


@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_what_blocks_under_a_layer_is_the_maps_and_the_seen_and_all_off_the_map(yaw):
    grid = room(yaw=yaw)
    made = mapped(grid)
    local_map = local_map_showing(SEEN_OCCUPIED, 3.8, 2.6, 4.2, 3.4, (2.0, 3.0), grid.frame)
    made.take_in(local_map)
    under = made.stands_in(local_map)
    assert under.shape == local_map.states.shape
    a, origin = local_map.config.resolution, np.array(local_map.origin)
    rows, columns = np.mgrid[: len(under) : 7, : len(under) : 7]
    for row, column in zip(rows.ravel(), columns.ravel(), strict=True):
        point = origin + a * (np.array([column, row]) + 0.5)
        cell = np.floor(grid.frame.points_to_grid(point[None]))[0].astype(int)
        inside = (cell >= 0).all() and (cell < made.prior.shape).all()
        hit = local_map.states[row, column] == SEEN_OCCUPIED
        assert under[row, column] == (hit or not inside or made.blocked[tuple(cell)])


@pytest.mark.parametrize("yaw", [0.0, 0.7])
@pytest.mark.parametrize("seed", range(4))
def test_the_planning_map_takes_over_cell_by_cell_what_the_layer_shows(yaw, seed):
    rng = np.random.default_rng(seed)
    values = np.where(rng.random((60, 80)) < 0.1, -1, 0).astype(np.int8)
    grid = room(values, yaw=yaw)
    made = mapped(grid)
    local_map = LocalMap()
    local_map.follow(*rng.uniform(-2.0, 4.0, 2))
    seen, cleared = made.seen.copy(), made.cleared.copy()
    a, (x0, y0) = local_map.config.resolution, local_map.origin
    for _ in range(3):
        local_map.states[:] = rng.choice(
            [0, 0, 0, SEEN_FREE, SEEN_OCCUPIED], local_map.states.shape
        )
        shown = {SEEN_FREE: set(), SEEN_OCCUPIED: set()}
        for row, column in np.argwhere(local_map.states > 0):
            x, y = x0 + (column + 0.5) * a, y0 + (row + 0.5) * a
            cell = tuple(math.floor(i) for i in grid.frame.to_grid(x, y))
            if all(0 <= i < n for i, n in zip(cell, seen.shape, strict=True)):
                shown[local_map.states[row, column]].add(cell)
        before = seen.copy(), cleared.copy()
        for cell in shown[SEEN_FREE]:
            seen[cell] = False
            cleared[cell] |= grid.unknown[cell]
        for cell in shown[SEEN_OCCUPIED]:
            seen[cell] |= not made.known.mask[cell]
        changed = made.take_in(local_map)
        assert changed == ((seen != before[0]).any() or (cleared != before[1]).any())
        assert (made.seen == seen).all()
        assert (made.cleared == cleared).all()
    for planner in made.planners:
        assert (planner.blocked == made.blocked).all()
    far = LocalMap()
    far.follow(500.0, 500.0)
    far.states[:] = SEEN_OCCUPIED
    assert not made.take_in(far)
    assert made.stands_in(far).all()


def test_what_stands_in_a_wall_of_the_map_or_off_it_is_not_on_free_ground():
    places = np.array([(4.0, 3.0), (0.05, 3.0), (-0.3, 3.0), (4.0, 6.2), (7.5, 0.5)])
    assert mapped().on_free_ground(places).tolist() == [[4.0, 3.0], [7.5, 0.5]]
    assert mapped().on_free_ground(np.empty((0, 2))).shape == (0, 2)
    unknown = np.full((60, 80), -1, np.int8)
    assert len(mapped(room(unknown)).on_free_ground(places)) == 2
