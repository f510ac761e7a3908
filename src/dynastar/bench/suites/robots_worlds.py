"""The maps of the suite ``robots``, and the missions that are drawn on them.

The maps are drawn once from fixed seeds: corridors, halls, a crossing, doors and offices as in the suite
``people``, two cluttered rooms as in ``random``, and the project's own map in the manner of the paper's.
A mission has up to three unmapped boxes near its way. A robot fits at start and goal whichever way it
faces. ``random_truth`` checks that a way exists which leaves ``ROOM`` more than a careful robot needs, or,
where boards enclose the goal, that none does.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.bench.own_maps import own_forty
from dynastar.bench.suites.people_sites import SITES
from dynastar.bench.suites.random_layout import BOARD, Layout, StaticWorld, turned
from dynastar.bench.suites.random_truth import TrueSpace
from dynastar.clearance import distance_field
from dynastar.errors import PlanningError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.path import Path
from dynastar.planning import GridPlanner, PlannerConfig
from dynastar.robot import Robot

Floats = npt.NDArray[np.float64]
Random = np.random.Generator
Point = tuple[float, float]

CHECKED = 0.1  # m, cells of the map on which ways are checked
ROOM = 0.08  # m
NEAREST, LONGEST = 3.0, 40.0  # m, s at full speed: from start to goal
BOXES, BOX_SIZE, OFF_WAY = 3, (0.2, 0.6), 0.8  # at most, m, m
UNREACHABLE = 0.1  # share of the missions
CLUTTER = 0.08  # share of a cluttered room's area
GOAL_TOLERANCE = 0.25  # m
ATTEMPTS = 20


class RobotWorld(NamedTuple):
    """A mission: ``length`` (m) is of the way on the map; ``obstacles`` are not on the map."""

    start: Pose2D
    goal: Goal
    obstacles: tuple[Floats, ...]
    reachable: bool
    length: float


def cluttered(random: Random) -> OccupancyGrid:
    """A room of 14 x 11 m with things all over, all of them on the map."""
    layout = Layout(14.0, 11.0, random)
    low, high = (0.5, 0.5), (layout.width - 0.5, layout.height - 0.5)
    things = [layout.thing(1.0) + random.uniform(low, high) for _ in range(60)]
    areas = np.cumsum(shapely.area([shapely.Polygon(ring) for ring in things]))
    for ring in things[: int(np.searchsorted(areas, CLUTTER * layout.width * layout.height))]:
        layout.mapped(ring)
    return layout.finished((0.0, 0.0, None), (0.0, 0.0)).grid


def in_the_papers_manner(random: Random) -> OccupancyGrid:
    """The project's own 40 x 40 cells, 0.5 m each, with a wall all round."""
    del random
    return OccupancyGrid.from_occupied(np.pad(own_forty().occupied, 1, constant_values=True), 0.5)


def _site(kind: str) -> Callable[[Random], OccupancyGrid]:
    def draw(random: Random) -> OccupancyGrid:
        grid, _, _ = SITES[kind](random)
        return grid

    return draw


DRAWERS: dict[str, Callable[[Random], OccupancyGrid]] = {
    **{kind: _site(kind) for kind in SITES},
    "clutter": cluttered,
    "own_forty": in_the_papers_manner,
}
MAPS: tuple[tuple[str, int], ...] = (  # kind, seed
    ("corridor", 1),
    ("hall", 1),
    ("doorway", 1),
    ("office", 1),
    ("clutter", 1),
    ("crossing", 1),
    ("own_forty", 0),
    ("corridor", 2),
    ("hall", 2),
    ("doorway", 2),
    ("office", 2),
    ("clutter", 2),
)


def name_of(place: tuple[str, int]) -> str:
    """A map's name in tables."""
    kind, seed = place
    return f"{kind} {seed}"


@lru_cache
def draw_map(kind: str, seed: int) -> OccupancyGrid:
    """A map of the suite."""
    return DRAWERS[kind](np.random.default_rng(seed))


