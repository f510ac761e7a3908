"""The grid model: Eq. 1, states, and the way between world and cells."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dynastar.errors import ConfigError, MapError, OutOfMap
from dynastar.grid import GridFrame, OccupancyGrid

metres = st.floats(-1e3, 1e3)
frames = st.builds(GridFrame, st.floats(0.01, 10.0), metres, metres, st.floats(-7, 7))
sizes = st.tuples(st.integers(1, 9), st.integers(1, 9))


def empty(rows: int, columns: int, frame: GridFrame = GridFrame(1.0)) -> OccupancyGrid:
    return OccupancyGrid(np.zeros((rows, columns), bool), frame)


def test_the_papers_grid_is_numbered_from_the_top_left():
    grid = empty(20, 20)
    assert grid.numbered(1) == (19, 0)
    assert grid.numbered(20) == (19, 19)
    assert grid.numbered(400) == (0, 19)
    assert grid.centre(1) == (0.5, 19.5)
    assert grid.centre(20) == (19.5, 19.5)
    assert grid.centre(381) == (0.5, 0.5)


@given(sizes, st.floats(0.01, 10.0))
def test_eq_1_and_its_inverse(size, resolution):
    rows, columns = size
    grid = empty(rows, columns, GridFrame(resolution))
    seen = set()
    for i in range(1, rows * columns + 1):
        row, column = grid.numbered(i)
        assert grid.number(row, column) == i
        seen.add((row, column))
        x = resolution * ((i - 1) % columns + 0.5)
        y = resolution * (rows - math.ceil(i / columns) + 0.5)
        assert grid.centre(i) == (x, y)
        assert grid.cell_to_world(row, column) == pytest.approx((x, y))
    assert len(seen) == rows * columns
    for i in (0, rows * columns + 1):
        with pytest.raises(OutOfMap, match=f"cell {i} "):
            grid.numbered(i)


@given(sizes, frames, st.data())
def test_world_to_cell_and_back(size, frame, data):
    grid = empty(*size, frame)
    row = data.draw(st.integers(0, grid.rows - 1))
    column = data.draw(st.integers(0, grid.columns - 1))
    inside = data.draw(st.tuples(st.floats(0.01, 0.99), st.floats(0.01, 0.99)))
    point = frame.to_world(row + inside[0], column + inside[1])
    assert grid.contains(*point)
    assert grid.world_to_cell(*point) == (row, column)
    assert frame.to_grid(*point) == pytest.approx((row + inside[0], column + inside[1]), abs=1e-6)
    assert math.dist(grid.cell_to_world(row, column), point) <= frame.resolution


@given(frames, hnp.arrays(np.float64, (3, 2), elements=st.floats(-50, 50)))
def test_many_points_convert_as_one_does(frame, cells):
    world = frame.points_to_world(cells)
    assert world == pytest.approx(np.array([frame.to_world(*cell) for cell in cells]))
    assert frame.points_to_grid(world) == pytest.approx(cells, abs=1e-6)


def test_a_turned_origin_turns_the_map():
    grid = empty(2, 4, GridFrame(1.0, 10.0, 0.0, math.pi / 2))
    assert grid.cell_to_world(0, 3) == pytest.approx((9.5, 3.5))
    assert grid.world_to_cell(8.5, 0.5) == (1, 0)
    assert grid.extent() == "x 8 to 10, y 0 to 4 m"


@pytest.mark.parametrize(
    "point", [(-0.001, 0.5), (0.5, -0.001), (3.0, 0.5), (0.5, 2.0), (math.nan, 1), (1, math.inf)]
)
def test_nothing_off_the_map_wraps_round(point):
    grid = empty(2, 3)
    assert not grid.contains(*point)
    with pytest.raises(OutOfMap, match=r"spans x 0 to 3, y 0 to 2 m"):
        grid.world_to_cell(*point)
    for cell in ((-1, 0), (0, -1), (2, 0), (0, 3)):
        with pytest.raises(OutOfMap, match="2 rows, 3 columns"):
            grid.cell_to_world(*cell)
        with pytest.raises(OutOfMap):
            grid.number(*cell)


@given(
    hnp.arrays(
        np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=6), elements=st.integers(-1, 100)
    )
)
def test_every_cell_is_free_occupied_or_unknown(values):
    grid = OccupancyGrid(values)
    for row, column in np.ndindex(values.shape):
        value = values[row, column]
        assert grid.occupied[row, column] == (value >= 65)
        assert grid.unknown[row, column] == (value == -1 or 19 < value < 65)
        assert grid.blocked("free")[row, column] == (value >= 65)
        assert grid.blocked()[row, column] == (value == -1 or value > 19)


def test_keepout_blocks_and_is_not_occupied():
    grid = OccupancyGrid(np.zeros((1, 3), bool), keepout=np.array([[False, True, False]]))
    assert grid.blocked().tolist() == [[False, True, False]]
    assert grid.blocked("free").tolist() == [[False, True, False]]
    assert not grid.occupied.any()


def test_an_unknown_policy_is_not_taken_for_free():
    with pytest.raises(ConfigError, match="'free' or 'blocked'"):
        empty(1, 1).blocked("fre")  # type: ignore[arg-type]


def test_what_a_grid_holds_is_its_own_and_read_only():
    values = np.zeros((2, 2), np.int8)
    grid = OccupancyGrid(values, speed_limit=np.ones((2, 2)))
    values[0, 0] = 100
    assert not grid.occupied.any()
    assert grid.speed_limit is not None
    assert grid.speed_limit.dtype == np.float32
    for array in (grid.values, grid.speed_limit):
        assert array.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"values": np.zeros(3, np.int8)}, "shape"),
        ({"values": np.zeros((0, 3), np.int8)}, "both > 0"),
        ({"values": np.zeros((2, 2))}, "integers from -1 to 100"),
        ({"values": np.full((2, 2), 101)}, "integers from -1 to 100"),
        ({"values": np.full((2, 2), -2)}, "integers from -1 to 100"),
        ({"frame": GridFrame(0.0)}, "resolution > 0"),
        ({"frame": GridFrame(math.nan)}, "resolution > 0"),
        ({"frame": GridFrame(1.0, math.inf)}, "all finite"),
        ({"keepout": np.zeros((3, 2), bool)}, "keepout has shape"),
        ({"speed_limit": np.zeros((2, 2))}, "speed limit has to be > 0"),
        ({"speed_limit": np.full((2, 2), math.nan)}, "speed limit has to be > 0"),
    ],
)
def test_what_cannot_be_a_grid_is_refused(arguments, message):
    with pytest.raises(MapError, match=message):
        OccupancyGrid(**({"values": np.zeros((2, 2), np.int8)} | arguments))


def test_a_drawing_has_its_top_row_first_and_short_lines_are_free():
    grid = OccupancyGrid.from_text("\n#?.\n#\n", 0.5, 1.0, 2.0)
    assert grid.values.tolist() == [[100, 0, 0], [100, -1, 0]]
    assert grid.frame == GridFrame(0.5, 1.0, 2.0)
    assert OccupancyGrid.from_text(["#"]).values.tolist() == [[100]]


@pytest.mark.parametrize("text", ["", [], [""], "\n\n"])
def test_a_drawing_of_nothing_is_refused(text):
    with pytest.raises(MapError, match="both > 0"):
        OccupancyGrid.from_text(text)


@pytest.mark.parametrize("text", ["..\n.x", "..\n.\u00e9", "..\n.\t"])
def test_a_drawing_with_another_mark_says_where(text):
    with pytest.raises(MapError, match="line 2, column 2"):
        OccupancyGrid.from_text(text)


@given(sizes, st.integers(1, 4), frames, st.data())
def test_refining_keeps_what_is_where(size, factor, frame, data):
    values = data.draw(hnp.arrays(np.int8, size, elements=st.sampled_from([-1, 0, 100])))
    grid = OccupancyGrid(values, frame, keepout=values > 0, speed_limit=values + 2.0)
    fine = grid.refined(factor)
    assert fine.values.shape == (size[0] * factor, size[1] * factor)
    point = data.draw(st.tuples(st.floats(0.01, 0.99), st.floats(0.01, 0.99)))
    assume(all(0.01 < p * size[k] * factor % 1 < 0.99 for k, p in enumerate(point)))
    at = frame.to_world(point[0] * size[0], point[1] * size[1])
    coarse_cell, fine_cell = grid.world_to_cell(*at), fine.world_to_cell(*at)
    assert fine.values[fine_cell] == grid.values[coarse_cell]
    assert fine.keepout is not None
    assert fine.keepout[fine_cell] == (grid.values[coarse_cell] > 0)
    with pytest.raises(MapError, match="refined by 0"):
        grid.refined(0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: OccupancyGrid([[1, 2], [3]]), r"a grid is \[\[1, 2\], \[3\]\]: expected numbers"),
        (lambda: OccupancyGrid.from_occupied([[1, 2], [3]]), "a grid is"),
        (lambda: OccupancyGrid([[0, 0]], 10**400), "a grid's frame is 10.*: expected a GridFrame"),
        (lambda: OccupancyGrid([[0, 0]], "0.05"), "a grid's frame is '0.05'"),
        (lambda: OccupancyGrid([[0, 0]], GridFrame("0.05")), "a grid's frame is GridFrame"),
        (lambda: OccupancyGrid.from_occupied([[0, 0]], "0.05"), "a grid's frame is GridFrame"),
        (lambda: OccupancyGrid([[0, 0]], keepout=[[0], [0, 1]]), "keepout is"),
        (lambda: OccupancyGrid.from_text(3), "a drawn map is 3: expected a string"),
        (lambda: OccupancyGrid.from_text([1, 2]), "line 1 of a drawn map is 1: expected a string"),
        (lambda: empty(2, 2).refined(1.5), "refined by 1.5: expected a whole number"),
        (lambda: empty(2, 2).numbered(1.5), "a cell's number is 1.5: expected a whole number"),
    ],
)
def test_a_wrong_type_is_refused(make, words):
    with pytest.raises(MapError, match=words):
        make()
