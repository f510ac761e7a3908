"""Places where people walk: corridors, halls, crossings, doorways and offices, drawn at random.

A place is a map without unknown cells, a start and a goal for the robot, and its way between them.
Corridors are 2.0 m wide or wider, doors 1.3 m: two people pass each other, and so do a person and any
of the suite's robots in a corridor.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.errors import PlanningError
from dynastar.grid import OccupancyGrid
from dynastar.path import Path
from dynastar.planning import GridPlanner, PlannerConfig
from dynastar.simulation.crowd import walkable_area

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Point = tuple[float, float]
Random = np.random.Generator

CELL = 0.05  # m
WALL = 0.2  # m
ROOM = 0.15  # m that the robot's way keeps beside the robot

Drawn = tuple[OccupancyGrid, Point, Point]


@dataclass(frozen=True, eq=False)
class Site:
    """A place: its map, the robot's start and goal, and the robot's way between them."""

    kind: str
    grid: OccupancyGrid
    start: Point
    goal: Point
    way: Path

    @cached_property
    def area(self) -> shapely.Geometry:
        """Free space as a polygon in metres."""
        return walkable_area(self.grid, ())

    @cached_property
    def outline(self) -> shapely.Geometry:
        """The edge of what is free."""
        return self.area.boundary

    def gaps(self, points: Floats) -> Floats:
        """Metres from points (n, 2) to the nearest wall, below 0 where a point is not free."""
        away = np.asarray(shapely.distance(self.outline, shapely.points(points)))
        return np.where(shapely.contains_xy(self.area, points[:, 0], points[:, 1]), away, -away)

    def random_point(self, random: Random, gap: float) -> Point | None:
        """A point anywhere, ``gap`` m or more from walls; None if none is found."""
        size = (self.grid.columns * CELL, self.grid.rows * CELL)
        points = random.uniform((0.0, 0.0), size, (40, 2))
        free = points[self.gaps(points) >= gap]
        return (float(free[0, 0]), float(free[0, 1])) if len(free) else None

    def planner(self, radius: float) -> GridPlanner:
        """A planner for a disc of ``radius`` m."""
        return GridPlanner(self.grid, radius, "blocked", PlannerConfig(planner="auto"))


class _Drawing:
    """A map that begins solid; rooms and doors are cut out of it."""

    def __init__(self, width: float, height: float) -> None:
        self.solid = np.ones((round(height / CELL), round(width / CELL)), np.bool_)

    def free(self, x0: float, y0: float, x1: float, y1: float, value: bool = False) -> None:
        """Frees (or fills) the rectangle from (x0, y0) to (x1, y1) m."""
        rows = slice(max(round(y0 / CELL), 2), round(y1 / CELL))
        columns = slice(max(round(x0 / CELL), 2), round(x1 / CELL))
        self.solid[rows, columns] = value

    def grid(self) -> OccupancyGrid:
        """The map, with a wall all round."""
        self.solid[[0, 1, -2, -1]] = True
        self.solid[:, [0, 1, -2, -1]] = True
        return OccupancyGrid.from_occupied(self.solid, CELL)


def corridor(random: Random) -> Drawn:
    """A corridor of 2.0 to 3.5 m, with none to two alcoves; the robot begins well inside it."""
    length, width = float(random.uniform(22.0, 27.0)), float(random.uniform(2.0, 3.5))
    low = WALL + 2.0
    drawing = _Drawing(length + 2 * WALL, low + width + 2.0 + WALL)
    drawing.free(WALL, low, WALL + length, low + width)
    for _ in range(int(random.integers(3))):
        x = float(random.uniform(5.0, length - 5.0))
        up = random.random() < 0.5
        drawing.free(x, low + width if up else low - 1.8, x + 2.0, low + width + 1.8 if up else low)
    y = low + width * random.uniform(0.35, 0.65, 2)
    start = (float(random.uniform(5.0, 7.0)), float(y[0]))
    goal = (length - float(random.uniform(3.0, 5.0)), float(y[1]))
    return _either_way(random, drawing.grid(), start, goal)


def hall(random: Random) -> Drawn:
    """A hall of 11 to 15 by 9 to 12 m with none to five pillars."""
    width, height = float(random.uniform(11.0, 15.0)), float(random.uniform(9.0, 12.0))
    drawing = _Drawing(width + 2 * WALL, height + 2 * WALL)
    drawing.free(WALL, WALL, WALL + width, WALL + height)
    for _ in range(int(random.integers(6))):
        x, y = random.uniform((3.0, 2.0), (width - 3.0, height - 2.0))
        drawing.free(x, y, x + random.uniform(0.3, 1.0), y + random.uniform(0.3, 1.0), value=True)
    y = random.uniform(1.5, height - 1.5, 2)
    return _either_way(random, drawing.grid(), (2.0, float(y[0])), (width - 1.5, float(y[1])))


def crossing(random: Random) -> Drawn:
    """Two corridors of 2.0 to 3.2 m that cross; the robot goes straight on or turns off."""
    across, along = float(random.uniform(14.0, 18.0)), float(random.uniform(12.0, 16.0))
    drawing = _Drawing(across + 2 * WALL, along + 2 * WALL)
    widths = random.uniform(2.0, 3.2, 2)
    x, y = 0.5 * across + random.uniform(-1.5, 1.5), 0.5 * along + random.uniform(-1.5, 1.5)
    drawing.free(WALL, y - widths[0] / 2, WALL + across, y + widths[0] / 2)
    drawing.free(x - widths[1] / 2, WALL, x + widths[1] / 2, WALL + along)
    start = (float(random.uniform(2.0, 3.0)), float(y))
    ends = [(across - 2.0, y), (x, along - 2.0), (x, 2.0)]
    goal = ends[int(random.choice(3, p=(0.5, 0.25, 0.25)))]
    return _either_way(random, drawing.grid(), start, (float(goal[0]), float(goal[1])))


def doorway(random: Random) -> Drawn:
    """Two rooms and one or two doors of 1.3 to 2.0 m between them."""
    width, height = random.uniform(6.0, 8.0, 2), float(random.uniform(6.0, 9.0))
    drawing = _Drawing(float(width.sum()) + 3 * WALL, height + 2 * WALL)
    middle = WALL + float(width[0])
    drawing.free(WALL, WALL, middle, WALL + height)
    drawing.free(middle + WALL, WALL, middle + WALL + width[1], WALL + height)
    for part in random.permutation([0.3, 0.75])[: int(random.integers(1, 3))]:
        door, y = float(random.uniform(1.3, 2.0)), part * height + float(random.uniform(-0.5, 0.5))
        drawing.free(middle, y - door / 2, middle + WALL, y + door / 2)
    y0, y1 = random.uniform(1.5, height - 1.0, 2)
    start, goal = (2.0, float(y0)), (middle + float(width[1]) - 1.3, float(y1))
    return _either_way(random, drawing.grid(), start, goal)


def office(random: Random) -> Drawn:
    """A corridor with three rooms on either side; the robot goes from room or corridor to another."""
    rooms, depth = random.uniform(3.6, 5.0, 3), random.uniform(3.6, 4.5, 2)
    aisle = float(random.uniform(2.0, 2.6))
    total = float(rooms.sum()) + 2 * WALL
    drawing = _Drawing(total + 2 * WALL, float(depth.sum()) + aisle + 4 * WALL)
    low = WALL + float(depth[0]) + WALL
    drawing.free(WALL, low, WALL + total, low + aisle)
    middles: list[Point] = []
    for side in (0, 1):
        x = WALL
        for room in rooms:
            bottom = WALL if side == 0 else low + aisle + WALL
            drawing.free(x, bottom, x + room, bottom + depth[side])
            door, at = float(random.uniform(1.3, 1.6)), x + room * float(random.uniform(0.3, 0.7))
            drawing.free(at - door / 2, low - WALL if side == 0 else low + aisle,
                         at + door / 2, low if side == 0 else low + aisle + WALL)  # fmt: skip
            if random.random() < 0.5:
                _desk(drawing, random, x, bottom, float(room), float(depth[side]))
            middles.append((x + float(room) / 2, bottom + float(depth[side]) / 2))
            x += float(room) + WALL
    ends = [(2.0, low + aisle / 2), (WALL + total - 1.8, low + aisle / 2)]
    first = [ends[0], middles[0], middles[3]][int(random.integers(3))]
    last = [ends[1], middles[2], middles[5]][int(random.integers(3))]
    return _either_way(random, drawing.grid(), first, last)


SITES: dict[str, Callable[[Random], Drawn]] = {
    "corridor": corridor,
    "hall": hall,
    "crossing": crossing,
    "doorway": doorway,
    "office": office,
}


def draw_site(kind: str, random: Random, radius: float) -> Site | None:
    """A place of a kind with a way for a robot of ``radius`` m; None if there is no such way."""
    grid, start, goal = SITES[kind](random)
    try:
        planner = GridPlanner(grid, radius + ROOM, "blocked", PlannerConfig(planner="auto"))
        path = planner.plan(start, goal).path
    except PlanningError:
        return None
    return Site(kind, grid, start, goal, path)


def _desk(
    drawing: _Drawing, random: Random, x: float, y: float, width: float, depth: float
) -> None:
    """A desk in a corner of a room that leaves its middle free."""
    w, d = float(random.uniform(0.6, 1.4)), float(random.uniform(0.5, 0.8))
    left = x + (0.0 if random.random() < 0.5 else width - w)
    drawing.free(left, y + (0.4 if y > 1.0 else 0.0), left + w, y + d, value=True)
    del depth


def _either_way(random: Random, grid: OccupancyGrid, a: Point, b: Point) -> Drawn:
    """Start and goal, or goal and start."""
    return (grid, b, a) if random.random() < 0.5 else (grid, a, b)


def heading_of(path: Path) -> float:
    """Bearing (rad) of a path's first metre."""
    x, y = np.subtract(path.at(min(1.0, path.length)), path.at(0.0))
    return math.atan2(y, x)
