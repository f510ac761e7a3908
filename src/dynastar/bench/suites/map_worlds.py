"""Missions drawn on a map: start and goal, unknown boxes near the way, and people who walk there.

Start and goal are free cells 5 to 30 m apart with a way between them for the robot's disc grown by
0.1 m; unknown cells are blocked. Two to four boxes of 0.2 to 0.6 m stand on free cells within 0.6 m
of the way and 0.5 m or more from start and goal, and such a way remains with them. Two people of
radius 0.25 m walk to and fro at 0.3 to 0.8 m/s on straight lanes of 2 to 8 m near the way: no nearer
than 1 m to start and goal, beginning 2 m or more from the robot, and with room on either side for the
robot to pass.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt
import shapely

from dynastar.clearance import inflate
from dynastar.errors import PlanningError
from dynastar.grid import OccupancyGrid
from dynastar.path import Path
from dynastar.planning import GridPlanner, PlannerConfig, segment_clear
from dynastar.simulation import Mover

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Point = tuple[float, float]

ROOM = 0.1  # m kept free beside the robot
NEAREST, FURTHEST = 5.0, 30.0  # m from start to goal
MARGIN = 5.0  # m round the way, within which a way has to remain
BOXES, BOX_SIZE, OFF_WAY, FROM_ENDS = (2, 4), (0.2, 0.6), 0.6, 0.5  # count, m, m, m
WALKERS, WALKER_RADIUS, SPEEDS = 2, 0.25, (0.3, 0.8)  # count, m, m/s
LANE, LANE_STEP, LANE_OFF_WAY = (2.0, 8.0), 0.25, 1.0  # m
LANE_FROM_ENDS, WALKER_FROM_START = 1.0, 2.0  # m from the discs
ATTEMPTS, TRIES = 10, 20  # at a mission, and at a part of it


class MapWorld(NamedTuple):
    """A mission: ``length`` (m) is of the way without boxes; boxes are polygons (4, 2)."""

    start: Point
    goal: Point
    length: float
    boxes: tuple[Floats, ...]
    walkers: tuple[Mover, ...]


@dataclass(frozen=True, eq=False)
class _Site:
    """The surroundings of a way: ``blocked`` is the map's from row and column ``corner`` on."""

    grid: OccupancyGrid
    blocked: Mask
    corner: npt.NDArray[np.int64]

    def cells(self, points: npt.ArrayLike) -> Floats:
        """World points (n, 2) as (row, column) of ``blocked``."""
        return self.grid.frame.points_to_grid(points) - self.corner

    def with_box(self, box: Floats) -> "_Site":
        """The site with all cells that a box meets blocked."""
        shape = shapely.Polygon(self.cells(box))
        low = np.maximum(np.floor(shape.bounds[:2]).astype(int) - 1, 0)
        high = np.maximum(np.ceil(shape.bounds[2:]).astype(int) + 1, 0)
        blocked = self.blocked.copy()
        near = blocked[low[0] : high[0], low[1] : high[1]]
        rows = low[0] + np.arange(near.shape[0])[:, np.newaxis]
        columns = low[1] + np.arange(near.shape[1])[np.newaxis]
        near |= shapely.intersects(shape, shapely.box(rows, columns, rows + 1, columns + 1))
        return _Site(self.grid, blocked, self.corner)

    def is_free(self, point: npt.ArrayLike) -> bool:
        """Whether a world point is in a cell of the site that is not blocked."""
        row, column = np.floor(self.cells(point)[0]).astype(int)
        rows, columns = self.blocked.shape
        inside = 0 <= row < rows and 0 <= column < columns
        return bool(inside and not self.blocked[row, column])

    def connects(self, start: Point, goal: Point, radius: float) -> bool:
        """Whether a disc of ``radius`` m gets from start to goal."""
        free = ~inflate(self.blocked, radius / self.grid.resolution)
        _, parts = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
        (a, b), (c, d) = np.floor(self.cells([start, goal])).astype(int)
        return bool(parts[a, b] != 0 and parts[a, b] == parts[c, d])


def draw_world(grid: OccupancyGrid, radius: float, seed: Sequence[int]) -> MapWorld | str:
    """The mission of a seed for a disc of ``radius`` m, or why the rules find none."""
    random = np.random.default_rng(list(seed))
    reason = ""
    for _ in range(ATTEMPTS):
        ends = _ends(grid, radius, random)
        if ends is None:
            return f"no two places {NEAREST:g} m apart with a way between them"
        start, goal, way = ends
        site = _site(grid, way)
        boxes, site = _boxes(site, way, radius, random)
        if len(boxes) < BOXES[0]:
            reason = "no room for boxes near the way"
            continue
        walkers = _walkers(site, way, radius, random)
        if len(walkers) == WALKERS:
            return MapWorld(start, goal, way.length, boxes, walkers)
        reason = "no room for people to walk near the way"
    return reason


