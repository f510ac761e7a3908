"""MovingAI's maps and scenarios, and their own coordinates."""

import csv

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dynastar.errors import MapError, OutOfMap
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io import load_map, load_movingai_map, load_scenarios, save_map
from dynastar.io.movingai import cell_to_file, file_to_cell, file_to_world, points_to_file

TEXT = b"type octile\nheight 3\nwidth 4\nmap\n.GS@\nOTW.\n@...\n"


def write(tmp_path, data, name="some.map"):
    path = tmp_path / name
    path.write_bytes(data)
    return path


def test_the_first_line_is_the_highest_row(tmp_path):
    grid = load_movingai_map(write(tmp_path, TEXT))
    assert grid.values.tolist() == [[100, 0, 0, 0], [100, 100, 100, 0], [0, 0, 0, 100]]
    assert grid.frame == GridFrame(1.0)


@pytest.mark.parametrize(
    "text",
    [
        TEXT.replace(b"\n", b"\r\n"),
        TEXT.rstrip(b"\n"),
        TEXT + b"\n\n",
        TEXT.replace(b"height 3\nwidth 4", b"width 4\nheight 3"),
    ],
)
def test_line_ends_and_the_order_of_the_header_do_not_matter(tmp_path, text):
    expected = load_movingai_map(write(tmp_path, TEXT)).values
    assert (load_movingai_map(write(tmp_path, text)).values == expected).all()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"height 3", b"height 4", "height 4, there are only 3 rows"),
        (b"height 3", b"height 2", "height 2, there are more rows"),
        (b"width 4", b"width 5", "row 0 has 4 cells"),
        (b"OTW.", b"OTW", "row 1 has 3 cells"),
        (b"OTW.", b"OXW.", "row 1, column 1 is 'X'"),
        (b"height 3\n", b"", "header"),
        (b"width 4", b"height 4", "header"),
        (b"height 3", b"height -3", "header"),
        (b"height 3", b"height 0", "1 or more"),
        (b"height 3", b"height 99999999", "at most"),
        (b"width 4", b"width four", "header"),
        (b"map\n", b"", "header"),
        (TEXT, b"", "empty"),
        (TEXT, bytes(range(256)), "header"),
    ],
)
def test_a_wrong_map_says_what_is_wrong(tmp_path, old, new, message):
    with pytest.raises(MapError, match=f"some.map: .*{message}"):
        load_movingai_map(write(tmp_path, TEXT.replace(old, new)))


def test_no_truncation_and_no_flipped_byte_gives_anything_but_a_map_or_a_map_error(tmp_path):
    path = tmp_path / "some.map"
    for k in range(len(TEXT)):
        path.write_bytes(TEXT[:k])
        if k < len(TEXT) - 1:
            with pytest.raises(MapError):
                load_movingai_map(path)
        for flip in (1, 8, 128, 255):
            path.write_bytes(TEXT[:k] + bytes([TEXT[k] ^ flip]) + TEXT[k + 1 :])
            try:
                assert load_movingai_map(path).values.size > 0
            except MapError:
                continue


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(hnp.arrays(bool, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9)))
def test_what_is_saved_loads_back_the_same(tmp_path, occupied):
    grid = OccupancyGrid(occupied)
    save_map(grid, tmp_path / "saved.map")
    assert (load_map(tmp_path / "saved.map").values == grid.values).all()


@given(st.integers(1, 9), st.integers(1, 9), st.data())
def test_file_coordinates_and_cells_convert_both_ways(rows, columns, data):
    grid = OccupancyGrid(np.zeros((rows, columns), bool))
    column, row = data.draw(st.integers(0, columns - 1)), data.draw(st.integers(0, rows - 1))
    cell = file_to_cell(grid, column, row)
    assert cell_to_file(grid, *cell) == (column, row)
    world = file_to_world(grid, column, row)
    assert world == grid.cell_to_world(*cell)
    assert points_to_file(grid, [world]).tolist() == [[column + 0.5, row + 0.5]]


def test_cells_off_the_file_are_off_the_map():
    grid = OccupancyGrid(np.zeros((2, 3), bool))
    for column, row in ((-1, 0), (0, -1), (3, 0), (0, 2)):
        with pytest.raises(OutOfMap, match=rf"\({column}, {row}\)"):
            file_to_cell(grid, column, row)
    with pytest.raises(OutOfMap):
        cell_to_file(grid, -1, 0)


ROW = "7\tmaps/a map.map\t4\t3\t0\t0\t3\t1\t3.41421356"


def test_scenarios_are_read_row_by_row(tmp_path):
    text = f"version 1\n{ROW}\n\n{ROW.replace('a map', 'a')}\n".replace("\t", "\t")
    first, second = load_scenarios(write(tmp_path, text.encode(), "some.scen"))
    assert first == (7, "maps/a map.map", 4, 3, 0, 0, 3, 1, 3.41421356)
    assert second.map == "maps/a.map"
    assert (second.start_x, second.goal_y, second.length) == (0, 1, 3.41421356)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"version 2\n{ROW}", "first line"),
        (ROW, "first line"),
        ("version 1\n1 2 3", "line 2: 3 values"),
        ("version 1\n" + ROW.replace("3.41421356", "long"), "line 2: "),
        ("version 1\n" + ROW.replace("3.41421356", "nan"), "line 2: 'length' is nan"),
        ("version 1\n" + ROW.replace("\t3\t1\t", "\t4\t1\t"), r"goal \(4, 1\) is off its 4 x 3"),
        ("version 1\n" + ROW.replace("\t0\t0\t", "\t-1\t0\t"), "'start_x' is -1"),
        ("\x00\xff", "not UTF-8 text|first line"),
    ],
)
def test_wrong_scenarios_say_where(tmp_path, text, message):
    with pytest.raises(MapError, match=f"some.scen.*({message})"):
        load_scenarios(write(tmp_path, text.encode("latin-1"), "some.scen"))


def test_a_large_map_is_saved_and_loaded(tmp_path):
    grid = OccupancyGrid(np.random.default_rng(0).random((2048, 2048)) < 0.3)
    save_map(grid, tmp_path / "large.map")
    assert (load_map(tmp_path / "large.map").values == grid.values).all()


@pytest.mark.data
def test_verified_scenarios_start_and_end_on_free_cells(data_dir):
    folder = data_dir / "movingai"
    maps = {path.stem: load_movingai_map(path) for path in folder.glob("*/*.map")}
    assert len(maps) == 30
    rows = 0
    for path in folder.glob("*/*.scen"):
        grid = maps[path.name.removesuffix(".map.scen")]
        for row in load_scenarios(path):
            assert (row.height, row.width) == grid.values.shape or "sc1" in path.parts
            rows += 1
    assert rows > 1000
    with (folder / "verified_scenarios.csv").open() as stream:
        assert next(csv.reader(stream))
