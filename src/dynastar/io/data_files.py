"""Files of public data sets: JSON and CSV of bounded size, with errors that name file and line."""

import csv
import io
import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError
from dynastar.io.files import read_bytes

MAX_DATA_BYTES = 64 * 2**20  # of one JSON or CSV file

Floats = npt.NDArray[np.float64]


def read_text(path: Path, limit: int = MAX_DATA_BYTES) -> str:
    """The text of a UTF-8 file of at most ``limit`` bytes; raises DataError."""
    try:
        return read_bytes(path, limit, DataError).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise DataError(f"{path}: this is not UTF-8 text: save it as UTF-8") from None


def read_json(path: Path) -> Any:
    """The contents of a JSON file; raises DataError."""
    try:
        return json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise DataError(f"{path}: this is not valid JSON ({error!s:.120})") from None


def read_rows(path: Path, columns: Sequence[str]) -> Iterator[tuple[int, dict[str, Any]]]:
    """The rows of a CSV file that has ``columns``, each after its line's number; raises DataError."""
    reader = csv.DictReader(io.StringIO(read_text(path), newline=None))
    try:
        missing = [name for name in columns if name not in (reader.fieldnames or ())]
        if missing:
            raise DataError(
                f"{path}: the column '{missing[0]}' is missing, expected {list(columns)}"
            )
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:
        raise DataError(
            f"{path}, line {reader.reader.line_num}: this is not CSV ({error})"
        ) from None


def read_columns(path: Path, columns: Sequence[str]) -> Floats:
    """Columns of a CSV file as (n, k) finite numbers, in the order asked; raises DataError."""
    rows = []
    for number, row in read_rows(path, columns):
        try:
            values = [float(row[name]) for name in columns]
        except (TypeError, ValueError):
            raise DataError(
                f"{path}, line {number}: expected numbers for {list(columns)}"
            ) from None
        if not all(map(math.isfinite, values)):
            raise DataError(f"{path}, line {number}: expected finite numbers")
        rows.append(values)
    return np.array(rows, dtype=np.float64).reshape(-1, len(columns))


def numbers(value: Any, shape: tuple[int, ...], where: str) -> Floats:
    """``value`` as finite numbers of a shape, where -1 stands for any size; raises DataError."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise DataError(f"{where}: expected numbers of shape {_shown(shape)}") from None
    fits = array.ndim == len(shape) and all(
        wanted in (-1, size) for wanted, size in zip(shape, array.shape, strict=True)
    )
    if not fits or not np.isfinite(array).all():
        raise DataError(
            f"{where}: expected finite numbers of shape {_shown(shape)}, found {array.shape}"
        )
    return array


def item(table: Any, key: str, where: str) -> Any:
    """``table[key]`` of a JSON object; raises DataError where there is none."""
    if not isinstance(table, dict):
        raise DataError(f"{where}: expected an object with '{key}', found {type(table).__name__}")
    if key not in table:
        raise DataError(f"{where}: '{key}' is missing")
    return table[key]


def items(table: Any, key: str, where: str) -> list[Any]:
    """``table[key]`` of a JSON object, a list; raises DataError."""
    value = item(table, key, where)
    if not isinstance(value, list):
        raise DataError(f"{where}: '{key}' is {type(value).__name__}, expected a list")
    return value


def _shown(shape: tuple[int, ...]) -> str:
    return f"({', '.join('n' if size < 0 else str(size) for size in shape)})"
