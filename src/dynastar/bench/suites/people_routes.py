"""The routes of walkers: where they go with respect to the robot's way, curved where there is room."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.bench.suites.people_sites import Point, Random, Site
from dynastar.errors import PlanningError
from dynastar.path import Path
from dynastar.planning import GridPlanner
from dynastar.robot import Robot

Floats = npt.NDArray[np.float64]

SPEEDS = (0.3, 1.6)  # m/s
SPACING = 0.1  # m between points of a route
WALL_GAP = 0.03  # m
PLAN_GAP = 0.08  # m, kept where a route is planned


class Route(NamedTuple):
    """Where a walker goes: points (k, 2), the speed it likes, and when (s) it sets off."""

    points: Floats
    speed: float
    delay: float = 0.0


class Scene(NamedTuple):
    """Input of a route: the place, the robot in it, and a planner for the disc of a walker."""

    site: Site
    robot: Robot
    random: Random
    radius: float
    planner: GridPlanner

    def speed(self, low: float = SPEEDS[0], high: float = SPEEDS[1]) -> float:
        """A walking speed (m/s) between limits."""
        return float(self.random.uniform(low, max(low, high)))

    def nominal(self, s: float) -> float:
        """When (s) a robot that nobody hinders is ``s`` m along its way, roughly."""
        return 1.0 + 1.3 * s / self.robot.limits.v_max


def wander(scene: Scene) -> Route | None:
    """Here and there."""
    gap = scene.radius + PLAN_GAP
    points = [scene.site.random_point(scene.random, gap) for _ in range(4)]
    return _route(scene, [p for p in points if p is not None], scene.speed())


def oncoming(scene: Scene) -> Route | None:
    """From beyond the goal along the robot's way to behind its start."""
    first, last = _beyond_ends(scene)
    return _route(
        scene, [last, *_middles(scene)[::-1], first], scene.speed(), scene.random.uniform(0, 4)
    )


def overtaking(scene: Scene) -> Route | None:
    """From behind the robot along its way, faster than it."""
    first, last = _beyond_ends(scene)
    speed = scene.speed(max(1.1 * scene.robot.limits.v_max, SPEEDS[0]), SPEEDS[1])
    delay = float(scene.random.uniform(0.0, scene.nominal(0.5 * scene.site.way.length)))
    return _route(scene, [first, *_middles(scene), last], speed, delay)


def slow_ahead(scene: Scene) -> Route | None:
    """Along the robot's way before it, slower than it."""
    way = scene.site.way
    begin = way.at(float(scene.random.uniform(2.5, 5.0)))
    speed = scene.speed(SPEEDS[0], 0.7 * scene.robot.limits.v_max)
    return _route(scene, [begin, way.at(0.7 * way.length), _beyond_ends(scene)[1]], speed)


def crossing(scene: Scene) -> Route | None:
    """To and fro across the robot's way, first when the robot should be near."""
    way, random = scene.site.way, scene.random
    s = float(random.uniform(0.3, 0.9)) * way.length
    middle, direction = way.at(s), _direction(way, s)
    turn = direction + random.choice((-1, 1)) * (math.pi / 2 + float(random.uniform(-0.7, 0.7)))
    ends = [_beyond(scene, middle, turn + half, 5.0) for half in (0.0, math.pi)]
    speed = scene.speed()
    delay = scene.nominal(s) - math.dist(ends[0], middle) / speed + float(random.uniform(-2, 2))
    return _route(scene, ends, speed, delay) if math.dist(*ends) >= 2.0 else None


def corner(scene: Scene) -> Route | None:
    """Onto the robot's way from where the robot cannot see it before."""
    site, way, random = scene.site, scene.site.way, scene.random
    s = float(random.uniform(0.3, 0.9)) * way.length
    middle, before = way.at(s), way.at(s - 2.5)
    for _ in range(8):
        hidden = site.random_point(random, scene.radius + PLAN_GAP)
        if hidden is None or math.dist(hidden, middle) > 8.0:
            continue
        if shapely.LineString([before, hidden]).intersects(site.outline):
            speed, onward = scene.speed(), site.random_point(random, scene.radius + PLAN_GAP)
            route = _route(scene, [hidden, middle, onward or hidden], speed)
            if route is not None:
                there = Path(route.points).project(*middle) / speed
                delay = scene.nominal(s) - there + float(random.uniform(-2.0, 2.0))
                return route._replace(delay=max(delay, 0.0))
    return None


