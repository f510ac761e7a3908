"""dynastar in ir-sim (extra ``irsim``): a behaviour of robots with differential drive, and its parts.

Once this module is imported, a robot of a world file may have it::

    behavior: {name: dynastar, settings: {dwa: {horizon: 3.0}}}

The robot needs a ``lidar2d``. ``Driver`` is the same for a loop of one's own.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from irsim.lib import register_behavior_class

from dynastar.errors import InputError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, RobotState, configured
from dynastar.robot import Lidar, Limits, Robot
from dynastar.scan import LaserScan

Settings = Mapping[str, Any] | None

RESOLUTION, MOST_ACCEL = 0.05, 100.0  # m of a map's cell; m/s2 and rad/s2 where there is no limit
DEVIATIONS = 3.0  # standard deviations that the largest error of a range is taken for


def robot_of(thing: Any) -> Robot:
    """The Robot of an ir-sim robot: limits, footprint and lidar."""
    if thing.kinematics != "diff" or thing.lidar is None:
        raise InputError(f"{thing.name}: expected kinematics 'diff' and a sensor 'lidar2d'")
    (v_min, v_max), (turn_min, turn_max) = np.hstack([thing.vel_min, thing.vel_max]).tolist()
    accel, turn = np.minimum(thing.info.acce[:, 0], MOST_ACCEL).tolist()
    limits = Limits(v_max, min(-turn_min, turn_max), accel, turn, accel, turn, min(v_min, 0.0))
    is_disc, corners = thing.shape == "circle", thing.original_vertices
    footprint = Footprint.disc(thing.radius) if is_disc else Footprint.polygon(corners.T)
    sensor, scan = thing.lidar, scan_of(thing, 0.0)
    ranges, mount = (scan.range_min, scan.range_max), sensor.offset.ravel().tolist()
    lidar = Lidar(len(scan.ranges), min(sensor.angle_range, math.tau), *ranges, *mount)
    return Robot(thing.name, limits, footprint, lidar)


def scan_of(thing: Any, stamp: float) -> LaserScan:
    """The present scan: +inf for no return, NaN for one below range_min, no beam twice."""
    lidar, scan = thing.lidar, thing.get_lidar_scan()
    ranges = np.array(scan["ranges"], dtype=np.float32)
    nothing = np.where(ranges >= np.float32(scan["range_max"]), np.inf, np.nan)
    ranges = np.where(scan["valid"], ranges, nothing)
    if lidar.angle_range > math.tau - 1e-6:  # the last beam points where the first does
        ranges = ranges[:-1]
    low, step, least = scan["angle_min"], scan["angle_increment"], scan["range_min"]
    mount = Pose2D(*lidar.offset.ravel().tolist())
    return LaserScan(stamp, ranges, low, step, least, scan["range_max"], mount)


def state_of(thing: Any, stamp: float) -> RobotState:
    """The true pose and speeds of an ir-sim robot with differential drive."""
    pose, twist = map(float, thing.state[:3, 0]), map(float, thing.velocity[:2, 0])
    return RobotState(stamp, Pose2D(*pose), Twist(*twist))


def map_of(env: Any) -> OccupancyGrid:
    """The world's grid map, if it has one, else its rectangle; objects are left to the lidar."""
    world = env.get_map()
    if world.grid is not None and np.isclose(*world.grid_resolution):  # [x, y], in per cent
        occupied, resolution = world.grid.T > 50, world.grid_resolution[0]
    else:
        shape = (math.ceil(side / RESOLUTION) for side in (world.height, world.width))
        occupied, resolution = np.zeros(tuple(shape), dtype=bool), RESOLUTION
    return OccupancyGrid.from_occupied(occupied, resolution, *world.world_offset)


class Driver:
    """Drives one robot of an ir-sim world to its present goal; see ``navigator`` for its status.

    ``grid`` is the known map (default ``map_of(env)``), ``settings`` are nested tables.
    """

    def __init__(
        self, env: Any, thing: Any, grid: OccupancyGrid | None = None, settings: Settings = None
    ) -> None:
        robot = robot_of(thing)
        own = {"period": env.step_time, "goal_tolerance": thing.info.goal_threshold}
        own["range_error"] = DEVIATIONS * thing.lidar.std if thing.lidar.noise else 0.01
        config = configured("default", {**own, **(settings or {})})
        self.navigator = Navigator(grid or map_of(env), robot, config)
        self._env, self._thing = env, thing
        self._goal: tuple[float, ...] | None = None

    def command(self) -> Twist:
        """The command of the next step; zero without a goal."""
        thing, now = self._thing, float(self._env.time)
        heading = 3 if thing.arrive_mode == "state" else 2
        goal = None if thing.goal is None else tuple(thing.goal[:heading, 0].tolist())
        if goal != self._goal:
            self._goal = goal
            self.navigator.set_goal([] if goal is None else Goal(*goal))
        return self.navigator.command(state_of(thing, now), scan_of(thing, now))


@register_behavior_class("diff", "dynastar")
class DynastarBehavior:
    """The behaviour ``dynastar``; it begins anew after ``env.reset()``."""

    def __init__(self, info: Any, settings: Settings = None, **more: Any) -> None:
        self.driver: Driver | None = None
        self._settings, self._last = settings, 0.0

    def __call__(self, ego_object: Any, **more: Any) -> npt.NDArray[np.float64]:
        """Velocity (2, 1) of the next step."""
        env = ego_object._env  # ir-sim tells a behaviour no time, and nothing of its world
        if self.driver is None or env.time < self._last:
            self.driver = Driver(env, ego_object, settings=self._settings)
        self._last = env.time
        return np.array([self.driver.command()], dtype=np.float64).T
