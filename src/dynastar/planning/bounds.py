"""Whether a window lies in a map."""

import numpy as np

from dynastar.errors import MapError, OutOfMap


def check_window(row0: int, col0: int, window: tuple[int, ...], whole: tuple[int, int]) -> None:
    """Raise MapError or OutOfMap unless a window of that shape at (row0, col0) lies in the map."""
    for index in (row0, col0):
        if not isinstance(index, int | np.integer):
            raise MapError(f"a window begins at row {row0}, column {col0}: expected whole numbers")
    if len(window) != 2:
        raise MapError(f"a patch has shape {window}: expected (rows, columns)")
    if row0 < 0 or col0 < 0 or row0 + window[0] > whole[0] or col0 + window[1] > whole[1]:
        raise OutOfMap(
            f"a window of {window[0]} x {window[1]} cells at ({row0}, {col0}) leaves the map "
            f"of {whole[0]} x {whole[1]}"
        )
