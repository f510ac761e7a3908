import heapq
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.guidance import marching
from naive import shortest

A = 0.1


def march(cost, row, column, begin=0.0, stop=None, beyond=1e3):
    seed, stop = marching.Seed(row, column, begin), stop or (row, column)
    return marching.march(cost, A, seed, stop, beyond, marching.queue_for(cost.size))


def walled(inner):
    """Costs with a rim round them, which no march enters."""
    return np.pad(inner, 1, constant_values=np.inf)


def by_heap(cost, seed):
    """Fast marching by the book: the least of the open values is final. Exact around the seed."""
    value = np.full(cost.shape, np.inf)
    value[seed] = 0.0
    for i, j in marching.AROUND:
        (r, c), at = seed, (seed[0] + i, seed[1] + j)
        if max(cost[at], cost[r + i, c], cost[r, c + j]) < np.inf:
            value[at] = math.hypot(i, j) * A * cost[at]
    done = np.zeros(cost.shape, bool)
    queue = [(value[r, c], (r, c)) for r, c in np.argwhere(np.isfinite(value)).tolist()]
    heapq.heapify(queue)
    while queue:
        _, (row, column) = heapq.heappop(queue)
        if done[row, column]:
            continue
        done[row, column] = True
        for r, c in ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)):
            if cost[r, c] == np.inf or done[r, c]:
                continue
            final = np.where(done, value, np.inf)
            across, along = min(final[r, c - 1 : c + 2 : 2]), min(final[r - 1 : r + 2 : 2, c])
            step = cost[r, c] * A
            if abs(across - along) < step:
                apart = across - along
                new = 0.5 * (across + along + math.sqrt(2.0 * step**2 - apart**2))
            else:
                new = min(across, along) + step
            if new < value[r, c]:
                value[r, c] = new
                heapq.heappush(queue, (new, (r, c)))
    return value


@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.1, 0.25, 0.4]))
@settings(max_examples=60, deadline=None)
def test_the_march_is_as_long_as_the_shortest_way_and_reaches_the_same_cells(seed, share):
    random = np.random.default_rng(seed)
    blocked = np.pad(random.random((30, 40)) < share, 1, constant_values=True)
    start = tuple(random.integers(1, (31, 41)))
    blocked[start] = False
    value = march(np.where(blocked, np.inf, 1.0), *start, begin=2.0)
    lengths = shortest(blocked, start)  # in steps straight or diagonal: up to 8 % too long
    for cell in np.ndindex(value.shape):
        if cell not in lengths:
            assert value[cell] == np.inf
        else:
            way = lengths[cell] * A
            assert 0.9 * way - 1e-6 <= value[cell] - 2.0 <= 1.15 * way + 0.05
            if share == 0.0:
                euclid = math.dist(start, cell) * A
                assert euclid - 1e-6 <= value[cell] - 2.0 <= 1.15 * euclid + 0.05


@given(st.integers(0, 10**6), st.sampled_from([1.0, 10.0, 300.0]))
@settings(max_examples=30, deadline=None)
def test_a_queue_of_buckets_gives_what_a_heap_gives(seed, dearest):
    """Up to a metre that costs so much that it lies beyond the last bucket."""
    random = np.random.default_rng(seed)
    inner = np.exp(random.uniform(0.0, math.log(dearest) + 1e-9, (20, 25)))
    inner[random.random(inner.shape) < 0.2] = np.inf
    cost = walled(inner)
    start = tuple(random.integers(1, (21, 26)))
    cost[start] = 1.0
    expected = by_heap(cost, start)
    np.testing.assert_allclose(march(cost, *start), expected, atol=1e-3)


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
@settings(max_examples=40, deadline=None)
def test_values_grow_from_a_point_that_is_no_cells_centre(right, up):
    seed = marching.Seed(20, 20, 3.0, right * A, up * A)
    cost = walled(np.ones((39, 39)))
    cost[20, 21] = np.inf
    value = marching.march(cost, A, seed, (20, 20), 1e3, marching.queue_for(cost.size))
    assert value[20, 21] == np.inf
    for row, column in ((20, 20), (19, 20), (20, 19), (17, 16), (5, 20), (30, 8)):
        away = math.hypot(column - 20 - right, row - 20 - up) * A
        assert value[row, column] == pytest.approx(3.0 + away, rel=0.03, abs=0.03)


def test_a_slow_region_costs_as_much_more_as_it_is_slow():
    inner = np.ones((5, 40))
    inner[:, 10:30] = 3.0
    value = march(walled(inner), 3, 1)[1:-1, 1:-1]
    assert value[2, 9] == pytest.approx(0.9)
    assert value[2, 29] == pytest.approx(0.9 + 6.0)
    assert value[2, 39] == pytest.approx(0.9 + 6.0 + 1.0)


def test_the_march_ends_a_while_after_where_it_is_asked_for():
    value = march(walled(np.ones((5, 100))), 3, 1, stop=(3, 41), beyond=1.0)[1:-1, 1:-1]
    assert value[2, 40] == pytest.approx(4.0)
    assert np.isfinite(value[2, 49])
    assert value[2, 52] == np.inf


def test_the_outermost_cells_are_closed_wherever_the_march_begins():
    value = march(np.ones((6, 8)), 0, 7)
    assert np.isinf(value[[0, -1]]).all()
    assert np.isinf(value[:, [0, -1]]).all()
    assert np.isfinite(value[1:-1, 1:-1]).all()
    assert value[1, 6] == 0.0


def test_from_where_no_way_leads_the_filled_values_lead_out():
    cost = np.ones((30, 30))
    cost[10:20, 10:20] = np.inf
    value = march(cost, 15, 2)
    filled = marching.extend(value, A)
    inside = filled[10:20, 10:20]
    assert np.isfinite(filled).all()
    assert (filled[np.isfinite(value)] == value[np.isfinite(value)]).all()
    assert inside.min() > value[np.isfinite(value)].min() + marching.WALL_COST * A
    for row, column in np.ndindex(inside.shape):  # some neighbour is lower
        r, k = row + 10, column + 10
        around = filled[r - 1, k], filled[r + 1, k], filled[r, k - 1], filled[r, k + 1]
        assert min(around) < filled[r, k]
