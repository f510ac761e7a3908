"""The planning map: the map and what was sensed."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.perception import LocalMap, LocalMapConfig, PlanningMap
from dynastar.perception.local_map import SEEN_FREE, SEEN_OCCUPIED, UNSEEN

SHAPE = 60, 80


def room(values=None, frame=GridFrame(0.1), **masks):
    """8 x 6 m in cells of 0.1 m with a wall all round."""
    values = np.zeros(SHAPE, np.int8) if values is None else values
    values[[0, -1]] = values[:, [0, -1]] = 100
    return OccupancyGrid(values, frame, **masks)


def local_map_on(planning_map, size=10.0):
    return LocalMap(LocalMapConfig(size=size), *planning_map.lattice)


def showing(planning_map, state, x0, y0, x1, y1):
    """A local map in the middle of the room that shows a box as ``state``."""
    local_map = local_map_on(planning_map)
    local_map.follow(4.0, 3.0)
    a, (left, low) = local_map.resolution, local_map.origin
    at = (np.arange(len(local_map.states)) + 0.5) * a
    x, y = at + left, at[:, None] + low
    local_map.states[(x0 <= x) & (x < x1) & (y0 <= y) & (y < y1)] = state
    return local_map


def test_what_was_seen_is_kept_until_it_is_seen_free_or_forgotten():
    made, box = PlanningMap(room(), 0.1), (3.8, 2.6, 4.2, 3.4)
    patch = made.merge(showing(made, SEEN_OCCUPIED, *box))
    assert (patch.top, patch.left, patch.blocked.shape) == (26, 38, (8, 4))
    assert patch.blocked.all()
    assert made.seen.sum() == 32
    assert made.merge(showing(made, SEEN_OCCUPIED, *box)) is None
    assert made.merge(showing(made, UNSEEN, *box)) is None
    patch = made.merge(showing(made, SEEN_FREE, 3.8, 2.6, 4.2, 3.0))
    assert (patch.top, patch.left, patch.blocked.shape) == (26, 38, (4, 4))
    assert not patch.blocked.any()
    patch = made.forget()
    assert (patch.top, patch.left, patch.blocked.shape) == (30, 38, (4, 4))
    assert not made.seen.any()
    assert (made.blocked == made.prior).all()
    assert made.forget() is None


def test_what_the_map_shows_anyway_is_not_marked_twice():
    values = np.zeros(SHAPE, np.int8)
    values[20:40, 40:44] = 100
    made = PlanningMap(room(values), 0.1)
    assert made.merge(showing(made, SEEN_OCCUPIED, 4.0, 2.0, 4.4, 4.0)) is None
    assert made.merge(showing(made, SEEN_OCCUPIED, 3.9, 2.0, 4.0, 4.0)) is None  # a cell before it


def test_the_edge_of_the_map_is_not_marked_twice():
    """What stands outside is seen in the map's last cells; a way along the edge stays open."""
    made = PlanningMap(OccupancyGrid(np.zeros(SHAPE, np.int8), GridFrame(0.1)), 0.1)
    assert made.merge(showing(made, SEEN_OCCUPIED, 2.0, 5.9, 6.0, 6.2)) is None
    assert made.merge(showing(made, SEEN_OCCUPIED, 2.0, 5.7, 6.0, 6.2)).blocked.shape == (2, 40)


def test_unknown_space_seen_free_is_free_and_a_keepout_is_not():
    values, keepout = np.zeros(SHAPE, np.int8), np.zeros(SHAPE, bool)
    values[:, 35:45] = -1
    keepout[:, 38:42] = True
    made = PlanningMap(room(values, keepout=keepout), 0.1)
    patch = made.merge(showing(made, SEEN_FREE, 3.0, 1.0, 5.0, 5.0))
    assert (patch.left, patch.blocked.shape) == (35, (40, 10))
    assert (patch.blocked == keepout[10:50, 35:45]).all()
    assert (made.forget(), made.cleared.sum()) == (None, 240)


def test_coarse_maps_are_cut_into_smaller_cells_and_speed_limits_go_along():
    limit = np.full((6, 8), np.inf)
    limit[:, 4:] = 0.5
    made = PlanningMap(OccupancyGrid(np.zeros((6, 8), np.int8), 1.0, speed_limit=limit), 0.1)
    assert made.frame.resolution == pytest.approx(0.1)
    assert (made.factor, made.merged, made.blocked.shape) == (10, 1, (60, 80))
    found = made.speed_limit(np.array([(3.9, 3.0), (4.1, 3.0), (-1.0, 3.0), (7.9, 99.0)]))
    assert found.tolist() == [math.inf, 0.5, math.inf, math.inf]


@pytest.mark.parametrize(
    ("of_map", "wanted", "factor", "merged"),
    [(0.05, 0.05, 1, 1), (float(np.float32(0.05)), 0.05, 1, 1), (0.08, 0.05, 2, 1),
     (0.03, 0.05, 1, 1), (0.025, 0.05, 1, 2), (0.01, 0.05, 1, 5), (0.012, 0.05, 1, 4)],
)  # fmt: skip
def test_cells_of_both_maps_are_no_larger_than_wanted_and_fit(of_map, wanted, factor, merged):
    made = PlanningMap(OccupancyGrid(np.zeros((6, 8), np.int8), of_map), wanted)
    assert (made.factor, made.merged) == (factor, merged)
    assert made.lattice[0] == pytest.approx(merged * of_map / factor)
    assert made.lattice[0] <= wanted * (1.0 + 1e-6)


