import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.field import Field
from dynastar.guidance.seed import RIM, nearest_open, path_exit_cell
from dynastar.path import Path

A, N = 0.2, 30
REACH = 3


def open_field():
    return Field(np.ones((N, N)), -1.0, 2.0, A)


def slow_nearest(cost, row, column, reach):
    """Distance (cells) to the nearest open cell within ``reach`` rows and columns, else inf."""
    least = math.inf
    for i, j in np.argwhere(np.isfinite(cost)):
        if max(abs(i - row), abs(j - column)) <= reach:
            least = min(least, math.hypot(i - row, j - column))
    return least


@given(st.integers(0, 10**6), st.sampled_from([0.3, 0.9, 1.0]))
@settings(deadline=None)
def test_the_nearest_open_cell_is_found_within_reach(seed, closed):
    random = np.random.default_rng(seed)
    cost = np.where(random.random((12, 15)) < closed, np.inf, 1.0)
    row, column = (int(random.integers(n)) for n in cost.shape)
    found = nearest_open(cost, row, column, REACH)
    least = slow_nearest(cost, row, column, REACH)
    if least == math.inf:
        assert found == (row, column)
    else:
        assert np.isfinite(cost[found])
        assert math.dist(found, (row, column)) == pytest.approx(least)


def exit_of(points, cost, begin=0.0, end=math.inf):
    """The exit cell of a path, its arc length, and the path."""
    path = Path(np.array(points, float))
    span = begin, min(path.length, end)
    row, column, s = path_exit_cell(path.points, path.arc, span, cost, REACH)
    return (int(row), int(column)), float(s), path


@given(st.integers(0, 10**6))
@settings(deadline=None)
def test_the_exit_is_the_last_cell_before_the_path_first_leaves(seed):
    random = np.random.default_rng(seed)
    cost, middle = open_field(), (2.0, 5.0)
    cell, s, path = exit_of([middle, *random.uniform(-4.0, 11.0, (3, 2))], cost)
    low, high = np.array([-1.0, 2.0]) + RIM * A, np.array([-1.0, 2.0]) + (N - RIM) * A
    count = max(2, math.ceil(path.length / (0.5 * A)) + 1)  # what is shorter may be passed over
    lengths = np.linspace(0.0, path.length, count)
    places = np.column_stack([np.interp(lengths, path.arc, axis) for axis in path.points.T])
    outside = ((places < low) | (places >= high)).any(axis=1)
    last = max(int(np.argmax(outside)) - 1, 0) if outside.any() else count - 1
    assert s == pytest.approx(lengths[last])
    x, y = (np.interp(s, path.arc, axis) for axis in path.points.T)
    assert cell == (math.floor((y - 2.0) / A), math.floor((x + 1.0) / A))


def test_a_path_that_stays_inside_ends_at_its_end_or_at_that_of_the_span():
    cost, points = open_field(), [(0.1, 5.1), (3.1, 5.1)]
    assert exit_of(points, cost)[:2] == ((15, 20), pytest.approx(3.0))
    assert exit_of(points, cost, 0.5, 2.0)[:2] == ((15, 15), pytest.approx(2.0))
    assert exit_of([(0.1, 5.1)], cost)[:2] == ((15, 5), 0.0)  # a single point


def test_a_path_that_begins_outside_starts_at_the_nearest_cell():
    cell, s, _ = exit_of([(-3.0, 5.1), (3.0, 5.1)], open_field())
    assert cell == (15, 0)
    assert s == 0.0


def test_an_exit_where_the_robot_does_not_fit_moves_back_along_the_path():
    cost = open_field()
    cost.values[:, 16:] = np.inf
    cell, s, _ = exit_of([(0.1, 5.1), (9.0, 5.1)], cost)
    assert cell == (15, 15)  # the nearest open cell of the first place within reach of one
    assert s == pytest.approx((15 + REACH + 1) * A - 1.0 - 0.1, abs=0.5 * A + 1e-9)
    cost.values[:] = np.inf  # nowhere: where the path leaves
    cell, s, _ = exit_of([(0.1, 5.1), (9.0, 5.1)], cost)
    assert cell == (15, N - RIM - 1)
    assert s == pytest.approx((N - RIM) * A - 1.0 - 0.1, abs=0.5 * A + 1e-9)
