"""Scripted walkers: how they walk, and what they may not do.

A walker has a role (see ``people_routes``) and a manner (how its speed
changes). It follows its route at 0.3 to 1.6 m/s and changes speed at 3 m/s2 at most, so that a reversal
at 1 m/s takes 0.7 s. At the end of its route it turns back. Routes are curved where there is room.

Rules: a walker's disc keeps 3 cm or more from walls. Nobody is nearer than 0.5 m to the robot at its
start during the first 3 s. Of several tries a walker takes the one that overlaps others the least: they
follow scripts and may pass through one another where a place is crowded.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dynastar.bench.suites.people_routes import (
    PLAN_GAP,
    ROLES,
    SPEEDS,
    WALL_GAP,
    Route,
    Scene,
    beside,
    wander,
)
from dynastar.bench.suites.people_sites import Random, Site
from dynastar.path import Path
from dynastar.robot import Robot
from dynastar.simulation import Mover
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]

RADII = (0.2, 0.5)  # m
ACCELERATION = 3.0  # m/s2
STEP = 0.1  # s between keys
MOST = {"corridor": 4, "hall": 10, "crossing": 7, "doorway": 5, "office": 8}  # walkers drawn
MOST_WALKERS = 10
START_GAP, START_TIME = 0.5, 3.0  # m, s
PAIRS = 0.2  # of the walkers walk in pairs
TRIES = 4

MANNERS = ("steady", "varying", "pausing", "reversing")


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
        line = beside(route.points, float(random.choice((-1, 1))) * (2.0 * radius + 0.1))
        top = SPEEDS[1] if manner == "varying" else route.speed
        faster = np.max(_steps(line) / np.maximum(_steps(route.points), 1e-9))
        if (site.gaps(line) >= radius + WALL_GAP).all() and faster * top <= SPEEDS[1]:
            walkers.append(script(route, radius, s, line))
    return walkers


def _steps(points: Floats) -> Floats:
    """Metres from each of the points (k, 2) to the next."""
    step = np.diff(points, axis=0)
    return np.hypot(step[:, 0], step[:, 1])


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
