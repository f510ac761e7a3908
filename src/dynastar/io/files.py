"""Reading whole files within limits, and writing them so that nobody ever sees half of one."""

import json
import math
import os
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.errors import InputError, MapError
from dynastar.grid import MAX_CELLS
from dynastar.io.paths import local_path

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
        raise error(f"{path!s:.200}: cannot be read ({_reason(trouble)})") from None


def check_size(rows: int, columns: int, path: Path) -> None:
    """Raises MapError for a map without cells or with more than MAX_CELLS."""
    if rows < 1 or columns < 1:
        raise MapError(f"{path}: the map is {columns} x {rows} cells, both have to be 1 or more")
    if rows * columns > MAX_CELLS:
        raise MapError(f"{path}: the map is {columns} x {rows} cells, at most {MAX_CELLS} are read")


@contextmanager
def written_aside(path: str | Path, error: type[InputError] = InputError) -> Iterator[Path]:
    """A path beside ``path``, of the same suffix, to write to: renamed to ``path`` at the end.

    A link is followed; what is there and no regular file is refused.
    On any exception it is deleted instead. Folders that are missing are made. Raises ``error``
    where the system refuses.
    """
    path = local_path(path, error)
    try:
        path = path.resolve() if path.is_symlink() else path
        if path.exists() and not path.is_file():
            raise error(f"{path}: is no regular file; name another")
    except OSError as trouble:
        raise error(f"{path!s:.200}: cannot be written ({_reason(trouble)})") from None
    aside = path.with_name(f".{path.stem}.{secrets.token_hex(4)}.aside{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield aside
        os.replace(aside, path)
    except OSError as trouble:
        raise error(f"{path}: cannot be written ({_reason(trouble)})") from None
    finally:
        _remove(aside)


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
    """Writes ``data`` as standard JSON: see ``jsonable``. Raises InputError if it cannot."""
    text = json.dumps(jsonable(data), indent=2, allow_nan=False, ensure_ascii=False)
    with written_aside(path) as aside:
        aside.write_text(text + "\n", encoding="utf-8")


def _reason(trouble: Exception) -> str:
    return getattr(trouble, "strerror", None) or str(trouble)


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError:  # the folder itself is not there, or not ours: nothing was written
        return
