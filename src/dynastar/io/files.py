"""Reading whole files within limits, and writing JSON."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.errors import InputError, MapError
from dynastar.grid import MAX_CELLS
from dynastar.writing import reason_of, written_aside

MAX_BYTES = 4 * MAX_CELLS  # of a map's image
MAX_TEXT_BYTES = 128 * 2**20  # of a map drawn in text
MAX_TABLE_BYTES = 2**18  # of a TOML file
MAX_HEADER_BYTES = 2**15  # of a map's YAML file
MAX_ROWS_BYTES = 2**22  # of a benchmark's list of missions


def read_bytes(path: Path, limit: int, error: type[InputError]) -> bytes:
    """The contents of a regular file of at most ``limit`` bytes; raises ``error``."""
    try:
        if not path.exists():
            raise error(f"{path}: there is no such file")
        if not path.is_file():
            kind = "a directory" if path.is_dir() else "not a regular file"
            raise error(f"{path}: this is {kind}, expected a file")
        size = path.stat().st_size
        if size > limit:
            raise error(f"{path}: the file has {size} bytes, at most {limit} are read")
        if size == 0:
            raise error(f"{path}: the file is empty")
        return path.read_bytes()
    except (OSError, ValueError) as trouble:
        raise error(f"{path!s:.200}: cannot be read ({reason_of(trouble)})") from None


def check_size(rows: int, columns: int, path: Path) -> None:
    """Raises MapError for a map without cells or with more than MAX_CELLS."""
    if rows < 1 or columns < 1:
        raise MapError(f"{path}: the map is {columns} x {rows} cells, both have to be 1 or more")
    if rows * columns > MAX_CELLS:
        raise MapError(f"{path}: the map is {columns} x {rows} cells, at most {MAX_CELLS} are read")


def jsonable(data: Any) -> Any:
    """``data`` as JSON can hold it: numbers that are not finite become None, tuples lists.

    NamedTuples and mappings become objects, arrays nested lists. Raises TypeError for the rest.
    """
    if data is None or isinstance(data, bool | int | str):
        return data
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, np.generic | np.ndarray):
        return jsonable(data.tolist())
    if hasattr(data, "_asdict"):
        return jsonable(data._asdict())
    if isinstance(data, Mapping):
        return {str(key): jsonable(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [jsonable(item) for item in data]
    if isinstance(data, Path):
        return str(data)
    raise TypeError(f"JSON cannot hold a {type(data).__name__}")


def write_json(path: str | Path, data: Any) -> None:
    """Writes ``data`` as standard JSON: see ``jsonable``. Raises InputError if it cannot.

    Letters of file names that are not UTF-8 become escapes, which JSON reads back as they were.
    """
    text = json.dumps(jsonable(data), indent=2, allow_nan=False, ensure_ascii=False)
    with written_aside(path) as aside:
        aside.write_text(text + "\n", encoding="utf-8", errors="backslashreplace")
