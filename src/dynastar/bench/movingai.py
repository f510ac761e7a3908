"""Suite movingai [Sturtevant2012]: found path lengths against the benchmark's verified optima.

Missions are the rows of verified_scenarios.csv, numbered from 0; rows whose stored length was not
confirmed (match = 0), and maps that are not there, are left out. ``arrived`` means that the search
found the optimum.
"""

import math
import time
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dynastar.bench.missions import Mission, Options, data_folder
from dynastar.errors import DataError, NoPath
from dynastar.io.data_files import read_rows
from dynastar.io.movingai import load_movingai_map
from dynastar.planning import SearchGrid

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 50

COMPARABLE = "Path lengths are compared with recomputed optima; nothing is driven."

INDEX = "verified_scenarios.csv"
COLUMNS = "set", "map", "sx", "sy", "gx", "gy", "recomputed_length", "match"
TOLERANCE = 0.005  # cells; older files round their lengths
ALGORITHM = "astar"


class Query(NamedTuple):
    """A row of the index: ``start`` and ``goal`` are the file's (column, row).

    ``expected`` is the optimum in cells, NaN where it was not confirmed.
    """

    map: str
    start: tuple[int, int]
    goal: tuple[int, int]
    expected: float


def missions(options: Options) -> Iterator[Mission]:
    """The rows of the index in its order; DataError for one that cannot be read."""
    index = data_folder(options, "movingai", INDEX) / INDEX
    for number, (line, row) in enumerate(read_rows(index, COLUMNS)):
        try:
            sx, sy, gx, gy = (int(row[key]) for key in ("sx", "sy", "gx", "gy"))
            confirmed = row["match"].strip() == "1"
            expected = float(row["recomputed_length"]) if confirmed else math.nan
            query = Query(f"{row['set']}/{row['map']}", (sx, sy), (gx, gy), expected)
        except (TypeError, ValueError, AttributeError) as error:
            raise DataError(f"{index}, line {line}: cannot be read ({error})") from error
        yield Mission(number, query)


def leave_out(mission: Mission, options: Options) -> str:
    """Unconfirmed rows and rows without their map."""
    if math.isnan(mission.spec.expected):
        return "its length was not confirmed (match = 0)"
    if not (data_folder(options, "movingai", INDEX) / mission.spec.map).is_file():
        return "its map is not there"
    return ""


@lru_cache(maxsize=1)
def prepared(path: Path) -> tuple[SearchGrid, int]:
    """The search grid of a map and its number of rows, made once for all queries in a row."""
    grid = load_movingai_map(path)
    search = SearchGrid(grid.occupied)
    free = np.argwhere(~grid.occupied)
    if len(free):  # compiles, so that the first query is as warm as the rest
        somewhere = int(free[0, 0]), int(free[0, 1])
        search.search(somewhere, somewhere, algorithm=ALGORITHM)
    return search, grid.rows


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Searches and compares; ``expected``, ``found``, ``length`` and ``error`` are in cells."""
    del repeat
    query: Query = mission.spec
    grid, rows = prepared(data_folder(options, "movingai", INDEX) / query.map)
    (sx, sy), (gx, gy) = query.start, query.goal
    asked = {"map": query.map, "start": query.start, "goal": query.goal, "expected": query.expected}
    began = time.perf_counter()
    try:
        result = grid.search((rows - 1 - sy, sx), (rows - 1 - gy, gx), algorithm=ALGORITHM)
    except NoPath as no_path:
        nothing = {"found": None, "error": None, "expanded": None, "time_ms": None, "length": None}
        return {"outcome": "blocked", "reason": str(no_path), **asked, **nothing}
    elapsed = 1000.0 * (time.perf_counter() - began)
    error = abs(result.cost - query.expected)
    right = error <= TOLERANCE
    return {
        "outcome": "arrived" if right else "wrong",
        "reason": "" if right else f"found {result.cost:.5f}, the optimum is {query.expected:.5f}",
        **asked,
        "found": result.cost,
        "error": error,
        "expanded": result.expanded,
        "time_ms": elapsed,
        "length": result.cost,
    }
