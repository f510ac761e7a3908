"""Tables of equally long columns: as CSV, and for pandas."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from dynastar.errors import InputError
from dynastar.extras import require

if TYPE_CHECKING:
    from pandas import DataFrame

Columns = Mapping[str, Sequence[Any] | npt.NDArray[Any]]


def as_dataframe(columns: Columns) -> "DataFrame":
    """A pandas DataFrame of columns by name. Raises MissingPackage without pandas."""
    require("pandas", "data frames need")
    from pandas import DataFrame

    return DataFrame(dict(columns))


def write_csv(columns: Columns, path: str | Path) -> None:
    """Write columns, below their names, to a CSV file; InputError where that cannot be done."""
    path = Path(path).expanduser()
    try:
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(zip(*columns.values(), strict=True))
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
