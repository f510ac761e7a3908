import numpy as np
import pytest

from dynastar.episode import Episode
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.viewer import palette
from dynastar.viewer.view import View, averaged_down, known_view, map_image, mission_view


def test_the_known_part_is_shown(office: Episode):
    view = known_view(office.grid)
    assert view.x_low == pytest.approx(-0.94, abs=0.1)
    assert view.x_high == pytest.approx(40.94, abs=0.1)
    blank = OccupancyGrid(np.full((4, 6), -1))
    assert known_view(blank) == View(0.0, 0.0, 6.0, 4.0)


def test_a_yawed_map_is_shown_whole():
    grid = OccupancyGrid(np.zeros((2, 4), dtype=np.int8), GridFrame(1.0, 5.0, 5.0, np.pi / 2))
    assert known_view(grid) == pytest.approx((3.0, 5.0, 5.0, 9.0))


def test_a_small_mission_is_shown_close_up(office: Episode):
    near = mission_view(office.grid, [np.array([(3.0, 3.0), (5.0, 5.0)])])
    assert near == pytest.approx((1.0, 1.0, 7.0, 7.0))
    assert mission_view(office.grid, [office.trajectory.poses[:, :2]]) == known_view(office.grid)
    assert mission_view(office.grid, [np.empty((0, 2))]) == known_view(office.grid)


def test_the_window_covers_the_view_and_no_more():
    grid = OccupancyGrid(np.zeros((50, 80), dtype=np.int8), GridFrame(0.5, -5.0, 2.0))
    window = map_image(grid, View(0.0, 3.0, 10.0, 8.0))
    assert window[1:] == (2, 10, 12, 30)
    assert window.rgb.shape == (10, 20, 3)


def test_what_each_cell_looks_like():
    values = np.array([[0, 100, -1, 0, 0]])
    keepout = np.array([[False, False, False, True, False]])
    limit = np.array([[np.inf, np.inf, np.inf, np.inf, 0.5]])
    grid = OccupancyGrid(values, GridFrame(1.0), keepout, limit)
    colours = ["#" + bytes(cell).hex() for cell in map_image(grid, known_view(grid)).rgb[0]]
    assert colours == [
        *(palette.FREE, palette.OCCUPIED, palette.UNKNOWN),
        *(palette.KEEPOUT, palette.SLOW),
    ]


def test_large_images_are_averaged():
    image = np.zeros((300, 600, 3), dtype=np.uint8)
    image[:, ::2] = 200
    small = averaged_down(image, 300)
    assert small.shape == (150, 300, 3)
    assert small.mean() == pytest.approx(100.0, abs=1.0)
    assert averaged_down(small, 300) is small
