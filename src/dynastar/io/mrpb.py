"""The MRPB data set [MRPB]: start, goal, the map as known, the true map, and people who walk."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError
from dynastar.io.data_files import item, items, numbers, read_json

FILE, ACTORS = "scenarios.json", "dynamic_actors.json"

Floats = npt.NDArray[np.float64]


class MrpbTest(NamedTuple):
    """One test: poses are (x, y, heading); maps are None for an empty world.

    ``walkers`` are keys (k, 3) of t (s), x and y (m), followed in a loop.
    """

    scenario: str
    test: int
    prior_map: Path | None
    true_map: Path | None
    start: tuple[float, float, float]
    goal: tuple[float, float, float]
    walkers: tuple[Floats, ...]


@lru_cache(maxsize=2)
def load_mrpb(folder: Path) -> tuple[MrpbTest, ...]:
    """The tests of a folder in the file's order; raises DataError that names the test."""
    path = folder / FILE
    rows = read_json(path)
    if not isinstance(rows, list) or not rows:
        raise DataError(f"{path}: expected a list of tests")
    actors: Mapping[str, Any] = {}
    if any(isinstance(row, dict) and row.get("actors") for row in rows):
        actors = read_json(folder / ACTORS)
    return tuple(_test(row, folder, actors, f"{path}, test {n}") for n, row in enumerate(rows))


def _test(row: Any, folder: Path, actors: Mapping[str, Any], where: str) -> MrpbTest:
    start = numbers(item(row, "start", where), (3,), f"{where}: start").tolist()
    goal = numbers(item(row, "goal", where), (3,), f"{where}: goal").tolist()
    test = item(row, "test", where)
    if not isinstance(test, int):
        raise DataError(f"{where}: 'test' is {test!r:.40}, expected a whole number")
    group = row.get("actors")
    walkers: tuple[Floats, ...] = ()
    if group is not None:
        there = f"{folder / ACTORS}: {group}"
        walkers = tuple(
            _walker(actor, f"{there}[{n}]")
            for n, actor in enumerate(items(actors, str(group), str(folder / ACTORS)))
        )
    return MrpbTest(
        str(item(row, "scenario", where)),
        test,
        _map(row, "prior_map", folder, where),
        _map(row, "true_map", folder, where),
        (start[0], start[1], start[2]),
        (goal[0], goal[1], goal[2]),
        walkers,
    )


def _map(row: Any, key: str, folder: Path, where: str) -> Path | None:
    name = item(row, key, where)
    if name is None:
        return None
    if not isinstance(name, str) or Path(name).is_absolute() or ".." in Path(name).parts:
        raise DataError(f"{where}: '{key}' is {name!r:.80}, expected a file below {folder}")
    return folder / name


def _walker(actor: Any, where: str) -> Floats:
    key = "waypoints_t_x_y_yaw"
    keys = numbers(item(actor, key, where), (-1, 4), f"{where}: {key}")
    if len(keys) < 2 or not (np.diff(keys[:, 0]) > 0.0).all():
        raise DataError(f"{where}: expected 2 keys or more whose times rise")
    return keys[:, :3].copy()
