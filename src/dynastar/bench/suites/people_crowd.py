"""Pedestrians who react to the robot: who walks where, and a robot that gets through among them.

They take the same roles as scripted walkers (see ``people_routes``) and walk their routes to and fro,
but JuPedSim moves them. A world is kept only if a simple robot gets through: it drives its way at no
more than full speed, turns on the spot at corners, stops while a person is near ahead, creeps on after
a while if they stay there but leave 0.2 m, and arrives in time with 2 cm or more to everybody. It must
also stand at its start for ``STAND`` seconds untouched.
"""

import math

import numpy as np
import numpy.typing as npt

from dynastar.bench.suites.people_routes import PLAN_GAP, ROLES, SPEEDS, Scene, wander
from dynastar.bench.suites.people_scripts import START_GAP
from dynastar.bench.suites.people_sites import Random, Site
from dynastar.geometry import Pose2D, wrap_angle
from dynastar.path import Path
from dynastar.robot import Robot
from dynastar.simulation import Pedestrian
from dynastar.simulation.crowd import STEP, Crowd

Floats = npt.NDArray[np.float64]

RADII = (0.2, 0.3)  # m
MOST = {"corridor": 4, "hall": 10, "crossing": 5, "doorway": 3, "office": 5}  # pedestrians drawn
APART = 0.15  # m between pedestrians at first
FROM_START = 1.0  # m between the robot and pedestrians at first
WAYPOINTS = 4.0  # m apart along a route
STAND = 20.0  # s
TOUCH = 0.02  # m
AHEAD, BESIDE = (
    0.6,
    0.15,
)  # m, free space that the simple robot wants beyond its stop, and beside it
WAIT, CREEP, CREEP_AHEAD = 3.0, 0.15, 0.2  # s until it creeps on, m/s, m that it wants free then


def draw_pedestrians(site: Site, robot: Robot, random: Random) -> tuple[Pedestrian, ...]:
    """One to ten pedestrians; fewer where there is no room for more."""
    wanted = int(random.integers(1, MOST[site.kind] + 1))
    found: list[Pedestrian] = []
    for _ in range(6 * wanted):
        if len(found) == wanted:
            break
        radius = float(random.uniform(*RADII))
        scene = Scene(site, robot, random, radius, site.planner(radius + PLAN_GAP))
        route = ROLES[str(random.choice(list(ROLES)))](scene) or wander(scene)
        if route is None:
            continue
        path = Path(route.points)
        count = max(2, math.ceil(path.length / WAYPOINTS) + 1)
        points = np.array([path.at(s) for s in np.linspace(0.0, path.length, count)])
        start = (float(points[0, 0]), float(points[0, 1]))
        speed = min(route.speed, SPEEDS[1])
        made = Pedestrian(radius, speed, start, np.vstack([points[1:], points[-2::-1]]))
        if _fits(made, found, site, robot):
            found.append(made)
    return tuple(found)


def _fits(new: Pedestrian, others: list[Pedestrian], site: Site, robot: Robot) -> bool:
    gap = max(FROM_START, START_GAP) + robot.footprint.circumscribed + new.radius
    return math.dist(new.start, site.start) >= gap and all(
        math.dist(new.start, other.start) >= new.radius + other.radius + APART for other in others
    )


def stands(
    site: Site, robot: Robot, crowd: tuple[Pedestrian, ...], heading: float, seed: int
) -> bool:
    """Whether nobody touches a robot that stands at its start for ``STAND`` seconds."""
    people = Crowd(crowd, site.grid, (), robot.footprint, seed)
    pose, radii = Pose2D(*site.start, heading), np.array([p.radius for p in crowd])
    for tick in range(round(STAND / STEP)):
        people.advance(tick * STEP, pose)
        if _gap(people.at(tick * STEP), radii, pose, robot) < TOUCH:
            return False
    return True


def gets_through(
    site: Site, robot: Robot, crowd: tuple[Pedestrian, ...], seed: int, seconds: float
) -> bool:
    """Whether the simple robot arrives within ``seconds`` and touches nobody."""
    people = Crowd(crowd, site.grid, (), robot.footprint, seed)
    radii = np.array([p.radius for p in crowd])
    driver = _SimpleDriver(site, robot)
    for tick in range(round(seconds / STEP)):
        now = tick * STEP
        people.advance(now, driver.pose)
        centres = people.at(now)
        if _gap(centres, radii, driver.pose, robot) < TOUCH:
            return False
        if driver.there:
            return True
        driver.step(centres, radii)
    return False


class _SimpleDriver:
    """Follows a way within the robot's limits; stops while a person is near ahead."""

    def __init__(self, site: Site, robot: Robot) -> None:
        self._points, self._robot = site.way.points, robot
        self._next, self._speed, self._turning, self._waited = 1, 0.0, 0.0, 0.0
        begin = self._points[0]
        x, y = self._points[1] - begin
        self.pose = Pose2D(float(begin[0]), float(begin[1]), math.atan2(y, x))

    @property
    def there(self) -> bool:
        """Whether it rests at the end of its way."""
        return self._next >= len(self._points)

    def step(self, centres: Floats, radii: Floats) -> None:
        """Drives or turns for one step."""
        limits, (x, y, theta) = self._robot.limits, self.pose
        dx, dy = self._points[self._next] - (x, y)
        left, error = math.hypot(dx, dy), wrap_angle(math.atan2(dy, dx) - theta)
        if left < 1e-6:
            self._next += 1
        elif abs(error) > 1e-3 and self._speed <= 0.0:
            fastest = math.sqrt(2.0 * limits.omega_brake * abs(error))
            grown = self._turning + limits.omega_accel * STEP
            self._turning = min(fastest, grown, limits.omega_max)
            turn = min(self._turning * STEP, abs(error))
            self.pose = Pose2D(x, y, theta + math.copysign(turn, error))
        else:
            self._turning = 0.0
            aim = limits.v_max
            if self._somebody_ahead(centres, radii, AHEAD):
                self._waited += STEP
                near = self._waited < WAIT or self._somebody_ahead(centres, radii, CREEP_AHEAD)
                aim = 0.0 if near else CREEP
            else:
                self._waited = 0.0
            aim = min(aim, math.sqrt(2.0 * limits.v_brake * left))
            change = limits.v_accel if aim > self._speed else limits.v_brake
            self._speed += min(max(aim - self._speed, -change * STEP), change * STEP)
            driven = min(self._speed * STEP, left)
            self.pose = Pose2D(x + driven * dx / left, y + driven * dy / left, theta)
            if driven >= left - 1e-6:
                self._speed = 0.0
                self._next += 1

    def _somebody_ahead(self, centres: Floats, radii: Floats, room: float) -> bool:
        """Whether a person is within ``room`` m of where the robot would stop."""
        x, y, theta = self.pose
        reach, limits = self._robot.footprint.circumscribed, self._robot.limits
        ahead = reach + room + self._speed * STEP + 0.5 * self._speed**2 / limits.v_brake
        apart = centres - (x, y)
        along = apart[:, 0] * math.cos(theta) + apart[:, 1] * math.sin(theta)
        across = np.abs(apart[:, 1] * math.cos(theta) - apart[:, 0] * math.sin(theta))
        near = (along > 0.0) & (along < ahead + radii) & (across < reach + BESIDE + radii)
        return bool(near.any())


def _gap(centres: Floats, radii: Floats, pose: Pose2D, robot: Robot) -> float:
    away = np.hypot(*(centres - pose[:2]).T) - radii - robot.footprint.circumscribed
    return float(away.min(initial=math.inf))
