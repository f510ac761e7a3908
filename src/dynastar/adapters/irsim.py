"""dynastar in ir-sim (extra ``irsim``): a behaviour of robots with differential drive, and its parts.

Once this module is imported, a robot of a world file may have it::

    behavior: {name: dynastar, settings: {dwa: {horizon: 3.0}}}

The robot needs a goal and a ``lidar2d``. ``Driver`` is the same for a loop of one's own.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from irsim.lib import register_behavior_class

from dynastar.errors import InputError
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, RobotState, configured
from dynastar.robot import Footprint, Lidar, Limits, Robot
from dynastar.scan import LaserScan

RESOLUTION = 0.05  # m, of the map of an ir-sim world
MOST_ACCEL, MOST_OMEGA_ACCEL = 100.0, 200.0  # m/s2 and rad/s2 where ir-sim has no limit
DEVIATIONS = 3.0  # standard deviations that the largest error of a range is taken for


def robot_of(thing: Any) -> Robot:
    """The Robot of an ir-sim robot: limits, footprint and lidar."""
    if thing.kinematics != "diff" or thing.lidar is None:
        raise InputError(f"{thing.name}: expected kinematics 'diff' and a sensor 'lidar2d'")
    v_min, v_max = float(thing.vel_min[0, 0]), float(thing.vel_max[0, 0])
    omega_max = min(-float(thing.vel_min[1, 0]), float(thing.vel_max[1, 0]))
    accel = min(float(thing.info.acce[0, 0]), MOST_ACCEL)
    turn = min(float(thing.info.acce[1, 0]), MOST_OMEGA_ACCEL)
    circle = thing.shape == "circle"
    footprint = (
        Footprint.disc(thing.radius) if circle else Footprint.polygon(thing.original_vertices.T)
    )
    lidar = thing.lidar
    beams = lidar.number - _closed(lidar)
    fov, mount = min(lidar.angle_range, math.tau), map(float, lidar.offset.ravel())
    return Robot(
        thing.name,
        Limits(v_max, omega_max, accel, turn, accel, turn, v_min=min(v_min, 0.0)),
        footprint,
        Lidar(beams, fov, float(lidar.range_min), float(lidar.range_max), *mount),
    )


def _closed(lidar: Any) -> int:
    """1 if the last beam points where the first does, as on a full circle; else 0."""
    return int(lidar.number > 1 and lidar.angle_range > math.tau - 1e-6)


def scan_of(thing: Any, stamp: float) -> LaserScan:
    """The present scan: +inf for no return, NaN for one below range_min, no beam twice."""
    lidar, scan = thing.lidar, thing.get_lidar_scan()
    ranges = np.array(scan["ranges"], dtype=np.float64)
    nothing = np.where(ranges >= scan["range_max"], math.inf, math.nan)
    ranges = np.where(scan["valid"], ranges, nothing)[: lidar.number - _closed(lidar)]
    mount = Pose2D(*map(float, lidar.offset.ravel()))
    low, step = scan["angle_min"], scan["angle_increment"]
    return LaserScan(
        stamp, ranges.astype(np.float32), low, step, scan["range_min"], scan["range_max"], mount
    )


def state_of(thing: Any, stamp: float) -> RobotState:
    """The true pose and speeds of an ir-sim robot with differential drive."""
    pose, twist = map(float, thing.state[:3, 0]), map(float, thing.velocity[:2, 0])
    return RobotState(stamp, Pose2D(*pose), Twist(*twist))


def map_of(env: Any) -> OccupancyGrid:
    """The world's rectangle; what its grid map has is occupied, objects are left to the lidar."""
    world = env.get_map()
    shape = [max(1, round(side / RESOLUTION)) for side in (world.height, world.width)]
    occupied = np.zeros(shape, dtype=bool)
    if world.grid is not None:  # [x, y], in per cent
        rows, columns = (np.arange(n) * size // n for n, size in zip(shape, world.grid.shape[::-1]))
        occupied = world.grid.T[np.ix_(rows, columns)] > 50
    return OccupancyGrid.from_occupied(occupied, RESOLUTION, *world.world_offset)


class Driver:
    """Drives one robot of an ir-sim world to its goal, whatever goal it has by then.

    ``grid`` is the known map (default ``map_of(env)``), ``settings`` are the navigator's, as nested
    tables. ``navigator`` is there for its status.
    """

    def __init__(
        self,
        env: Any,
        thing: Any,
        grid: OccupancyGrid | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        lidar = thing.lidar
        error = DEVIATIONS * lidar.std if lidar is not None and lidar.noise else 0.01
        own = {"period": env.step_time, "range_error": error}
        own["goal_tolerance"] = thing.info.goal_threshold
        self.navigator = Navigator(
            grid or map_of(env), robot_of(thing), configured("default", own | dict(settings or {}))
        )
        self._env, self._thing, self._goal = env, thing, None

    def command(self) -> Twist:
        """The command of the next step; zero without a goal."""
        thing, now = self._thing, float(self._env.time)
        heading = 3 if thing.arrive_mode == "state" else 2
        goal = None if thing.goal is None else tuple(map(float, thing.goal[:heading, 0]))
        if goal != self._goal:
            self._goal = goal
            self.navigator.set_goal([] if goal is None else Goal(*goal))
        return self.navigator.command(state_of(thing, now), scan_of(thing, now))


@register_behavior_class("diff", "dynastar")
class DynastarBehavior:
    """The behaviour ``dynastar``; it begins anew after ``env.reset()``."""

    def __init__(self, info: Any, settings: Mapping[str, Any] | None = None, **more: Any) -> None:
        self.driver: Driver | None = None
        self._settings, self._last = settings, 0.0

    def __call__(self, ego_object: Any, **more: Any) -> npt.NDArray[np.float64]:
        env = ego_object._env  # ir-sim tells a behaviour no time, and nothing of its world
        if self.driver is None or env.time < self._last:
            self.driver = Driver(env, ego_object, settings=self._settings)
        self._last = env.time
        return np.array(self.driver.command(), dtype=np.float64).reshape(2, 1)
