"""Passages between the larger free regions of a map: where they are, and how wide."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.check.passages import passages
from dynastar.clearance import distance_to_squares
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.planning.explain import _widest

CELL = 0.1  # m
ROWS, COLUMNS, WALL = 60, 80, 40


def walled(doors, thickness=3, frame=CELL):
    """Two rooms with a wall between them, and ``doors`` (first row, rows) in it."""
    occupied = np.zeros((ROWS, COLUMNS), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    occupied[:, WALL : WALL + thickness] = True
    for row, height in doors:
        occupied[row : row + height, WALL : WALL + thickness] = False
    return OccupancyGrid(occupied, frame)


def found(grid, area=2.0, width=0.25, unknown="blocked"):
    return passages(grid, unknown, area, width)


@given(st.integers(3, 20), st.integers(1, 35), st.integers(1, 8))
def test_a_door_has_its_width_and_its_place(height, row, thickness):
    [door] = found(walled([(row, height)], thickness))
    assert door.width == pytest.approx(CELL * height)
    assert CELL * (WALL - 1) <= door.x <= CELL * (WALL + thickness + 1)
    assert door.y == pytest.approx(CELL * (row + 0.5 * height), abs=CELL)
    assert door.area == pytest.approx(CELL * CELL * (COLUMNS - WALL) * ROWS, rel=0.3)


def test_the_wider_of_two_doors_is_the_passage():
    [door] = found(walled([(10, 6), (40, 9)]))
    assert (door.width, door.y) == (pytest.approx(0.9), pytest.approx(4.45, abs=CELL))


@pytest.mark.parametrize(
    ("doors", "area", "width"), [([], 2.0, 0.25), ([(20, 2)], 2.0, 0.25), ([(20, 6)], 50.0, 0.25)]
)
def test_no_passage_where_there_is_no_door_or_a_crack_or_a_closet(doors, area, width):
    assert found(walled(doors), area, width) == []


def test_a_corridor_of_one_width_is_no_passage():
    occupied = np.ones((40, 200), bool)
    occupied[10:22, 1:-1] = False
    assert found(OccupancyGrid.from_occupied(occupied, CELL)) == []


@pytest.mark.parametrize("corridor", [7, 10, 20])
def test_a_door_to_a_corridor_is_a_passage_if_it_is_narrower(corridor):
    occupied = np.ones((60, 120), bool)
    occupied[5:55, 5:55] = False
    occupied[30 : 30 + corridor, 58:-1] = False
    occupied[31:37, 55:58] = False
    [door] = found(OccupancyGrid.from_occupied(occupied, CELL))
    assert door.width == pytest.approx(0.6)


def test_a_wall_of_diagonal_cells_is_closed():
    occupied = np.zeros((60, 60), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    occupied[np.arange(60), np.arange(60)] = True
    assert found(OccupancyGrid.from_occupied(occupied, CELL), width=0.0) == []


def test_unknown_space_is_a_wall_or_none():
    values = walled([]).values.copy()
    values[20:28, WALL : WALL + 3] = -1
    grid = OccupancyGrid(values, CELL)
    assert found(grid) == []
    [door] = found(grid, unknown="free")
    assert door.width == pytest.approx(0.8)


def test_a_map_with_yaw_has_its_passages_in_the_world():
    plain, turned = (
        found(walled([(20, 8)], frame=GridFrame(CELL, 1.0, 2.0, yaw)))[0]
        for yaw in (0.0, math.pi / 2)
    )
    assert (turned.x - 1.0, turned.y - 2.0) == (
        pytest.approx(-(plain.y - 2.0)),
        pytest.approx(plain.x - 1.0),
    )


@pytest.mark.parametrize("value", [0, 100])
def test_a_map_that_is_all_free_or_all_blocked_has_none(value):
    assert found(OccupancyGrid(np.full((30, 30), value, np.int8), CELL)) == []


@given(st.integers(0, 10**6))
def test_a_passage_is_as_wide_as_the_widest_disc_that_passes_says(seed):
    """A door through random clutter, against a search for the widest disc from room to room."""
    random = np.random.default_rng(seed)
    grid = walled([(random.integers(5, 40), random.integers(4, 12))])
    clutter = grid.occupied.copy()
    clutter[2:-2, WALL - 4 : WALL + 7] |= random.random((ROWS - 4, 11)) < 0.05
    grid = OccupancyGrid(clutter, CELL)
    field = distance_to_squares(grid.blocked())
    rooms = field.copy(), field.copy()
    rooms[0][:, WALL - 6 :] = 0.0
    rooms[1][:, : WALL + 9] = 0.0
    ends = tuple(tuple(map(int, np.unravel_index(room.argmax(), room.shape))) for room in rooms)
    radius = _widest(field, ends)[0]
    wide = [one.width for one in found(grid, width=0.0)]
    if radius < 1.0:  # a disc of less than a cell: diagonal steps are judged otherwise
        assert not wide or min(wide) <= 5.0 * CELL
    else:
        assert min(wide) >= 2.0 * CELL * radius - 1e-4
        assert min(wide) <= CELL * (2.0 * radius + 3.0)
