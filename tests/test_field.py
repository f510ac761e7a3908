import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.field import Field, bilinear, is_inside, locate

A, X0, Y0 = 0.2, -1.0, 3.0
ROWS, COLUMNS = 7, 5
FIRST = X0 + 0.5 * A, Y0 + 0.5 * A  # centre of the first cell
LAST = X0 + (COLUMNS - 0.5) * A, Y0 + (ROWS - 0.5) * A  # of the last one
points = st.tuples(st.floats(X0 - 1.0, X0 + 2.0), st.floats(Y0 - 1.0, Y0 + 2.5))


def field(seed, dtype=np.float32):
    values = np.random.default_rng(seed).uniform(-5.0, 5.0, (ROWS, COLUMNS))
    return Field(values.astype(dtype), X0, Y0, A)


def separable(values, fx, fy):
    """Linear along the rows, then along the column of what that gives; constant outside."""
    by_row = [np.interp(fx, np.arange(COLUMNS), row) for row in values]
    return float(np.interp(fy, np.arange(ROWS), by_row))


@given(st.integers(0, 10**6), points, st.sampled_from([np.float32, np.float64]))
@settings(deadline=None)
def test_a_value_is_bilinear_between_centres_and_that_of_the_border_outside(seed, point, dtype):
    grid = field(seed, dtype)
    fx, fy = (point[0] - FIRST[0]) / A, (point[1] - FIRST[1]) / A
    expected = separable(grid.values, fx, fy)
    assert bilinear(grid, *point) == pytest.approx(expected, abs=0.03)  # a border is 1.001 cells in
    if 0.0 <= fx <= COLUMNS - 1.01 and 0.0 <= fy <= ROWS - 1.01:
        assert bilinear(grid, *point) == pytest.approx(expected, abs=1e-5)


@given(points)
@settings(deadline=None)
def test_a_point_is_located_by_the_cell_below_and_left_of_it(point):
    row, column, up, right = locate(field(0), *point)
    assert 0 <= row <= ROWS - 2
    assert 0 <= column <= COLUMNS - 2
    assert 0.0 <= up < 1.0
    assert 0.0 <= right < 1.0
    if is_inside(field(0), *point):
        assert FIRST[0] + (column + right) * A == pytest.approx(point[0], abs=0.0011 * A)
        assert FIRST[1] + (row + up) * A == pytest.approx(point[1], abs=0.0011 * A)


@pytest.mark.parametrize(
    ("x", "y", "inside"),
    [
        (FIRST[0] + 1e-9, FIRST[1] + 1e-9, True),
        (FIRST[0] - 1e-9, 4.0, False),
        (0.0 - 1e-6, FIRST[1] - 1e-9, False),
        (LAST[0] - 1e-9, LAST[1] - 1e-9, True),
        (LAST[0] + 1e-9, 4.0, False),
        (-0.5, LAST[1] + 1e-9, False),
        (-0.5, 4.0, True),
    ],
)
def test_inside_is_between_the_centres_of_the_outermost_cells(x, y, inside):
    assert is_inside(field(0), x, y) == inside


def test_at_a_centre_the_value_is_the_cells():
    grid = field(3)
    for row in range(ROWS - 1):
        for column in range(COLUMNS - 1):
            x, y = FIRST[0] + column * A, FIRST[1] + row * A
            assert bilinear(grid, x, y) == pytest.approx(grid.values[row, column], abs=1e-5)