@lru_cache
def checked_map(kind: str, seed: int) -> OccupancyGrid:
    """The map in cells of ``CHECKED``, occupied where any part of them is."""
    grid = draw_map(kind, seed)
    fine = grid.refined(max(1, round(grid.resolution / CHECKED)))
    n = round(CHECKED / fine.resolution)
    rows, columns = (n * math.ceil(size / n) for size in fine.occupied.shape)
    padded = np.ones((rows, columns), np.bool_)
    padded[: fine.rows, : fine.columns] = fine.occupied
    pooled = padded.reshape(rows // n, n, columns // n, n).any(axis=(1, 3))
    return OccupancyGrid.from_occupied(pooled, CHECKED)


def draw_world(kind: str, seed: int, robot: Robot, random: Random) -> RobotWorld | str:
    """A mission for a robot on a map, or why the rules find none."""
    reachable = bool(random.random() >= UNREACHABLE)
    reason = "no two places with a way between them"
    for _ in range(ATTEMPTS):
        ends = _ends(checked_map(kind, seed), robot, random)
        if ends is None:
            continue
        start, goal, way = ends
        obstacles = _boxes(way, robot.footprint.circumscribed, random)
        heading = float(random.uniform(-math.pi, math.pi)) if random.random() < 0.5 else None
        if not reachable:
            obstacles, heading = [*obstacles, *_boards(goal, robot)], None
        made = RobotWorld(start, Goal(*goal, heading), tuple(obstacles), reachable, way.length)
        reason = check(checked_map(kind, seed), made, robot.footprint)
        if not reason:
            return made
    return reason


def check(grid: OccupancyGrid, made: RobotWorld, footprint: Footprint) -> str:
    """Why a mission is left out, or ""."""
    start, goal = (made.start.x, made.start.y), (made.goal.x, made.goal.y)
    space = TrueSpace(StaticWorld(grid, made.obstacles, made.start, goal))
    if not made.reachable:
        apart = shapely.distance(
            shapely.Point(start), [shapely.Polygon(ring) for ring in made.obstacles]
        )
        if apart.min() < footprint.circumscribed + ROOM:
            return "the boards touch the start"
        reached = space.possible(footprint, start, goal, GOAL_TOLERANCE + ROOM)
        return "the goal may be reached" if reached else ""
    certain = space.careful(grown(footprint, ROOM), made.start, goal)
    return "" if certain else "no way with room for a careful robot"


def grown(footprint: Footprint, room: float) -> Footprint:
    """A footprint grown by ``room`` (m) on all sides."""
    if footprint.is_disc:
        return Footprint.disc(footprint.circumscribed + room)
    ring = shapely.Polygon(footprint.vertices).buffer(room, join_style="mitre").exterior
    return Footprint.polygon(np.asarray(ring.coords)[:-1].tolist())


@lru_cache(maxsize=32)
def _places(grid: OccupancyGrid, radius: float) -> Floats:
    """Centres (n, 2), m, of the cells where a disc fits."""
    fits = distance_field(grid.occupied, grid.resolution) > radius + grid.resolution
    return np.asarray((np.argwhere(fits)[:, ::-1] + 0.5) * grid.resolution)


@lru_cache(maxsize=32)
def _planner(grid: OccupancyGrid, radius: float) -> GridPlanner:
    return GridPlanner(grid, radius, "blocked", PlannerConfig(planner="auto"))


def _ends(grid: OccupancyGrid, robot: Robot, random: Random) -> tuple[Pose2D, Point, Path] | None:
    footprint, longest = robot.footprint, LONGEST * robot.limits.v_max
    places = _places(grid, footprint.circumscribed + 2 * ROOM)
    if len(places) == 0:
        return None
    first = places[random.integers(len(places))]
    gaps = np.hypot(*(places - first).T)
    others = places[(gaps >= NEAREST) & (gaps <= longest)]
    if len(others) == 0:
        return None
    (x, y), (x1, y1) = map(float, first), map(float, others[random.integers(len(others))])
    try:
        way = _planner(grid, footprint.inscribed + ROOM).plan((x, y), (x1, y1)).path
    except PlanningError:
        return None
    if way.length > longest:
        return None
    return Pose2D(x, y, float(random.uniform(-math.pi, math.pi))), (x1, y1), way


def _boxes(way: Path, reach: float, random: Random) -> list[Floats]:
    """Boxes near the way that leave room for the robot at its ends."""
    ends, boxes = shapely.points([way.at(0.0), way.at(way.length)]), []
    for _ in range(int(random.integers(BOXES + 1))):
        x, y = 0.5 * random.uniform(*BOX_SIZE, 2)
        ring = turned(np.array([(-x, -y), (x, -y), (x, y), (-x, y)]), random.uniform(0, math.pi))
        angle, off = random.uniform(0.0, math.tau), random.uniform(0.0, OFF_WAY)
        middle = way.at(float(random.uniform(0.15, 0.85)) * way.length)
        ring = ring + middle + off * np.array([math.cos(angle), math.sin(angle)])
        if shapely.distance(shapely.Polygon(ring), ends).min() > reach + 2 * ROOM:
            boxes.append(ring)
    return boxes


def _boards(goal: Point, robot: Robot) -> list[Floats]:
    """Four boards round a goal, out of whose reach the robot stays."""
    half = robot.footprint.circumscribed + GOAL_TOLERANCE + 2 * ROOM
    x, y = goal
    sides = [
        (-half - BOARD, -half - BOARD, -half, half + BOARD),
        (half, -half - BOARD, half + BOARD, half + BOARD),
        (-half, -half - BOARD, half, -half),
        (-half, half, half, half + BOARD),
    ]
    return [np.array([(a, b), (c, b), (c, d), (a, d)]) + (x, y) for a, b, c, d in sides]
