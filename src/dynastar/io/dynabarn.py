"""The DynaBARN data set [DynaBARN]: discs that follow keyframes in an arena open on one side."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError
from dynastar.io.data_files import item, items, numbers, read_json

FILE = "dynabarn.json"

Floats = npt.NDArray[np.float64]


class DynaBarnWorld(NamedTuple):
    """One world: its difficulty, and each obstacle's keys (k, 3) of t (s), x and y (m)."""

    difficulty: str
    tracks: tuple[Floats, ...]


class DynaBarn(NamedTuple):
    """The data set: ``walls`` are polygons (4, 2), ``start`` is (x, y, heading), ``goal`` (x, y)."""

    radius: float
    walls: tuple[Floats, ...]
    start: tuple[float, float, float]
    goal: tuple[float, float]
    worlds: Mapping[int, DynaBarnWorld]


@lru_cache(maxsize=2)
def load_dynabarn(folder: Path) -> DynaBarn:
    """The data set of a folder; raises DataError that names the world and the obstacle."""
    path = folder / FILE
    table = read_json(path)
    where = str(path)
    radius = float(numbers(item(table, "obstacle_radius", where), (), f"{where}: obstacle_radius"))
    if radius <= 0.0:
        raise DataError(f"{where}: obstacle_radius is {radius:g} m, expected more than 0")
    x, y, heading = numbers(item(table, "start", where), (3,), f"{where}: start").tolist()
    goal_x, goal_y = numbers(item(table, "goal", where), (2,), f"{where}: goal").tolist()
    worlds: dict[int, DynaBarnWorld] = {}
    for row in items(table, "worlds", where):
        number = item(row, "world", where)
        if not isinstance(number, int) or number < 0 or number in worlds:
            raise DataError(f"{where}: world {number!r:.40}: expected numbers from 0, none twice")
        worlds[number] = _world(row, f"{where}: world {number}")
    walls = tuple(_wall(row, f"{where}: walls") for row in items(table, "walls", where))
    return DynaBarn(radius, walls, (x, y, heading), (goal_x, goal_y), dict(sorted(worlds.items())))


def _world(row: Any, where: str) -> DynaBarnWorld:
    tracks = []
    for number, obstacle in enumerate(items(row, "obstacles", where)):
        what = f"{where}, obstacle {number}"
        keys = numbers(item(obstacle, "keys", what), (-1, 3), f"{what}: keys")
        length = float(numbers(item(obstacle, "length", what), (), f"{what}: length"))
        if len(keys) < 2 or not (np.diff(keys[:, 0]) > 0.0).all():
            raise DataError(f"{what}: expected 2 keys or more whose times rise")
        if abs(keys[-1, 0] - keys[0, 0] - length) > 1e-6:
            raise DataError(
                f"{what}: its keys last {np.ptp(keys[:, 0]):g} s, its length {length:g}"
            )
        tracks.append(keys)
    return DynaBarnWorld(str(item(row, "difficulty", where)), tuple(tracks))


def _wall(row: Any, where: str) -> Floats:
    centre = numbers(item(row, "center", where), (2,), f"{where}: center")
    size = numbers(item(row, "size", where), (2,), f"{where}: size")
    if (size <= 0.0).any():
        raise DataError(f"{where}: size is {size.tolist()}, expected more than 0")
    return centre + 0.5 * size * np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]])
