import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa.motion import Pose
from dynastar.field import bilinear
from dynastar.guidance import marching
from dynastar.guidance.cost_to_go import End, read, trace, turn_to_descent, value_at
from dynastar.guidance.travel_cost import travel_cost
from scenes import cost_to_go_of

A = 0.1


def marched(cost, row, column):
    """The cost-to-go over cells of ``A`` m whose metre costs ``cost``."""
    queue = marching.queue_for(cost.size)
    value = marching.march(cost, A, marching.Seed(row, column, 0.0), (row, column), 1e3, queue)
    return cost_to_go_of(value, marching.extend(value, A), A)


def plane(slope_x, slope_y):
    rows, columns = np.mgrid[:30, :30]
    value = slope_x * (columns + 0.5) * A + slope_y * (rows + 0.5) * A + 5.0
    return cost_to_go_of(value, value, A)


def test_the_middle_of_a_corridor_is_what_descends():
    y = (np.arange(40) + 0.5) * 0.05
    distance = np.tile(np.minimum(y, 2.0 - y)[:, None], (1, 160)).astype(np.float32)
    cost = travel_cost(distance, 2, 0.3, 0.6)
    line = trace(marched(cost, 10, 78), 0.5, 0.5, 90)
    assert len(line) > 60
    assert line[-1, 0] > 7.3
    assert abs(line[20:50, 1] - 1.0).max() < 0.15


def test_values_are_interpolated_between_cells_and_fall_along_the_descent():
    sloping = plane(0.6, -0.8)
    for x, y in np.random.default_rng(1).uniform(0.2, 2.8, (20, 2)):
        assert value_at(sloping, x, y) == pytest.approx(0.6 * x - 0.8 * y + 5.0)
        assert read(sloping, x, y)[1:] == pytest.approx((-0.6, 0.8))


@given(st.integers(0, 10**6))
@settings(deadline=None)
def test_a_value_is_the_bilinear_one_of_the_known_cells_round_the_point(seed):
    random = np.random.default_rng(seed)
    known = random.uniform(0.0, 9.0, (8, 8))
    value = np.where(random.random((8, 8)) < 0.3, np.inf, known)
    filled = np.where(np.isinf(value), 77.0, value)
    made = cost_to_go_of(value, filled, A)
    for x, y in random.uniform(0.06, 0.74, (20, 2)):
        column, row = int(x / A - 0.5), int(y / A - 0.5)
        right, up = x / A - 0.5 - column, y / A - 0.5 - row
        weights = np.outer((1.0 - up, up), (1.0 - right, right))
        corners = value[row : row + 2, column : column + 2]
        found, seen = value_at(made, x, y), np.isfinite(corners)
        if seen.all():
            assert found == pytest.approx(bilinear(made.value, x, y))
        elif weights[seen].sum() > 0.05:
            expected = (weights[seen] * corners[seen]).sum() / weights[seen].sum()
            assert found == pytest.approx(expected)
        else:  # that of the nearest cell
            assert found == filled[row + (up > 0.5), column + (right > 0.5)]


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(0.0, 0.3), st.floats(-3.1, 3.1))
@settings(deadline=None)
def test_the_value_falls_to_the_end_wherever_it_lies_in_its_cell(right, up, away, angle):
    cost, seed = np.ones((30, 30)), marching.Seed(15, 15, 2.0, right * A, up * A)
    value = marching.march(cost, A, seed, (15, 15), 1e3, marching.queue_for(cost.size))
    end_x, end_y = (15.5 + right) * A, (15.5 + up) * A
    made = cost_to_go_of(value, marching.extend(value, A), A, End(end_x, end_y, 2.0, 1.0))
    dx, dy = math.cos(angle), math.sin(angle)
    found, ux, uy = read(made, end_x + away * dx, end_y + away * dy)
    assert found == pytest.approx(2.0 + away, abs=1e-9 if away < A else 0.5 * A)
    if 1e-6 < away < A:
        assert (ux, uy) == pytest.approx((-dx, -dy))
    assert read(made, end_x, end_y) == (2.0, 0.0, 0.0)


@given(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1))
@settings(deadline=None)
def test_the_turn_to_the_descent_is_from_the_heading_to_its_direction(theta, downhill):
    falling = plane(-math.cos(downhill), -math.sin(downhill))
    pose = Pose(1.5, 1.5, math.cos(theta), math.sin(theta))
    for ahead in (0.0, 0.4):
        found = turn_to_descent(falling, pose, ahead)
        assert math.cos(found) == pytest.approx(math.cos(downhill - theta), abs=1e-6)
        assert math.sin(found) == pytest.approx(math.sin(downhill - theta), abs=1e-6)


def test_the_turn_to_the_descent_is_looked_up_ahead():
    rows, columns = np.mgrid[:30, :30]
    value = np.where(columns < 15, 5.0 + 0.1 * rows, 5.0 - 0.1 * rows)  # falls down, then up
    folded, pose = cost_to_go_of(value, value, A), Pose(1.0, 1.5, 1.0, 0.0)
    assert turn_to_descent(folded, pose, 0.0) < -1.0
    assert turn_to_descent(folded, pose, 1.0) > 1.0


def test_beside_walls_the_descent_leads_along_the_way_and_not_off_them():
    cost = np.full((30, 30), np.inf)
    cost[10:12, 3:27] = 1.0  # a corridor of two cells
    found = marched(cost, 10, 25)
    for x in np.arange(0.45, 2.3, 0.13):
        for y in (1.05, 1.1, 1.15):
            _, ux, uy = read(found, x, y)
            assert ux > 0.85
            assert abs(uy) < 0.5
    assert (found.descent_x[10, 25], found.descent_y[10, 25]) == (0.0, 0.0)  # the lowest value


def test_the_descent_is_a_unit_vector_inside_and_none_in_the_outermost_cells():
    found = marched(np.ones((12, 17)), 5, 9)
    size = np.hypot(found.descent_x, found.descent_y)
    assert (size[[0, -1]] == 0.0).all()
    assert (size[:, [0, -1]] == 0.0).all()
    size[5, 9] = 1.0
    assert size[1:-1, 1:-1] == pytest.approx(np.ones((10, 15)))


def test_a_trace_goes_down_in_steps_of_a_cell_and_ends_near_the_goal():
    found = marched(np.ones((40, 40)), 30, 35)
    line = trace(found, 0.5, 0.7, 60)
    assert len(line) < 60
    assert tuple(line[0]) == (0.5, 0.7)
    assert np.hypot(*np.diff(line, axis=0).T) == pytest.approx(A)
    assert (np.diff([value_at(found, x, y) for x, y in line]) < 0.0).all()
    assert math.dist(line[-1], (3.55, 3.05)) < 3.0 * A
