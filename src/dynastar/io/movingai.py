"""MovingAI benchmark maps (``.map``) and scenarios (``.scen``), [Sturtevant2012].

Their own coordinates are (column, row) with (0, 0) the top left cell and no metres; here a cell is
1 m. A file's row r is a grid's row ``rows - 1 - r``, since a grid's row 0 has the lowest y.
"""

import re
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, checked
from dynastar.errors import ConfigError, MapError, OutOfMap
from dynastar.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from dynastar.io.files import MAX_BYTES, MAX_ROWS_BYTES, check_size, read_bytes
from dynastar.paths import local_path
from dynastar.writing import written_aside

PASSABLE, BLOCKED = b".GS", b"@OTW"
_HEADER = re.compile(
    rb"\s*type[ \t]+\S+\s+(height|width)[ \t]+(\d{1,9})\s+(height|width)[ \t]+(\d{1,9})\s+"
    rb"map[ \t]*\r?\n"
)
_VALUES = np.full(256, UNKNOWN, dtype=np.int8)
_VALUES[list(PASSABLE)] = FREE
_VALUES[list(BLOCKED)] = OCCUPIED

_Cell = Annotated[int, Field("cell", "", 0, 1e6)]


class MovingAIScenario(NamedTuple):
    """One row of a ``.scen`` file; start and goal as (column, row), ``length`` in cells."""

    bucket: Annotated[int, Field("group of similar lengths", "", 0, 1e9)]
    map: str
    width: _Cell
    height: _Cell
    start_x: _Cell
    start_y: _Cell
    goal_x: _Cell
    goal_y: _Cell
    length: Annotated[float, Field("optimal length", "cells", 0.0, 1e12)]


def load_movingai_map(path: str | Path) -> OccupancyGrid:
    """A ``.map`` file as a grid of 1 m cells at the origin, ``.GS`` free and ``@OTW`` occupied.

    Raises MapError if the file is malformed or is not of the size that its header says.
    """
    path = local_path(path, MapError)
    data = read_bytes(path, MAX_BYTES, MapError)
    header = _HEADER.match(data)
    if header is None or header[1] == header[3]:
        raise MapError(f"{path}: the header is broken, expected lines of type, height, width, map")
    size = {header[1]: int(header[2]), header[3]: int(header[4])}
    rows, columns = size[b"height"], size[b"width"]
    check_size(rows, columns, path)
    lines = data[header.end() :].replace(b"\r\n", b"\n").rstrip(b"\n").split(b"\n", rows)
    if len(lines) != rows:
        found = f"only {len(lines)}" if len(lines) < rows else "more"
        raise MapError(f"{path}: the header says height {rows}, there are {found} rows")
    for row, line in enumerate(lines):
        if len(line) != columns:
            raise MapError(
                f"{path}: row {row} has {len(line)} cells, the header's width is {columns}"
            )
    marks = np.frombuffer(b"".join(lines), dtype=np.uint8).reshape(rows, columns)
    values = _VALUES[marks]
    if (values == UNKNOWN).any():
        row, column = np.argwhere(values == UNKNOWN)[0]
        raise MapError(
            f"{path}: row {row}, column {column} is {chr(marks[row, column])!r}, "
            f"expected one of {PASSABLE.decode()}{BLOCKED.decode()}"
        )
    return OccupancyGrid(values[::-1])


def save_movingai_map(grid: OccupancyGrid, path: str | Path) -> None:
    """Writes a grid of free and occupied cells, 1 m at the origin; MapError for any other."""
    path = local_path(path, MapError)
    check_plain(grid, path)
    if not np.isin(grid.values, (FREE, OCCUPIED)).all():
        raise MapError(f"{path}: a .map holds free and occupied cells only, save as .yaml")
    marks = np.full((grid.rows, grid.columns + 1), ord("\n"), dtype=np.uint8)
    marks[:, :-1] = np.where(grid.occupied[::-1], ord("@"), ord("."))
    header = b"type octile\nheight %d\nwidth %d\nmap\n" % (grid.rows, grid.columns)
    with written_aside(path, MapError) as aside:
        aside.write_bytes(header + marks.tobytes())


def check_plain(grid: OccupancyGrid, path: Path) -> None:
    """Raises MapError for a grid that is more than values: a frame of its own, or masks."""
    if tuple(grid.frame) != (1.0, 0.0, 0.0, 0.0):
        raise MapError(
            f"{path}: a {path.suffix} file cannot hold resolution and origin, save as .yaml"
        )
    if grid.keepout is not None or grid.speed_limit is not None:
        raise MapError(f"{path}: a map file cannot hold keepout or speed_limit, save without them")


def load_scenarios(path: str | Path) -> list[MovingAIScenario]:
    """The rows of a ``.scen`` file (version 1); raises MapError with the line that is wrong."""
    path = local_path(path, MapError)
    try:
        lines = read_bytes(path, MAX_ROWS_BYTES, MapError).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise MapError(f"{path}: this is not UTF-8 text: save it as UTF-8") from None
    if lines[0].split() not in (["version", "1"], ["version", "1.0"]):
        raise MapError(f"{path}: the first line is {lines[0]!r:.60}, expected 'version 1'")
    return [_row(line, f"{path}, line {n}") for n, line in enumerate(lines[1:], 2) if line.strip()]


def file_to_cell(grid: OccupancyGrid, column: int, row: int) -> tuple[int, int]:
    """The grid's (row, column) of a file's (column, row); OutOfMap if there is no such cell."""
    if not (0 <= column < grid.columns and 0 <= row < grid.rows):
        raise OutOfMap(
            f"cell ({column}, {row}) is off the map of {grid.columns} columns, {grid.rows} rows"
        )
    return grid.rows - 1 - row, column


def cell_to_file(grid: OccupancyGrid, row: int, column: int) -> tuple[int, int]:
    """The file's (column, row) of a grid's cell; OutOfMap if there is no such cell."""
    flipped, same = file_to_cell(grid, column, row)
    return same, flipped


def file_to_world(grid: OccupancyGrid, column: int, row: int) -> tuple[float, float]:
    """(x, y) in metres of the centre of a file's cell; OutOfMap if there is no such cell."""
    return grid.cell_to_world(*file_to_cell(grid, column, row))


def points_to_file(grid: OccupancyGrid, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """World points (n, 2) as x = column + 0.5, y = row + 0.5 in the file's orientation, (n, 2)."""
    cells = grid.frame.points_to_grid(points)
    return np.column_stack([cells[:, 1], grid.rows - cells[:, 0]])


def _row(line: str, where: str) -> MovingAIScenario:
    parts = line.split("\t") if line.count("\t") == 8 else line.split()
    if len(parts) != len(MovingAIScenario._fields):
        raise MapError(f"{where}: {len(parts)} values, expected {len(MovingAIScenario._fields)}")
    try:
        values = {
            name: part if name == "map" else float(part) if name == "length" else int(part)
            for name, part in zip(MovingAIScenario._fields, parts, strict=True)
        }
        row = checked(MovingAIScenario, values)
    except (ValueError, ConfigError) as error:
        raise MapError(f"{where}: {error!s:.120}") from None
    for name, x, y in (("start", row.start_x, row.start_y), ("goal", row.goal_x, row.goal_y)):
        if x >= row.width or y >= row.height:
            raise MapError(
                f"{where}: the {name} ({x}, {y}) is off its {row.width} x {row.height} map"
            )
    return row
