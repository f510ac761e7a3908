"""What a scenario puts into the world: obstacles that no map has, and movers."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.config import checked
from dynastar.errors import ConfigError
from dynastar.io.scenario_tables import MoverTable, ObstacleTable
from dynastar.simulation.scenario import AfterLast, Mover

Floats = npt.NDArray[np.float64]

DISC_CORNERS = 24

_TAKES = {
    "waypoints": {"speed", "pause", "after", "start"},
    "from_": {"velocity", "start"},
    "track": {"after"},
}
_NEEDS = {"waypoints": {"speed"}, "from_": {"velocity"}, "track": set()}


def read_obstacle(row: Any, where: str) -> Floats:
    """The corners (k, 2) in metres of one table of obstacles; raises ConfigError."""
    table = checked(ObstacleTable, row, where)
    _one_of(table, ("box", "disc", "polygon"), where)
    if table.yaw is not None and table.box is None:
        raise ConfigError(f"'{where}.yaw' is for a box only")
    if table.box is not None:
        x, y, length, width = table.box
        cos, sin = math.cos(table.yaw or 0.0), math.sin(table.yaw or 0.0)
        corners = np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]]) * (length / 2, width / 2)
        return corners @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
    if table.disc is not None:
        x, y, radius = table.disc
        angles = np.arange(DISC_CORNERS) * math.tau / DISC_CORNERS
        reach = radius / math.cos(math.pi / DISC_CORNERS)  # so that the edges touch the disc
        return np.column_stack([x + reach * np.cos(angles), y + reach * np.sin(angles)])
    polygon = np.array(table.polygon, dtype=np.float64).reshape(-1, 2)
    if len(polygon) < 3:
        raise ConfigError(f"'{where}.polygon' has {len(polygon)} corners: expected 3 or more")
    shape = shapely.Polygon(polygon)
    if not shape.is_valid or shape.area < 1e-6:
        raise ConfigError(f"'{where}.polygon' crosses itself or has no area: give corners in order")
    return polygon


def contains(polygon: Floats, x: float, y: float) -> bool:
    """Whether a point lies in or on a polygon (k, 2)."""
    return bool(shapely.Polygon(polygon).covers(shapely.Point(x, y)))


def read_mover(row: Any, where: str, duration: float) -> Mover:
    """The mover of one table of movers in a run of ``duration`` seconds; raises ConfigError."""
    if isinstance(row, Mapping):
        if "from_" in row:
            raise ConfigError(f"unknown key '{where}.from_' (did you mean 'from'?)")
        row = {"from_" if key == "from" else key: value for key, value in row.items()}
    try:
        table = checked(MoverTable, row, where)
    except ConfigError as error:
        raise ConfigError(str(error).replace("from_", "from")) from None
    kind = _one_of(table, tuple(_TAKES), where)
    for key in ("speed", "pause", "after", "velocity", "start"):
        given = getattr(table, key) is not None
        if given and key not in _TAKES[kind]:
            raise ConfigError(f"'{where}.{key}' does not go with '{_written(kind)}'")
        if not given and key in _NEEDS[kind]:
            raise ConfigError(f"missing key '{where}.{key}', which '{_written(kind)}' needs")
    if kind == "waypoints":
        return _walker(table, where)
    if kind == "track":
        return _tracked(table, where)
    return _straight(table, where, duration)


def _walker(table: MoverTable, where: str) -> Mover:
    points = np.array(table.waypoints, dtype=np.float64).reshape(-1, 2)
    after: AfterLast = table.after or "back_and_forth"
    if after == "loop":
        points = np.vstack([points, points[:1]])
    legs = np.hypot(*np.diff(points, axis=0).T)
    if len(points) < 2 or (legs < 1e-6).any():
        raise ConfigError(f"'{where}.waypoints' needs 2 points or more, none twice in a row")
    assert table.speed is not None
    rests = np.full(len(points), table.pause or 0.0)
    if after == "back_and_forth":  # an end is rested at before and after the turn
        rests[[0, -1]] /= 2.0
    else:
        rests[0] = 0.0
    walks = np.concatenate([[0.0], legs / table.speed])
    arrivals = (table.start or 0.0) + np.cumsum(walks) + np.cumsum(rests) - rests
    times = np.column_stack([arrivals, arrivals + rests]).ravel()
    keep = np.column_stack([np.ones(len(points), bool), rests > 0.0]).ravel()
    return Mover(table.radius, times[keep], np.repeat(points, 2, axis=0)[keep], after)


def _straight(table: MoverTable, where: str, duration: float) -> Mover:
    assert table.from_ is not None
    assert table.velocity is not None
    if math.hypot(*table.velocity) < 1e-3:
        raise ConfigError(f"'{where}.velocity' is zero: expected a speed of 0.001 m/s or more")
    origin, start = np.array(table.from_), table.start or 0.0
    points = np.array([origin, origin + duration * np.array(table.velocity)])
    return Mover(table.radius, np.array([start, start + duration]), points, "stay")


def _tracked(table: MoverTable, where: str) -> Mover:
    track = np.array(table.track, dtype=np.float64).reshape(-1, 3)
    after: AfterLast = table.after or "vanish"
    if len(track) == 0 or not (np.diff(track[:, 0]) > 0.0).all():
        raise ConfigError(f"'{where}.track' needs rows [t, x, y] whose times rise")
    if len(track) == 1 and after != "stay":
        raise ConfigError(f"'{where}.track' has one row only, which needs after = 'stay'")
    return Mover(table.radius, track[:, 0].copy(), track[:, 1:].copy(), after)


def _one_of(table: Any, kinds: tuple[str, ...], where: str) -> str:
    given = [kind for kind in kinds if getattr(table, kind) is not None]
    if len(given) != 1:
        have = f"has {' and '.join(map(_written, given))}" if given else "has no shape or way"
        raise ConfigError(f"'{where}' {have}: expected one of {', '.join(map(_written, kinds))}")
    return given[0]


def _written(kind: str) -> str:
    return kind.rstrip("_")
