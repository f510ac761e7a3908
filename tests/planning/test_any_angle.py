import itertools

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dynastar.clearance import inflate
from dynastar.errors import NoPath
from dynastar.planning import SearchGrid, segment_clear, smooth, straighten
from naive import clearance, straight_lines


def length(points):
    return np.hypot(*np.diff(points, axis=0).T).sum()


def world(seed, size, density, radius):
    """A mask, and a way over the centres of cells where a disc fits."""
    rng = np.random.default_rng(seed)
    blocked = rng.random(rng.integers(size // 2, size, 2)) < density
    grid = SearchGrid(inflate(blocked, radius))
    free = np.argwhere(~grid.occupied)
    assume(len(free) > 1)
    start, goal = (tuple(map(int, free[i])) for i in (0, -1))
    try:
        return blocked, grid.search(start, goal).cells + 0.5
    except NoPath:
        assume(False)


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.6, 1.4]))
@settings(max_examples=60, deadline=None)
def test_over_the_whole_map_it_is_the_shortest_over_all_straight_lines(seed, radius):
    blocked, way = world(seed, 10, 0.2, radius)
    cells = np.argwhere(~blocked) + 0.5
    fits = [p for p in cells if segment_clear(blocked, p, p, radius)]
    points = [way[0], *fits, way[-1]]
    expected = straight_lines(lambda a, b: segment_clear(blocked, a, b, radius), points)
    assert length(straighten(blocked, way, radius, reach=10)) == pytest.approx(expected)


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.6, 1.4]))
@settings(max_examples=100, deadline=None)
def test_near_a_way_it_is_clear_and_no_longer_than_what_is_known(seed, radius):
    blocked, way = world(seed, 30, 0.15, radius)
    taut = smooth(blocked, way, radius)
    found = straighten(blocked, way, radius, taut)
    assert (found[0] == way[0]).all()
    assert (found[-1] == way[-1]).all()
    near, anywhere = (straighten(blocked, way, radius, reach=reach) for reach in (3, 30))
    assert (
        length(found) <= min(length(taut), length(near)) + 1e-9
    )  # the taut one leaves the centres
    assert length(anywhere) <= length(near) + 1e-9
    if radius > 0.0:
        assert clearance(blocked, found) >= radius - 1e-6
    for a, b in itertools.pairwise(found):
        assert segment_clear(blocked, a, b, radius)


def test_short_ways_stay_as_they_are():
    free = np.zeros((3, 3), bool)
    for way in ([[0.5, 0.5]], [[0.5, 0.5], [1.5, 1.5]]):
        assert straighten(free, way, 0.0).tolist() == way
