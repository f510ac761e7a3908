"""Tables of equally long columns: as CSV, and for pandas."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from dynastar.extras import require
from dynastar.writing import written_aside

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
    with written_aside(path) as aside, aside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
