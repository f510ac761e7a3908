import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dynastar.planning.inflated import InflatedGrid
from naive import clearance

ROUNDING = 1e-6  # cells


@given(st.integers(0, 10**9))
@settings(max_examples=60, deadline=None)
def test_the_fitting_cell_is_the_nearest_that_the_disc_can_reach_straight(seed):
    rng = np.random.default_rng(seed)
    blocked = rng.random((5, 6)) < 0.15
    radius = float(rng.choice([0.3, 0.6, 1.0, 1.3]))
    point = tuple(rng.uniform(0.0, blocked.shape))
    here = tuple(map(int, point))
    gaps = {}
    for r in range(max(here[0] - 1, 0), min(here[0] + 2, 5)):
        for c in range(max(here[1] - 1, 0), min(here[1] + 2, 6)):
            gap = clearance(blocked, [point, (r + 0.5, c + 0.5)])
            assume(abs(gap - radius) > ROUNDING)
            if not blocked[r, c] and gap > radius:
                gaps[math.dist(point, (r + 0.5, c + 0.5))] = (r, c)
    expected = gaps[min(gaps)] if gaps else None
    assert InflatedGrid(blocked, radius, 1).fitting_cell(point) == expected


def test_a_mark_counts_from_the_next_use_on():
    grid = InflatedGrid(np.zeros((20, 20), bool), 0.7, 1)
    assert grid.fitting_cell((10.5, 10.5)) == (10, 10)
    grid.mark(10, 11, [[True]])
    grid.mark(3, 3, [[True, True]])
    assert grid.fitting_cell((10.5, 10.1)) == (10, 9)
    assert np.argwhere(grid.blocked).tolist() == [[3, 3], [3, 4], [10, 11]]
    assert grid.search.sums[-1, -1] == 3
    grid.mark(10, 11, [[False]])
    assert grid.fitting_cell((10.5, 10.5)) == (10, 10)
