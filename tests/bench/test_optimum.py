import math

import numpy as np
import pytest

from dynastar.bench.optimum import shortest_over_centres, shortest_over_corners
from dynastar.planning import SearchGrid


def length(line):
    return np.hypot(*np.diff(line, axis=0).T).sum()


def test_round_a_wall_the_bounds_turn_at_its_corners_and_beside_them():
    occupied = np.zeros((20, 30), bool)
    occupied[:15, 15] = True
    way = SearchGrid(occupied).search((7, 5), (7, 25)).cells + 0.5
    corner = 2.0 * math.hypot(7.5, 9.5) + 1.0
    centre = 2.0 * math.hypot(8.0, 9.0) + 2.0
    assert length(shortest_over_corners(occupied, way)) == pytest.approx(corner, abs=1e-5)
    assert corner < length(shortest_over_centres(occupied, way)) <= centre


def test_two_cells_that_touch_across_are_gone_round_and_not_between():
    occupied = np.zeros((9, 9), bool)
    occupied[4, 3] = occupied[5, 4] = True
    occupied[4, :3] = occupied[5, 5:] = True  # one wall from side to side
    occupied[4, 0] = False
    way = SearchGrid(occupied).search((2, 4), (7, 3)).cells + 0.5
    assert length(shortest_over_corners(occupied, way)) > math.dist(way[0], way[-1]) + 1.0


def test_where_nothing_stands_the_bound_is_the_line():
    occupied = np.zeros((9, 9), bool)
    way = SearchGrid(occupied).search((0, 0), (8, 3)).cells + 0.5
    for bound in (shortest_over_centres, shortest_over_corners):
        assert length(bound(occupied, way)) == pytest.approx(math.hypot(8, 3))
