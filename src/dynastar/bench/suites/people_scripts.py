"""Scripted walkers: where they go, how they walk, and what they may not do.

A walker has a role (where it goes with respect to the robot's way) and a manner (how its speed
changes). It follows its route at 0.3 to 1.6 m/s and changes speed at 3 m/s2 at most, so that a reversal
at 1 m/s takes 0.7 s. At the end of its route it turns back. Routes are curved where there is room.

Rules: a walker's disc keeps 3 cm or more from walls. Nobody is nearer than 0.5 m to the robot at its
start during the first 3 s. Of several tries a walker takes the one that overlaps others the least: they
follow scripts and may pass through one another where a place is crowded.
"""

import math
from collections.abc import Callable, Sequence
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
from dynastar.simulation import Mover
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]

RADII, SPEEDS = (0.2, 0.5), (0.3, 1.6)  # m, m/s
ACCELERATION = 3.0  # m/s2
STEP, SPACING = 0.1, 0.1  # s between keys, m between points of a route
MOST = {"corridor": 4, "hall": 10, "crossing": 7, "doorway": 5, "office": 8}  # walkers drawn
MOST_WALKERS = 10
WALL_GAP = 0.03  # m
PLAN_GAP = 0.08  # m, kept where a route is planned
START_GAP, START_TIME = 0.5, 3.0  # m, s
PAIRS = 0.2  # of the walkers walk in pairs
TRIES = 4

MANNERS = ("steady", "varying", "pausing", "reversing")


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


def draw_walkers(site: Site, robot: Robot, random: Random, duration: float) -> tuple[Mover, ...]:
    """One to ten walkers who follow scripts for ``duration`` seconds, and then back."""
    wanted = int(random.integers(1, MOST[site.kind] + 1))
    walkers: list[Mover] = []
    for _ in range(3 * wanted):
        if len(walkers) >= wanted:
            break
        tries = [_drawn(site, robot, random, duration) for _ in range(TRIES)]
        fitting = [t for t in tries if t and not _at_start(t, site, robot)]
        if fitting:
            overlaps = [_overlap(t, walkers) for t in fitting]
            walkers += fitting[overlaps.index(min(overlaps))]
    return tuple(walkers[:MOST_WALKERS])


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


def progress(length: float, route: Route, manner: str, random: Random, duration: float) -> Floats:
    """Metres along a route of ``length`` m every ``STEP`` s for ``duration`` s, back and forth."""
    s, v, forward = 0.0, 0.0, 1.0
    switch, wanted, ending = route.delay, 0.0, False
    out, change = [0.0], ACCELERATION * STEP
    for tick in range(1, math.ceil(duration / STEP) + 1):
        now = tick * STEP
        if now >= switch:
            rests = wanted != 0.0 and manner == "pausing"
            if manner == "reversing" and wanted != 0.0:
                forward = -forward
            speed = route.speed
            if manner == "varying":
                speed = float(random.uniform(*SPEEDS))
            wanted = 0.0 if rests else speed
            switch = now + float(random.uniform(*((1.0, 5.0) if rests else (2.0, 8.0))))
        room = (length - s) if (v or forward) > 0 else s
        ending = ending or room <= 0.5 * v * v / ACCELERATION + 1.5 * abs(v) * STEP + 1e-6
        aim = 0.0 if ending else forward * wanted
        v += min(max(aim - v, -change), change)
        s = min(max(s + v * STEP, 0.0), length)
        if ending and abs(v) < 1e-9:
            forward, ending = (1.0 if s < 0.5 * length else -1.0), False
        out.append(s)
    return np.array(out)


def script(route: Route, radius: float, s: Floats, aside: Floats | None = None) -> Mover:
    """The mover that is ``s`` (k,) m along a route, or along the points ``aside`` next to it."""
    arc = Path(route.points).arc
    points = route.points if aside is None else aside
    keys = np.column_stack([np.interp(s, arc, points[:, axis]) for axis in (0, 1)])
    return Mover(radius, STEP * np.arange(len(s), dtype=np.float64), keys, "back_and_forth")


def _drawn(site: Site, robot: Robot, random: Random, duration: float) -> list[Mover]:
    """A walker, or two side by side; empty if the draw leads nowhere."""
    radius = float(random.uniform(*RADII))
    scene = Scene(site, robot, random, radius, site.planner(radius + PLAN_GAP))
    route = ROLES[str(random.choice(list(ROLES)))](scene) or wander(scene)
    if route is None or Path(route.points).length < 1.5:
        return []
    manner = str(random.choice(MANNERS))
    s = progress(Path(route.points).length, route, manner, random, duration)
    walkers = [script(route, radius, s)]
    if random.random() < PAIRS:
        beside = _beside(route.points, float(random.choice((-1, 1))) * (2.0 * radius + 0.1))
        top = SPEEDS[1] if manner == "varying" else route.speed
        faster = np.max(_steps(beside) / np.maximum(_steps(route.points), 1e-9))
        if (site.gaps(beside) >= radius + WALL_GAP).all() and faster * top <= SPEEDS[1]:
            walkers.append(script(route, radius, s, beside))
    return walkers


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
        bent = _beside(smooth, away)
        if (scene.site.gaps(bent) >= scene.radius + WALL_GAP).all():
            return bent
    return None


def _smoothed(points: Floats, window: int) -> Floats:
    """Points (k, 2) as means over ``window`` of them; the ends stay where they are."""
    half = window // 2
    padded = np.vstack([np.repeat(points[:1], half, 0), points, np.repeat(points[-1:], half, 0)])
    kernel = np.full(window, 1.0 / window)
    return np.column_stack([np.convolve(padded[:, axis], kernel, "valid") for axis in (0, 1)])


def _beside(points: Floats, away: Floats | float) -> Floats:
    """Points (k, 2) moved to the left of their line by ``away`` m."""
    step = np.gradient(points, axis=0)
    length = np.maximum(np.hypot(step[:, 0], step[:, 1]), 1e-9)
    left = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None]
    return np.asarray(points + left * np.broadcast_to(away, len(points))[:, None])


def _steps(points: Floats) -> Floats:
    """Metres from each of the points (k, 2) to the next."""
    step = np.diff(points, axis=0)
    return np.hypot(step[:, 0], step[:, 1])


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


def _at_start(walkers: list[Mover], site: Site, robot: Robot) -> bool:
    """Whether a person comes too near to the robot's start in the first seconds."""
    reach = robot.footprint.circumscribed + START_GAP
    for walker in walkers:
        early = walker.points[walker.times <= START_TIME]
        if np.hypot(*(early - site.start).T).min() < reach + walker.radius:
            return True
    return False


def _overlap(walkers: Sequence[Mover], others: Sequence[Mover]) -> float:
    """Seconds, summed over pairs, in which walkers overlap others."""
    if not others:
        return 0.0
    mine, theirs = Movers(walkers), Movers(others)
    reach = mine.radii[:, None] + theirs.radii
    count = 0
    for time in np.arange(0.0, 60.0, 0.25):
        apart = mine.at(time)[:, None] - theirs.at(time)
        count += int((np.hypot(apart[..., 0], apart[..., 1]) < reach).sum())
    return 0.25 * count
