"""A static world under construction: walls and things that the map has, and things that it lacks."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.footprint import Footprint
from dynastar.grid import OccupancyGrid

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Point = tuple[float, float]

CELL = 0.05  # m, of the map
WALL = 2  # cells, thickness of an outer wall
BOARD = 0.1  # m, thickness of a board

RANGE_ERROR, POSE_ERROR = 0.01, 0.01  # m, the bounds that the navigator declares
HALF_DIAGONAL = CELL * math.sqrt(0.5)
CAREFUL = RANGE_ERROR + POSE_ERROR + HALF_DIAGONAL  # m, what a careful planner keeps on each side
SPARE = (0.10, 0.30)  # m, width of a narrow way beyond footprint and errors


class StaticWorld(NamedTuple):
    """A finished world: ``reachable`` is what its kind is meant to be, and has yet to be checked.

    ``grid`` is the robot's map; ``obstacles`` are polygons (k, 2) in metres that it lacks.
    """

    grid: OccupancyGrid
    obstacles: tuple[Floats, ...]
    start: tuple[float, float, float | None]
    goal: Point
    reachable: bool = True


class Layout:
    """A rectangle of ``width`` x ``height`` metres with an outer wall, to put things into."""

    def __init__(self, width: float, height: float, random: np.random.Generator) -> None:
        self.random = random
        self.occupied = np.ones((cells(height), cells(width)), np.bool_)
        self.occupied[WALL:-WALL, WALL:-WALL] = False
        self.width, self.height = self.occupied.shape[1] * CELL, self.occupied.shape[0] * CELL
        self.obstacles: list[Floats] = []

    def wall(self, x0: float, y0: float, x1: float, y1: float) -> None:
        """Occupies the map's cells from (x0, y0) to (x1, y1) m, rounded to whole cells."""
        row0, col0 = max(cells(y0), 0), max(cells(x0), 0)
        self.occupied[row0 : cells(y1), col0 : cells(x1)] = True

    def room(self, x0: float, y0: float, x1: float, y1: float) -> None:
        """Frees the map's cells from (x0, y0) to (x1, y1) m, rounded to whole cells."""
        self.occupied[cells(y0) : cells(y1), cells(x0) : cells(x1)] = False

    def unmapped(self, ring: Floats) -> None:
        """Puts a polygon (k, 2), metres, where the map has nothing."""
        self.obstacles.append(np.asarray(ring, np.float64))

    def board(self, x0: float, y0: float, x1: float, y1: float) -> None:
        """An unmapped rectangle from (x0, y0) to (x1, y1) m."""
        self.unmapped(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]))

    def mapped(self, ring: Floats) -> None:
        """Occupies every cell of the map that a polygon (k, 2), metres, meets."""
        low = np.maximum(np.floor(ring.min(axis=0) / CELL).astype(int), 0)
        high = np.ceil(ring.max(axis=0) / CELL).astype(int) + 1
        part = self.occupied[low[1] : high[1], low[0] : high[0]]
        rows, columns = (np.asarray(i) for i in np.indices(part.shape))
        x, y = (columns + low[0]) * CELL, (rows + low[1]) * CELL
        part |= shapely.intersects(shapely.Polygon(ring), shapely.box(x, y, x + CELL, y + CELL))

    def thing(self, scale: float) -> Floats:
        """A box, a convex polygon or a cylinder round (0, 0), (k, 2) m; ``scale`` 1 is furniture."""
        random, kind = self.random, int(self.random.integers(3))
        if kind == 0:
            x, y = 0.5 * scale * random.uniform(0.15, 0.9, 2)
            return turned(
                np.array([(-x, -y), (x, -y), (x, y), (-x, y)]), random.uniform(0, math.pi)
            )
        if kind == 1:
            angles = np.sort(random.uniform(0.0, math.tau, 8))
            reach = scale * random.uniform(0.15, 0.45)
            ring = shapely.MultiPoint(reach * np.column_stack([np.cos(angles), np.sin(angles)]))
            return shapely.get_coordinates(ring.convex_hull.buffer(0.02).simplify(0.01))[:-1]
        angles = np.arange(12) * math.tau / 12
        return float(scale * random.uniform(0.05, 0.3)) * np.column_stack(
            [np.cos(angles), np.sin(angles)]
        )

    def clear_of(self, ring: Floats, points: tuple[Point, ...], room: float) -> bool:
        """Whether a polygon keeps ``room`` m to each of the points."""
        return bool((shapely.distance(shapely.Polygon(ring), shapely.points(points)) > room).all())

    def finished(
        self, start: tuple[float, float, float | None], goal: Point, reachable: bool = True
    ) -> StaticWorld:
        """The world as it stands."""
        grid = OccupancyGrid.from_occupied(self.occupied, CELL)
        return StaticWorld(grid, tuple(self.obstacles), start, goal, reachable)


def cells(metres: float) -> int:
    """Metres as a whole number of the map's cells."""
    return round(metres / CELL)


def turned(ring: Floats, angle: float) -> Floats:
    """A polygon (k, 2) turned about (0, 0)."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.asarray(ring @ np.array([[cos, sin], [-sin, cos]]))


def straight_width(footprint: Footprint) -> float:
    """Metres that a footprint takes across when it drives straight."""
    return 2.0 * footprint.inscribed


def narrow(footprint: Footprint, random: np.random.Generator) -> float:
    """The width in metres of a way barely wider than the robot, see the suite's rule."""
    return straight_width(footprint) + 2 * (RANGE_ERROR + POSE_ERROR) + random.uniform(*SPARE)


def aligned(width: float) -> float:
    """A width rounded up to whole cells of the map."""
    return math.ceil(width / CELL - 1e-9) * CELL