@lru_cache(maxsize=2)
def _planner(grid: OccupancyGrid, radius: float) -> tuple[GridPlanner, npt.NDArray[np.int32]]:
    """A planner for the disc, and the map's connected parts for it: 0 is blocked."""
    planner = GridPlanner(grid, radius, "blocked", PlannerConfig(planner="auto"))
    _, parts = cv2.connectedComponents((~planner.inflated).astype(np.uint8), connectivity=4)
    return planner, parts


def _ends(
    grid: OccupancyGrid, radius: float, random: np.random.Generator
) -> tuple[Point, Point, Path] | None:
    planner, parts = _planner(grid, radius + ROOM)
    free = np.argwhere(parts > 0)
    for _ in range(TRIES if len(free) else 0):
        first = free[random.integers(len(free))]
        same = free[parts[free[:, 0], free[:, 1]] == parts[first[0], first[1]]]
        gaps = np.hypot(*(same - first).T) * grid.resolution
        there = same[(gaps >= NEAREST) & (gaps <= FURTHEST)]
        if len(there) == 0:
            continue
        second = there[random.integers(len(there))]
        start = grid.cell_to_world(int(first[0]), int(first[1]))
        goal = grid.cell_to_world(int(second[0]), int(second[1]))
        try:
            return start, goal, planner.plan(start, goal).path
        except PlanningError:
            continue
    return None


def _site(grid: OccupancyGrid, way: Path) -> _Site:
    reach = math.ceil(MARGIN / grid.resolution)
    cells = np.floor(grid.frame.points_to_grid(way.points)).astype(np.int64)
    low = np.maximum(cells.min(axis=0) - reach, 0)
    high = cells.max(axis=0) + reach + 1
    return _Site(grid, grid.blocked()[low[0] : high[0], low[1] : high[1]], low)


def _boxes(
    site: _Site, way: Path, radius: float, random: np.random.Generator
) -> tuple[tuple[Floats, ...], _Site]:
    """Boxes near the way that leave a way, and the site with them."""
    start, goal = way.at(0.0), way.at(way.length)
    wanted = int(random.integers(BOXES[0], BOXES[1] + 1))
    boxes: list[Floats] = []
    for _ in range(TRIES):
        if len(boxes) == wanted:
            break
        centre = np.array(way.at(float(random.uniform(0.1, 0.9)) * way.length))
        angle, yaw = random.uniform(0.0, math.tau, 2)
        centre += random.uniform(0.0, OFF_WAY) * np.array([math.cos(angle), math.sin(angle)])
        half = 0.5 * random.uniform(*BOX_SIZE, 2)
        turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        box = (np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]]) * half) @ turn + centre
        gaps = shapely.distance(shapely.Polygon(box), shapely.points([start, goal]))
        if gaps.min() < FROM_ENDS or not site.is_free(centre):
            continue
        with_box = site.with_box(box)
        if with_box.connects(start, goal, radius + ROOM):
            boxes.append(box)
            site = with_box
    return tuple(boxes), site


def _walkers(
    site: _Site, way: Path, radius: float, random: np.random.Generator
) -> tuple[Mover, ...]:
    start = way.at(0.0)
    ends = shapely.points([start, way.at(way.length)])
    walkers: list[Mover] = []
    for _ in range(TRIES):
        if len(walkers) == WALKERS:
            break
        lane = _lane(site, way, radius, random)
        speed, phase = float(random.uniform(*SPEEDS)), float(random.uniform(0.0, 2.0))
        if lane is None:
            continue
        line = shapely.LineString(lane)
        if shapely.distance(line, ends).min() < LANE_FROM_ENDS + WALKER_RADIUS:
            continue
        begin = lane[0] + (phase if phase <= 1.0 else 2.0 - phase) * (lane[1] - lane[0])
        if np.hypot(*(begin - start)) < WALKER_FROM_START + WALKER_RADIUS:
            continue
        duration = math.dist(*lane) / speed
        times = np.array([0.0, duration]) - phase * duration
        walkers.append(Mover(WALKER_RADIUS, times, lane, "back_and_forth"))
    return tuple(walkers)


def _lane(site: _Site, way: Path, radius: float, random: np.random.Generator) -> Floats | None:
    """A straight lane (2, 2) near the way with room on either side for the robot; None without."""
    room = WALKER_RADIUS + 2.0 * radius + ROOM
    angle, direction = random.uniform(0.0, math.tau, 2)
    middle = np.array(way.at(float(random.uniform(0.1, 0.9)) * way.length))
    middle += random.uniform(0.0, LANE_OFF_WAY) * np.array([math.cos(angle), math.sin(angle)])
    along = np.array([math.cos(direction), math.sin(direction)])
    ends = []
    for sign in (-1.0, 1.0):
        reach = 0.0
        while reach < LANE[1] / 2 and _free(
            site, middle, middle + sign * (reach + LANE_STEP) * along, room
        ):
            reach += LANE_STEP
        ends.append(middle + sign * reach * along)
    return np.array(ends) if math.dist(*ends) >= LANE[0] else None


def _free(site: _Site, a: Floats, b: Floats, room: float) -> bool:
    first, second = site.cells([a, b])
    return segment_clear(site.blocked, first, second, room / site.grid.resolution)
