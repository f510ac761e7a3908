"""How far a robot drives until it rests, and how far ahead its lidar shows free space."""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from dynastar.footprint import Footprint
from dynastar.navigator.config import NavigatorConfig, fitted, margin_of
from dynastar.perception.hidden import APPROACH
from dynastar.perception.local_map import OFF_CENTRE
from dynastar.robot import Lidar, Limits, Robot

RIM_POINTS = 180  # of a circle


@dataclass(frozen=True)
class Stop:
    """A certified stop from ``speed`` (m/s): ``reaction`` and ``braking`` are metres.

    The robot drives on for latency and period, then it brakes, both from a speed that is greater by
    ``drive_error``.
    """

    speed: float
    reaction: float
    braking: float
    seconds: float

    @property
    def distance(self) -> float:
        """Metres until the robot rests."""
        return self.reaction + self.braking


def stop_from(speed: float, limits: Limits, config: NavigatorConfig) -> Stop:
    """The certified stop from a forward speed (m/s) that is commanded."""
    delay, fast = config.latency + config.period, (1.0 + config.drive_error) * speed
    braking = fast * fast / (2.0 * limits.v_brake)
    return Stop(speed, fast * delay, braking, delay + fast / limits.v_brake)


def fastest_within(distance: float, limits: Limits, config: NavigatorConfig) -> float:
    """The speed (m/s) from which a stop takes ``distance`` (m), not more than v_max."""
    fast = _fastest(distance, config.latency + config.period, limits.v_brake)
    return min(limits.v_max, fast / (1.0 + config.drive_error))


def _fastest(way: float, delay: float, brake: float) -> float:
    """The speed (m/s) from which ``delay`` (s) and braking take ``way`` (m)."""
    return brake * (math.hypot(delay, math.sqrt(2.0 * max(way, 0.0) / brake)) - delay)


def front_of(footprint: Footprint) -> float:
    """Metres from the centre of rotation to the front of the footprint."""
    return footprint.circumscribed if footprint.is_disc else float(footprint.vertices[:, 0].max())


@dataclass(frozen=True)
class Sight:
    """How far ahead of the robot's centre space can be observed free (m), and what limits it.

    ``by_range``, ``by_beams`` and ``by_map`` are the limits of the lidar's range, of the gaps between
    beams, and of the local map. All are 0 where the lidar does not look ahead.
    """

    by_range: float
    by_beams: float
    by_map: float

    @property
    def ahead(self) -> float:
        """The smallest of the limits."""
        return min(self.by_range, self.by_beams, self.by_map)


def sight_of(robot: Robot, config: NavigatorConfig) -> Sight:
    """What the robot's lidar can show free straight ahead."""
    lidar = robot.lidar
    if not looks_towards(lidar, 0.0):
        return Sight(0.0, 0.0, 0.0)
    step, own = lidar.increment, fitted(config, robot)
    by_range = lidar.x + lidar.range_max * (1.0 - 0.5 * step) - config.range_error
    by_beams = lidar.x + config.local_map.narrowest / step
    by_map = (0.5 - OFF_CENTRE) * own.local_map.size - 2.0 * own.resolution
    return Sight(max(0.0, by_range), max(0.0, by_beams), by_map)


def looks_towards(lidar: Lidar, angle: float) -> bool:
    """Whether a direction on the robot (rad) is in the lidar's field of view."""
    off = abs(math.remainder(angle - lidar.theta, math.tau))
    return lidar.fov >= math.tau - lidar.increment - 1e-6 or off <= 0.5 * lidar.fov


def room_ahead(robot: Robot, config: NavigatorConfig) -> float:
    """Metres that the footprint with its margin can go ahead in what is seen."""
    sight, lidar, shape = sight_of(robot, config), robot.lidar, robot.footprint
    radius = min(sight.by_range, sight.by_beams) - lidar.x  # of the disc that is seen
    room = min(radius + lidar.x, sight.by_map) - front_of(shape)
    for x, y in shape.vertices:
        room = min(room, lidar.x + math.sqrt(max(0.0, radius**2 - (y - lidar.y) ** 2)) - x)
    return float(room) - margin_of(robot, config) - fitted(config, robot).resolution


def fastest_near_people(robot: Robot, config: NavigatorConfig) -> float:
    """The speed (m/s) from which the robot rests before somebody comes to it from where it sees no more.

    They walk at ``hidden_speed`` as soon as a command is given, and may come nearer by APPROACH.
    """
    limits, walks = robot.limits, config.hidden_speed
    brake = limits.v_brake / (1.0 + config.drive_error)  # as commanded
    way = (
        sight_of(robot, config).ahead - front_of(robot.footprint) + APPROACH - walks * config.period
    )
    delay = config.latency + config.period + walks / brake
    return min(limits.v_max, _fastest(way, delay, brake))


def blind_beyond(robot: Robot) -> float:
    """Metres that the lidar's blind disc (``range_min``) reaches out of the footprint; 0 if it does not."""
    lidar, shape = robot.lidar, robot.footprint
    angles = np.linspace(-0.5, 0.5, RIM_POINTS) * lidar.fov + lidar.theta
    x = lidar.x + lidar.range_min * np.cos(angles)
    y = lidar.y + lidar.range_min * np.sin(angles)
    if shape.is_disc:
        return float(max(0.0, np.hypot(x, y).max() - shape.circumscribed))
    away = shapely.distance(shapely.Polygon(shape.vertices), shapely.points(x, y))
    return float(away.max())
