"""The world of a scene while it is changed: what is painted, put in, pushed and taken away."""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.errors import InputError
from dynastar.play import messages as ask
from dynastar.play.paint import Paint
from dynastar.play.walkers import RADIUS, from_now, gone, walker
from dynastar.simulation import Mover, Scenario, World
from dynastar.simulation.contact import placed_footprint
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]

MOST_WALKERS = 40  # in a scene
CLEAR = 0.1  # m that paint keeps from robot and walkers, and walkers from a robot that they touched
APART = 0.3  # m from the robot at which somebody may be put in
SLOW = 0.5  # m/s, the least speed of walkers who turn away from the robot
SOON = 1e-3  # s over which a mover's velocity is taken


def _unattended(scenario: Scenario) -> Scenario:
    """The scenario with walkers who react to nobody: the page moves them by their scripts."""
    return replace(scenario, attention="none")


class Scenery:
    """A scene's world, and ``scenario`` with the obstacles and movers that are in it now."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.world = World(_unattended(scenario))
        self._paint, self._rings = Paint(scenario.grid), scenario.obstacles
        self._movers = list(scenario.movers)

    def use(self, scenario: Scenario) -> None:
        """Takes another scenario's settings and limits, in the world as it is."""
        self.scenario = scenario
        self._change()

    def as_of_now(self) -> Scenario:
        """The scene to begin where it stands."""
        rest = self.scenario.time_limit
        movers = [from_now(mover, self.world.time, rest) for mover in self._movers]
        there, (x, y, heading) = tuple(one for one in movers if one is not None), self.world.pose
        return replace(self.scenario, start=(x, y, heading), movers=there)

    def _change(self) -> None:
        rings = (*self._rings, *self._paint.rings)
        self.scenario = replace(self.scenario, obstacles=rings, movers=tuple(self._movers))
        self.world.change(_unattended(self.scenario))

    @property
    def _reach(self) -> float:
        return self.scenario.robot.footprint.circumscribed

    def _places(self) -> Floats:
        """Where the scene's own movers are, (m, 2) metres, NaN for those that are gone."""
        return self.world.movers[: len(self._movers)]

    def _walker(self, place: Floats, velocity: Floats, radius: float) -> Mover:
        return walker(place, velocity, radius, self.world.time, self.world.gaps)

    def _gaps_with_robot(self, points: Floats) -> Floats:
        """Metres (n,) from points (n, 2) to the nearest obstacle or the robot."""
        apart = np.hypot(*(points - self.world.pose[:2]).T) - self._reach
        return np.minimum(self.world.gaps(points), np.maximum(apart, 0.0))

    # -- what is asked for ------------------------------------------------------------------------

    def stroke(self, message: ask.Stroke) -> None:
        """Paints, or takes away what the brush touches: paint, obstacles of the scene, walkers."""
        self._paint.stroke(message.points, message.radius, message.erase)
        if message.erase:
            self._erase(message)
        else:
            places, radii = self.world.movers, self.world.mover_radii
            self._paint.keep_clear(
                np.vstack([self.world.pose[:2], places]), np.r_[self._reach, radii] + CLEAR
            )
        new = self._paint.renew()
        self._change()
        if not message.erase and new and self._turn_back(new):
            self._change()

    def _erase(self, message: ask.Stroke) -> None:
        points = list(message.points)
        brush = shapely.LineString(points * 2 if len(points) == 1 else points)
        self._rings = tuple(
            ring for ring in self._rings if shapely.Polygon(ring).distance(brush) > message.radius
        )
        for i, place in enumerate(self._places()):
            radius = self._movers[i].radius
            if np.isfinite(place).all() and shapely.Point(place).distance(brush) < radius:
                self._movers[i] = gone(radius)

    def _turn_back(self, painted: list[Floats]) -> bool:
        """Shorten the lines of walkers that are painted over. Returns True if any are."""
        solid, turned = shapely.union_all([shapely.Polygon(ring) for ring in painted]), False
        for i, place in enumerate(self._places()):
            mover = self._movers[i]
            line = shapely.LineString(np.vstack([mover.points, mover.points[-1:]]))
            if np.isfinite(place).all() and line.distance(solid) < mover.radius:
                one, now = Movers([mover]), self.world.time
                velocity = (one.at(now + SOON) - one.at(now))[0] / SOON
                self._movers[i] = self._walker(place, np.nan_to_num(velocity), mover.radius)
                turned = True
        return turned

    def put_in(self, message: ask.Walker) -> None:
        """Add a walker who walks to and fro."""
        place = np.array([message.x, message.y])
        if np.isfinite(self._places()[:, 0]).sum() >= MOST_WALKERS:
            raise InputError(f"there are {MOST_WALKERS} walkers in the scene, which are enough")
        if self.world.gaps(place[None])[0] <= RADIUS:
            raise InputError(f"nobody has room at ({message.x:.2f}, {message.y:.2f})")
        if math.dist(place, self.world.pose[:2]) < self._reach + RADIUS + APART:
            raise InputError("that is too near to the robot")
        self._movers.append(self._walker(place, np.array([message.vx, message.vy]), RADIUS))
        self._change()

    def push(self, message: ask.Push) -> None:
        """Sends a mover another way."""
        number = message.mover
        if number >= len(self._movers) or np.isnan(self._places()[number]).any():
            raise InputError(f"there is no moving obstacle {number} to push")
        velocity = np.array([message.vx, message.vy])
        radius = self._movers[number].radius
        self._movers[number] = self._walker(self._places()[number], velocity, radius)
        self._change()

    # -- contacts ---------------------------------------------------------------------------------

    def part(self) -> bool:
        """Turn walkers who touch the robot away from it. Returns True if there are any."""
        world, footprint = self.world, self.scenario.robot.footprint
        shape, here = placed_footprint(world.pose, footprint), np.array(world.pose[:2])
        disc, touching = self._reach if footprint.is_disc else 0.0, False
        for i, place in enumerate(self._places()):
            radius = self._movers[i].radius
            apart = shape.distance(shapely.Point(place)) - disc - radius
            if not np.isfinite(place).all() or apart > SOON:
                continue
            touching = True
            away = (place - here) / max(math.dist(place, here), 1e-9)
            aside = here + (self._reach + radius + CLEAR) * away
            if world.gaps(aside[None])[0] > radius:
                self._movers[i] = walker(
                    aside, SLOW * away, radius, world.time, self._gaps_with_robot
                )
            else:
                self._movers[i] = gone(radius)
        if touching:
            self._change()
        return touching