def test_a_turned_map_lies_as_it_is_seen_from_a_frame_that_is_turned_with_it():
    frame = GridFrame(0.1, 3.0, -2.0, 0.7)
    made = PlanningMap(room(frame=frame), 0.1)
    (x, y), turn = frame.to_world(23.5, 41.5), -0.7
    inward = math.cos(turn) * x - math.sin(turn) * y, math.sin(turn) * x + math.cos(turn) * y
    assert made.frame.to_grid(*inward) == pytest.approx((23.5, 41.5))
    assert made.frame.yaw == 0.0


@given(st.integers(0, 10**6), st.sampled_from([1, 2, 3]))
@settings(max_examples=40, deadline=None)
def test_it_takes_over_cell_by_cell_what_local_maps_show(seed, merged):
    """Windows partly or wholly off the map, against loops over the cells."""
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(20, 70, 2))
    values = rng.choice([0, 0, 0, 0, -1, 100], shape).astype(np.int8)
    keepout = rng.random(shape) < 0.1
    corner = rng.uniform(-20.0, 20.0, 2)
    grid = OccupancyGrid(values, GridFrame(0.05, *corner.tolist()), keepout)
    made = PlanningMap(grid, 0.05 * merged)
    assert made.merged == merged
    local_map = local_map_on(made, size=rng.uniform(2.0, 4.0))
    n, a = len(local_map.states), 0.05 * merged
    seen, cleared = made.seen.copy(), made.cleared.copy()
    for _ in range(3):
        local_map.follow(*(corner + rng.uniform(-2.0, 5.0, 2)))
        local_map.states[:] = rng.choice([UNSEEN, UNSEEN, SEEN_FREE, SEEN_OCCUPIED], (n, n))
        before = seen.copy(), cleared.copy()
        expected = local_map.states == SEEN_OCCUPIED
        origin = local_map.origin
        for i, j in np.ndindex(n, n):
            cells = [
                (
                    math.floor((origin[1] + i * a - corner[1]) / 0.05 + p + 0.5),
                    math.floor((origin[0] + j * a - corner[0]) / 0.05 + q + 0.5),
                )
                for p, q in np.ndindex(merged, merged)
            ]
            for cell in cells:
                if not all(0 <= k < size for k, size in zip(cell, shape, strict=True)):
                    expected[i, j] = True
                    continue
                if local_map.states[i, j] == SEEN_FREE:
                    seen[cell] = False
                    cleared[cell] |= values[cell] == -1 and not keepout[cell]
                elif local_map.states[i, j] == SEEN_OCCUPIED:
                    seen[cell] |= not made.known.mask[cell]
                prior = values[cell] != 0 or keepout[cell]
                expected[i, j] |= seen[cell] or (prior and not cleared[cell])
        patch = made.merge(local_map)
        changed = (seen != before[0]) | (cleared != before[1])
        assert (made.seen == seen).all()
        assert (made.cleared == cleared).all()
        assert (made.blocked == ((made.prior & ~cleared) | seen)).all()
        assert (patch is not None) == changed.any()
        if patch is not None:
            rows, columns = np.nonzero(changed)
            assert (patch.top, patch.left) == (rows.min(), columns.min())
            assert patch.blocked.shape == (np.ptp(rows) + 1, np.ptp(columns) + 1)
        assert (made.occupied_under(local_map) == expected).all()
    local_map.follow(500.0, 500.0)
    local_map.states[:] = SEEN_OCCUPIED
    assert made.merge(local_map) is None
    assert made.under(made.barred, local_map, True).all()
    assert not made.under(made.barred, local_map, False).any()


def test_the_zone_that_the_robot_stands_in_is_open_until_it_has_left_it():
    keepout = np.zeros(SHAPE, bool)
    keepout[20:40, 20:40] = keepout[20:40, 50:60] = True
    made = PlanningMap(room(keepout=keepout), 0.1)
    other = np.zeros(SHAPE, bool)
    other[20:40, 50:60] = True
    local_map = showing(made, UNSEEN, 0.0, 0.0, 0.0, 0.0)
    closed = made.occupied_under(local_map)
    for x, is_open in (
        (1.9, False),
        (2.5, True),
        (1.9, True),
        (1.71, True),
        (1.69, False),
        (1.9, False),
    ):
        made.place_robot(x, 3.0, 0.3)
        assert (made.barred == (other if is_open else keepout)).all()
        opened = closed & ~made.occupied_under(local_map)
        assert opened.sum() == (400 if is_open else 0)
    made.place_robot(-1.0, 3.0, 0.3)
    assert made.zone is None


def test_obstacles_in_an_open_zone_stay_closed():
    keepout, values = np.zeros(SHAPE, bool), np.zeros(SHAPE, np.int8)
    keepout[20:40, 20:40] = True
    values[30, 30] = 100
    made = PlanningMap(room(values, keepout=keepout), 0.1)
    local_map = showing(made, SEEN_OCCUPIED, 2.0, 2.0, 2.1, 2.3)
    made.merge(local_map)
    local_map.states[:] = UNSEEN
    closed = made.occupied_under(local_map)
    made.place_robot(2.5, 2.5, 0.3)
    assert (closed & ~made.occupied_under(local_map)).sum() == 400 - 4
