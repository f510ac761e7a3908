"""Keep-out zones and speed limits from masks of any resolution."""

import math
import tracemalloc

import numpy as np
import pytest

from dynastar.errors import ConfigError, MapError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.masks import SpeedScale, with_keepout, with_speed_limits, zone_around

GRID = OccupancyGrid(np.zeros((4, 6), np.int8), GridFrame(0.5, 1.0, 2.0))


def test_a_keep_out_mask_of_another_resolution_and_place_is_laid_over():
    mask = OccupancyGrid(np.array([[0, 100], [0, -1]], np.int8), GridFrame(1.0, 2.0, 2.0))
    keepout = with_keepout(GRID, mask).keepout
    assert np.argwhere(keepout).tolist() == [[0, 4], [0, 5], [1, 4], [1, 5]]
    both = with_keepout(with_keepout(GRID, mask), OccupancyGrid(np.full((1, 1), 100), 2.0))
    assert both.keepout.sum() == 4  # the other lies beside the map
    turned = OccupancyGrid(np.array([[100]], np.int8), GridFrame(1.0, 1.5, 2.5, np.pi / 4))
    assert with_keepout(GRID, turned).keepout[2, 1]


@pytest.mark.parametrize("column", range(12, 20))
def test_a_zone_one_cell_wide_of_a_finer_mask_is_kept(column):
    fine = np.zeros((40, 40), np.int8)
    fine[:, column] = 100
    grid = OccupancyGrid(np.zeros((20, 20), np.int8), GridFrame(0.05, 0.0, 0.0, 0.3))
    mask = OccupancyGrid(fine, GridFrame(0.025, 0.0, 0.0, 0.3))
    assert with_keepout(grid, mask).keepout[:, column // 2].all()
    assert with_keepout(grid, mask).keepout.sum() == 20
    limits = with_speed_limits(grid, OccupancyGrid(fine // 2, mask.frame), 1.0).speed_limit
    assert limits[:, column // 2] == pytest.approx(0.5)
    assert np.isinf(limits).sum() == 380


def test_a_zone_of_a_finer_mask_that_is_turned_is_kept():
    """A diagonal line, one cell wide, of a mask a third as wide: each of its cells lies in the zone."""
    fine = np.zeros((90, 90), np.int8)
    np.fill_diagonal(fine, 100)
    grid = OccupancyGrid(np.zeros((40, 40), np.int8), GridFrame(0.05, 0.0, 0.0, 0.2))
    mask = OccupancyGrid(fine, GridFrame(0.0167, 0.1, 0.3, 0.5))
    keepout = with_keepout(grid, mask).keepout
    for row, column in np.argwhere(fine):
        for part in (0.05, 0.5, 0.95):
            x, y = mask.frame.to_world(row + part, column + part)
            at = grid.frame.to_grid(x, y)
            inside = 0 <= at[0] < 40 and 0 <= at[1] < 40
            assert not inside or keepout[int(at[0]), int(at[1])]
    assert 0 < keepout.sum() < 150


def test_percentages_are_of_the_top_speed_and_zero_is_no_limit():
    values = np.array([[0, -1, 20, 100, 50, 0]] * 4, np.int8)
    mask = OccupancyGrid(values, GRID.frame)
    limits = with_speed_limits(GRID, mask, 2.0).speed_limit
    assert limits[0].tolist() == pytest.approx([np.inf, np.inf, 1.6, np.inf, 1.0, np.inf])
    absolute = SpeedScale("absolute", 0.0, 0.01)
    limits = with_speed_limits(GRID, mask, 2.0, absolute).speed_limit
    assert limits[1].tolist() == pytest.approx([np.inf, np.inf, 0.2, 1.0, 0.5, np.inf])
    lower = with_speed_limits(with_speed_limits(GRID, mask, 2.0), mask, 2.0, absolute)
    assert lower.speed_limit[0].tolist() == pytest.approx([np.inf, np.inf, 0.2, 1.0, 0.5, np.inf])


def test_masks_take_a_few_bytes_a_cell():
    cells = 2000 * 1500
    grid = OccupancyGrid(np.zeros((2000, 1500), np.int8), GridFrame(0.05, 0.0, 0.0, 0.4))
    pixel = OccupancyGrid(np.full((1, 1), 100), GridFrame(0.5, 5.0, 30.0))
    for lay in (
        lambda: with_keepout(grid, pixel).keepout,
        lambda: (
            with_speed_limits(grid, pixel, 2.0, SpeedScale("absolute", 0.0, 0.01)).speed_limit < 9
        ),
    ):
        tracemalloc.start()
        marked = lay()
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert most < 20 * cells
        assert marked.sum() == pytest.approx(100, abs=10)
        places = grid.frame.points_to_world(np.argwhere(marked) + 0.5)
        assert (np.abs(places - (5.25, 30.25)) <= 0.25 + 1e-9).all()


def test_limits_below_zero_and_scales_that_are_none_are_refused():
    mask = OccupancyGrid(np.full((4, 6), 100, np.int8), GRID.frame)
    with pytest.raises(MapError, match="down to -100"):
        with_speed_limits(GRID, mask, 2.0, SpeedScale("percent", 0.0, -1.0))
    with pytest.raises(ConfigError, match="expected one of 'percent', 'absolute'"):
        SpeedScale("m/s")


def test_a_zone_is_what_is_connected_with_a_cell_but_for_obstacles():
    keepout = np.zeros((6, 9), bool)
    keepout[1:4, 1:4] = keepout[4, 4] = keepout[1:4, 6:8] = True  # (4, 4) touches by its corner
    values = np.zeros((6, 9), np.int8)
    values[2, 2] = 100
    grid = OccupancyGrid(values, 1.0, keepout)
    zone = zone_around(grid, (1, 1))
    assert zone is not None
    assert zone.sum() == 8
    assert zone[1:4, 1:4].sum() == 8
    for cell in (2, 2), (0, 0), (5, 5):
        assert zone_around(grid, cell) is None
    assert zone_around(OccupancyGrid(values, 1.0), (1, 1)) is None


@pytest.mark.parametrize("size", [1.0, 1.2])
def test_a_zone_of_a_mask_that_is_turned_and_no_finer_is_kept(size):
    mask = OccupancyGrid([[100]], GridFrame(size, 3.0, 3.0 - size * math.sqrt(0.5), math.pi / 4))
    grid = with_keepout(OccupancyGrid(np.zeros((6, 6), np.int8)), mask)
    assert grid.keepout.sum() >= 1
    assert grid.keepout[2:5, 2:5].sum() == grid.keepout.sum()
