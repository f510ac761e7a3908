"""kompass-core's dynamic window as local planner on the path of the other controllers."""

import math
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench.controllers.base import PathController
from dynastar.geometry import Twist, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator import RobotState
from dynastar.robot import Robot

Floats = npt.NDArray[np.float64]

HEIGHT = 0.1  # m, of the obstacles' points; the robot's body is taller
LEAST_STEP = 0.06  # m/s of a step from rest, from which on the library finds samples


class Settings(NamedTuple):
    """Settings of kompass-core; weights, samples, prediction and lookahead are its defaults."""

    horizon: float = 1.0  # s of prediction
    step: float = 0.1  # s between the points of a prediction
    samples: int = 20  # along each axis of the window
    lookahead: float = 1.0  # m
    spacing: float = 0.1  # m between the path's points; its default of 1 cm costs time only
    octree: float = 0.05  # m, its default is 0.1
    rotate_from: float = 0.785  # rad off the path, from which the robot first turns on the spot


class KompassDwa(PathController):
    """kompass-core's DWA follows the replanned path; obstacles are the costmap's cells, as points.

    It takes the robot's limits and footprint (a cylinder or a box). Around it, as for pure pursuit,
    are the costmap and path of ``PathController``, its recoveries, and turning on the spot towards a
    path that leads elsewhere, which the library leaves to others. Everything counts as static.

    Found in trials on 50 BARN worlds: points of the costmap are better than the scan alone (49 for
    45 arrivals: a 270 degree lidar forgets what is behind); a horizon of 2 s, three times the
    obstacles' weight, and half the samples change nothing that is clear of chance, there, on 20
    DynaBARN missions or on 10 of the crowd's.
    """

    settings = Settings()

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: Any) -> None:
        super().__init__(grid, robot, config)
        self._dwa, self._models = _planner(robot, self.settings)
        self._plan_id = 0

    def follow(self, state: RobotState) -> Twist | None:
        """The first twist of the best sample; None where no sample is free."""
        path, options, pose = self.route.path, self.settings, state.pose
        assert path is not None
        if self._plan_id != self.status.plan_id:
            self._plan_id = self.status.plan_id
            self._dwa.set_path(
                _path_message(path.resampled(self.route.s, path.length, options.spacing))
            )
        x, y = path.at(self.route.s + 0.5)
        off = wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.theta)
        if abs(off) > options.rotate_from:
            around = self.costmap.surroundings(pose, 1.0 + self.robot.footprint.circumscribed)
            return self.turned(pose, off, around)
        v, omega = state.twist
        now = self._models.RobotState(
            x=pose.x, y=pose.y, yaw=pose.theta, speed=v, vx=v, omega=omega
        )
        found = self._dwa.loop_step(current_state=now, points=self._points(state))
        if not found:
            return None
        return Twist(float(self._dwa.linear_x_control[0]), float(self._dwa.angular_control[0]))

    def _points(self, state: RobotState) -> npt.NDArray[np.float32]:
        """The blocked cells near the robot as points (n, 3) of the map frame."""
        costmap, frame = self.costmap, self.costmap.grid.frame
        reach = 1.0 + self.robot.limits.v_max * self.settings.horizon
        row, column = frame.to_grid(*state.pose[:2])
        half = reach / costmap.resolution
        top, left = max(int(row - half), 0), max(int(column - half), 0)
        part = costmap.blocked[top : int(row + half) + 1, left : int(column + half) + 1]
        cells = np.argwhere(part) + (top + 0.5, left + 0.5)
        points = np.zeros((len(cells), 3), np.float32)
        points[:, :2] = frame.points_to_world(cells)
        points[:, 2] = HEIGHT
        return points


def _path_message(points: Floats) -> Any:
    """A path as the library reads it, in the manner of nav_msgs/Path."""
    places = [SimpleNamespace(x=float(x), y=float(y)) for x, y in points]
    poses = [SimpleNamespace(pose=SimpleNamespace(position=place)) for place in places]
    return SimpleNamespace(poses=poses)


def _planner(robot: Robot, options: Settings) -> tuple[Any, Any]:
    """kompass-core's planner for a robot, and its module of models."""
    import kompass_cpp
    from kompass_core import models
    from kompass_core.control import DWA, DWAConfig

    kompass_cpp.set_log_level(kompass_cpp.LogLevel.ERROR)
    limits, shape = robot.limits, robot.footprint
    if shape.is_disc:
        kind, size = models.RobotGeometry.Type.CYLINDER, [shape.circumscribed, 0.5]
    else:
        length, width = np.ptp(shape.vertices, axis=0)
        kind, size = models.RobotGeometry.Type.BOX, [length, width, 0.5]
    body = models.Robot(
        robot_type=models.RobotType.DIFFERENTIAL_DRIVE,
        geometry_type=kind,
        geometry_params=np.array(size),
    )
    # It samples nothing that one step from rest does not reach; ``_ramped`` keeps to the robot's own.
    accel = max(limits.v_accel, LEAST_STEP / options.step)
    linear = models.LinearCtrlLimits(limits.v_max, accel, limits.v_brake)
    angular = models.AngularCtrlLimits(
        math.pi, limits.omega_max, limits.omega_accel, limits.omega_brake
    )
    dwa = DWA(
        robot=body,
        ctrl_limits=models.RobotCtrlLimits(vx_limits=linear, omega_limits=angular),
        config=DWAConfig(
            control_time_step=options.step,
            prediction_horizon=round(options.horizon / options.step),
            control_horizon=1,
            max_linear_samples=options.samples,
            max_angular_samples=options.samples,
            octree_resolution=options.octree,
            max_num_threads=1,
            allow_reverse=False,
            lookahead_distance=options.lookahead,
            max_point_interpolation_distance=options.spacing,
            goal_dist_tolerance=0.05,
        ),
    )
    return dwa, models