ROLES: dict[str, Callable[[Scene], Route | None]] = {
    "wander": wander,
    "oncoming": oncoming,
    "overtaking": overtaking,
    "slow_ahead": slow_ahead,
    "crossing": crossing,
    "corner": corner,
}


def _route(scene: Scene, stops: list[Point], speed: float, delay: float = 0.0) -> Route | None:
    """A route through stops, curved where there is room; None if there is none."""
    lines = []
    try:
        for a, b in pairwise(stops):
            lines.append(scene.planner.plan(a, b).path.points)
    except PlanningError:
        return None
    if not lines:
        return None
    path = Path(np.vstack(lines))
    if path.length < 1.5:
        return None
    straight = path.resampled(0.0, path.length, SPACING)
    points = _curved(scene, straight)
    return None if points is None else Route(points, speed, max(float(delay), 0.0))


def _curved(scene: Scene, points: Floats) -> Floats | None:
    """The points (k, 2) with round corners and, for half of them, bends; None if nothing is clear."""
    bend = float(scene.random.choice((0.0, 0.0, 0.3, 0.6)))
    wave, phase = scene.random.uniform((2.5, 0.0), (6.0, math.tau))
    for window, size in ((9, bend), (9, 0.5 * bend), (5, 0.25 * bend), (3, 0.0), (1, 0.0)):
        smooth = _smoothed(points, window)
        s = Path(smooth).arc
        away = size * np.sin(math.tau * s / wave + phase) * np.minimum(s, s[-1] - s).clip(0.0, 1.0)
        bent = beside(smooth, away)
        if (scene.site.gaps(bent) >= scene.radius + WALL_GAP).all():
            return bent
    return None


def _smoothed(points: Floats, window: int) -> Floats:
    """Points (k, 2) as means over ``window`` of them; the ends stay where they are."""
    half = window // 2
    padded = np.vstack([np.repeat(points[:1], half, 0), points, np.repeat(points[-1:], half, 0)])
    kernel = np.full(window, 1.0 / window)
    return np.column_stack([np.convolve(padded[:, axis], kernel, "valid") for axis in (0, 1)])


def beside(points: Floats, away: Floats | float) -> Floats:
    """Points (k, 2) moved to the left of their line by ``away`` m."""
    step = np.gradient(points, axis=0)
    length = np.maximum(np.hypot(step[:, 0], step[:, 1]), 1e-9)
    left = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None]
    return np.asarray(points + left * np.broadcast_to(away, len(points))[:, None])


def _direction(way: Path, s: float) -> float:
    x, y = np.subtract(way.at(s + 0.3), way.at(s - 0.3))
    return math.atan2(y, x)


def _middles(scene: Scene) -> list[Point]:
    """Two points near the robot's way, at a third and two thirds of it."""
    way, found = scene.site.way, []
    for part in (1 / 3, 2 / 3):
        middle = np.add(way.at(part * way.length), scene.random.uniform(-0.8, 0.8, 2))
        if scene.site.gaps(middle[None])[0] >= scene.radius + PLAN_GAP:
            found.append((float(middle[0]), float(middle[1])))
    return found


def _beyond_ends(scene: Scene) -> tuple[Point, Point]:
    """Places behind the robot's start and beyond its goal."""
    way = scene.site.way
    behind = _beyond(scene, way.at(0.0), _direction(way, 0.0) + math.pi, 5.0)
    return behind, _beyond(scene, way.at(way.length), _direction(way, way.length), 3.0)


def _beyond(scene: Scene, begin: Point, direction: float, most: float) -> Point:
    """The furthest point that a walker gets to straight from ``begin``, ``most`` m at most."""
    reach = np.arange(0.0, most + 1e-9, SPACING)
    line = np.add(begin, reach[:, None] * np.array([math.cos(direction), math.sin(direction)]))
    clear = scene.site.gaps(line) >= scene.radius + PLAN_GAP
    last = len(line) - 1 if clear.all() else max(int(np.argmin(clear)) - 1, 0)
    return float(line[last, 0]), float(line[last, 1])
