"""Recorded pedestrians as ``t_s,ped_id,x_m,y_m`` [Pellegrini2009], [Lerner2007]."""

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError
from dynastar.io.data_files import read_columns

COLUMNS = ("t_s", "ped_id", "x_m", "y_m")

Floats = npt.NDArray[np.float64]


class Recording(NamedTuple):
    """Tracks (k >= 2, 3) of t (s), x and y (m) by order of pedestrian; ``span`` is (begin, end), s."""

    name: str
    tracks: tuple[Floats, ...]
    span: tuple[float, float]


@lru_cache(maxsize=8)
def load_recording(path: Path) -> Recording:
    """The recording in a CSV file; a pedestrian with a single row is left out. Raises DataError."""
    table = read_columns(path, COLUMNS)
    if len(table) == 0:
        raise DataError(f"{path}: holds no pedestrian")
    table = table[np.lexsort((table[:, 0], table[:, 1]))]
    cuts = np.flatnonzero(np.diff(table[:, 1])) + 1
    tracks = []
    for rows in np.split(table, cuts):
        if not (np.diff(rows[:, 0]) > 0.0).all():
            raise DataError(f"{path}: pedestrian {rows[0, 1]:g} has two rows for one time")
        if len(rows) > 1:
            tracks.append(rows[:, [0, 2, 3]])
    span = float(table[:, 0].min()), float(table[:, 0].max())
    return Recording(path.stem, tuple(tracks), span)
