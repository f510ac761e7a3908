"""Tables of equally long columns: as CSV, and for pandas."""

import csv
import secrets
from collections.abc import Mapping, Sequence
from contextlib import suppress
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
    path = Path(path)
    aside = path.with_name(f".{path.name}.{secrets.token_hex(4)}.aside")
    try:
        path = path.expanduser().resolve()
        aside = path.with_name(aside.name)
        with aside.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(zip(*columns.values(), strict=True))
        aside.replace(path)
    except (OSError, RuntimeError) as error:  # RuntimeError: a home of nobody
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{path}: cannot be written: {reason}") from None
    finally:
        with suppress(OSError):
            aside.unlink()
