"""Maps by file name: what the suffix says decides how a file is read and written."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from dynastar.errors import DynastarWarning, MapError
from dynastar.grid import FREE, MOST_DRAWN, OCCUPIED, UNKNOWN, OccupancyGrid
from dynastar.io.files import MAX_BYTES, MAX_TEXT_BYTES, check_size, read_bytes
from dynastar.io.movingai import check_plain, load_movingai_map, save_movingai_map
from dynastar.io.npy import read_npy
from dynastar.io.ros_map import load_ros_map, not_a_map, save_ros_map
from dynastar.paths import local_path
from dynastar.writing import written_aside

T = TypeVar("T")


def load_map(path: str | Path) -> OccupancyGrid:
    """The map in a file: ROS (``.yaml``), MovingAI (``.map``), NumPy (``.npy``), drawn (``.txt``).

    An image (``.pgm``, ``.png``) is read by way of the YAML file beside it that names it. An
    array is bool or int8, [rows, columns], row 0 at the lowest y. Arrays, ``.map`` and ``.txt``
    have cells of 1 m and their corner at (0, 0). Raises MapError.
    """
    path = local_path(path, MapError)
    if path.is_dir():
        raise MapError(f"{path}: this is a folder, expected a map's file{_maps_in(path)}")
    return _choose(_LOADERS, path, _yaml_beside(path))(path)


def save_map(grid: OccupancyGrid, path: str | Path) -> None:
    """Writes ``grid`` in the form that the suffix of ``path`` says, so that it loads back the same.

    An image's name writes the YAML file beside it, too. Raises MapError where the form cannot hold
    the grid, or the file cannot be written.
    """
    path = local_path(path, MapError)
    _choose(_SAVERS, path)(grid, path)


def map_files(folder: Path) -> list[Path]:
    """The ROS maps (``*.yaml``) of a folder by name; MapError if there are none.

    Warns of each YAML file that is no map, such as named goals or a route graph.
    """
    found: list[Path] = []
    others: list[str] = []
    for path in sorted(folder.glob("*.yaml")):
        why = not_a_map(path)
        if why:
            others.append(why)
        else:
            found.append(path)
    if not found:
        whys = "".join(f"; {why}" for why in others[:3])
        raise MapError(f"{folder}: there is no map (*.yaml) in this folder{whys}")
    for why in others:
        warnings.warn(f"left out, as it is no map: {why}", DynastarWarning, stacklevel=2)
    return found


def _maps_in(folder: Path) -> str:
    """The maps of a folder, for a message."""
    names = sorted(name for name in folder.iterdir() if name.suffix.lower() in _LISTED)
    listed = [str(name) for name in names if name.suffix not in _YAML or not not_a_map(name)]
    return f", as {', '.join(listed[:3])}" if listed else ""


def _yaml_beside(path: Path) -> str:
    """The YAML file of the same name, for a message."""
    tables = [path.parent / f"{path.stem}{suffix}" for suffix in _YAML]
    return "".join(f"; there is {table} beside it" for table in tables if table.is_file())


def _load_array(path: Path) -> OccupancyGrid:
    data = read_bytes(path, MAX_BYTES, MapError)
    try:
        values = read_npy(data)
        if values.dtype not in (np.bool_, np.int8):
            raise MapError(
                f"the array is of {values.dtype}, expected bool (occupied) or int8 (-1..100)"
            )
        if values.ndim != 2:
            raise MapError(f"the array has shape {values.shape!s:.60}, expected (rows, columns)")
        if values.dtype == np.bool_:  # a byte of 2 would be a bool that is neither
            values = values.view(np.uint8) != 0
        grid = OccupancyGrid(values)
    except (MapError, ValueError) as error:
        raise MapError(f"{path}: {error}") from None
    check_size(grid.rows, grid.columns, path)
    return grid


def _save_array(grid: OccupancyGrid, path: Path) -> None:
    check_plain(grid, path)
    with written_aside(path, MapError) as aside, aside.open("wb") as stream:
        np.save(stream, grid.values, allow_pickle=False)


def _load_text(path: Path) -> OccupancyGrid:
    try:
        text = read_bytes(path, MAX_TEXT_BYTES, MapError).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise MapError(f"{path}: this is not UTF-8 text: save it as UTF-8") from None
    lines = text.replace("\r\n", "\n").strip("\n").split("\n")
    try:
        return OccupancyGrid.from_text(lines)
    except MapError as error:
        raise MapError(f"{path}: {error}") from None


def _save_text(grid: OccupancyGrid, path: Path) -> None:
    check_plain(grid, path)
    if not np.isin(grid.values, (FREE, OCCUPIED, UNKNOWN)).all():
        raise MapError(f"{path}: a drawn map holds free, occupied, unknown only, save as .yaml")
    if grid.values.size > MOST_DRAWN:
        raise MapError(f"{path}: a drawn map has at most {MOST_DRAWN} cells, save as .yaml")
    marks: npt.NDArray[np.uint8] = np.zeros(256, dtype=np.uint8)
    marks[[FREE, OCCUPIED, UNKNOWN]] = list(b".#?")
    lines = [marks[row.view(np.uint8)].tobytes() for row in grid.values[::-1]]
    with written_aside(path, MapError) as aside:
        aside.write_bytes(b"\n".join(lines) + b"\n")


_LOADERS: dict[str, Callable[[Path], OccupancyGrid]] = {
    ".yaml": load_ros_map,
    ".yml": load_ros_map,
    ".pgm": load_ros_map,
    ".png": load_ros_map,
    ".map": load_movingai_map,
    ".npy": _load_array,
    ".txt": _load_text,
}
_SAVERS: dict[str, Callable[[OccupancyGrid, Path], None]] = {
    ".yaml": save_ros_map,
    ".yml": save_ros_map,
    ".pgm": lambda grid, path: save_ros_map(grid, path.with_suffix(".yaml"), "pgm"),
    ".png": lambda grid, path: save_ros_map(grid, path.with_suffix(".yaml"), "png"),
    ".map": save_movingai_map,
    ".npy": _save_array,
    ".txt": _save_text,
}


_YAML = (".yaml", ".yml")
_LISTED = (*_YAML, ".map", ".txt")  # in the hint for a folder


def _choose(table: dict[str, T], path: Path, hint: str = "") -> T:
    suffix = path.suffix.lower()
    if suffix not in table:
        raise MapError(
            f"{path}: '{path.suffix}' is no suffix of a map, expected {', '.join(table)}{hint}"
        )
    return table[suffix]
