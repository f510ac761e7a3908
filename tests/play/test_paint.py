"""Painted cells, against shapely and against a plain list of cells."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.play.paint import CELL, MOST_CELLS, WITHIN, Paint

GRID = OccupancyGrid(np.zeros((20, 30), np.int8), GridFrame(0.2, 1.0, -2.0, 0.3))  # 6 m x 4 m
place = st.tuples(st.integers(-100, 800), st.integers(-300, 500)).map(
    lambda p: (p[0] / 100, p[1] / 100)
)
stroke = st.tuples(st.lists(place, min_size=1, max_size=4), st.floats(0.05, 0.6), st.booleans())


@given(st.lists(stroke, max_size=5))
def test_rectangles_cover_what_was_painted_and_nothing_else(strokes):
    paint, cells = Paint(GRID), np.indices((40, 60)).reshape(2, -1).T + 0.5
    centres = GridFrame(CELL, *GRID.frame[1:]).points_to_world(cells)
    expected = np.zeros(len(centres), bool)
    for points, radius, erase in strokes:
        paint.stroke(points, radius, erase)
        line = shapely.LineString(points * 2 if len(points) == 1 else points)
        near = shapely.distance(line, shapely.points(centres)) <= max(radius, WITHIN * CELL)
        expected[near] = not erase
        paint.renew()
    found = np.zeros(len(centres), int)
    for ring in paint.rings:
        polygon = shapely.Polygon(ring)
        assert polygon.is_valid
        found += shapely.contains_xy(polygon, *centres.T)
    assert found.max(initial=0) <= 1
    assert (found != expected).sum() <= 0.002 * len(centres)  # rounding on a stroke's edge


def test_a_wall_is_a_few_rectangles():
    paint = Paint(OccupancyGrid(np.zeros((10, 10), np.int8), 1.0))
    paint.stroke([(2.05, 5.05), (8.05, 5.05)], 0.15)
    paint.renew()
    assert 1 <= len(paint.rings) <= 8
    assert shapely.union_all([shapely.Polygon(r) for r in paint.rings]).area == pytest.approx(
        1.9, abs=0.3
    )


def test_cells_are_kept_clear_and_absent_places_passed_over():
    paint = Paint(GRID)
    paint.stroke([(3.0, 0.0)], 1.0)
    paint.keep_clear(np.array([[3.0, 0.0], [math.nan, math.nan]]), np.array([0.5, 1.0]))
    paint.renew()
    solid = shapely.union_all([shapely.Polygon(ring) for ring in paint.rings])
    assert solid.distance(shapely.Point(3.0, 0.0)) >= 0.5 - CELL


def test_large_maps_have_larger_cells_and_strokes_off_the_map_paint_nothing():
    paint = Paint(OccupancyGrid(np.zeros((100, 100), np.int8), 50.0))
    paint.stroke([(2500.0, 2500.0)], 2.0)
    assert [ring.shape for ring in paint.renew()] == [(4, 2)]
    paint.stroke([(-100.0, -100.0), (-200.0, 9000.0)], 2.0)
    paint.stroke([(-1e6, 1e6), (-1e6, 1e6)], 2.0)
    assert paint.renew() == []
    side = float(np.ptp(paint.rings[0][:, 0]))
    assert side >= 5000.0 / MOST_CELLS - 1e-9


def test_a_long_line_paints_the_part_that_is_over_the_map():
    paint = Paint(GRID)
    place = GRID.frame.points_to_world([[-1e7, 15.0], [1e7, 15.0]])
    paint.stroke(place, 0.1)
    paint.renew()
    area = sum(shapely.Polygon(ring).area for ring in paint.rings)
    assert area == pytest.approx(4.0 * 0.2, abs=0.41)


def test_a_stroke_makes_only_the_rectangles_that_it_changes():
    paint = Paint(OccupancyGrid(np.zeros((500, 500), np.int8), 0.2))
    for k in range(0, 100, 2):
        paint.stroke([(k, 1.0), (k, 99.0)], 0.1)
    paint.renew()
    before = {id(ring): ring for ring in paint.rings}
    paint.stroke([(51.0, 51.0)], 0.2)
    new = paint.renew()
    assert len(before) > 1000
    assert 1 <= len(new) <= 5
    assert {id(ring) for ring in paint.rings} == {*before, *map(id, new)}
    paint.stroke([(51.0, 51.0)], 0.2)
    assert paint.renew() == []
