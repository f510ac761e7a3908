"""The paper's hybrid controller, as printed and nothing else: to read beside sections IV and V.

The symbols are the paper's. Speeds ``v`` (m/s) and ``omega`` (rad/s) are arrays (n,), one element for
each sample of the window; trajectories are arrays (n, k) of k steps of ``dt`` seconds. The robot is
the disc around its footprint; obstacles are the map and what the scans show. docs/paper.md, "What the
paper leaves open", lists how the text is read where it leaves a choice.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench.controllers.base import PathController
from dynastar.bench.controllers.costmap import PADDING, Costmap, Surroundings
from dynastar.bench.controllers.route import PlannedPath
from dynastar.config import Field, self_checking
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.navigator import RobotState
from dynastar.path import Path
from dynastar.planning import PlannerConfig
from dynastar.robot import Limits, Robot

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SPACING = 0.1  # m between the points of the global path that are looked at


@self_checking
class Settings(NamedTuple):
    """The numbers of section V and Table II, and those that the paper does not print."""

    alpha: Annotated[float, Field("weight of heading", "", 0.0, 1.0)] = 0.5
    beta: Annotated[float, Field("weight of dist", "", 0.0, 1.0)] = 0.2
    gamma: Annotated[float, Field("weight of vel", "", 0.0, 1.0)] = 0.2
    sigma: Annotated[float, Field("weight of simi", "", 0.0, 1.0)] = 0.1
    v_resolution: Annotated[float, Field("speed resolution", "m/s", 0.001, 1.0)] = 0.01
    omega_resolution: Annotated[
        float, Field("angular velocity resolution", "rad/s", 0.001, 1.0)
    ] = math.radians(1.0)
    v_samples: Annotated[int, Field("speeds in the window, at most", "", 2, 1000)] = 21
    omega_samples: Annotated[int, Field("turning rates in the window, at most", "", 2, 1000)] = 41
    time: Annotated[float, Field("forward simulation time", "s", 0.1, 10.0)] = 3.0
    step: Annotated[float, Field("time step of Eq. 4", "s", 0.01, 1.0)] = 0.1
    stray: Annotated[
        float, Field("distance from the path at which the robot has left it", "m", 0.01, 100.0)
    ] = 1.0
    target: Annotated[
        float,
        Field(
            "distance of the intermediate target; 0: v_max for the simulation time", "m", 0.0, 100.0
        ),
    ] = 0.0
    replan_blocked: Annotated[
        bool, Field("plan anew where something seen blocks the path, too")
    ] = False


# -- IV.A: kinematics ------------------------------------------------------------------------------


class Trajectories(NamedTuple):
    """Poses (n, k) of each sample after each step: x, y (m) and theta (rad)."""

    x: Floats
    y: Floats
    theta: Floats


def trajectories(pose: Pose2D, v: Floats, omega: Floats, dt: float, steps: int) -> Trajectories:
    """Eq. 4: x += v dt cos theta, y += v dt sin theta, theta += omega dt.

    The motion over a step is a straight line along the heading before the step. Speeds are constant;
    the first step starts at ``pose``.
    """
    turn, length = omega[:, None] * dt, v[:, None] * dt
    theta_before = pose.theta + turn * np.arange(steps)
    return Trajectories(
        pose.x + np.cumsum(length * np.cos(theta_before), axis=1),
        pose.y + np.cumsum(length * np.sin(theta_before), axis=1),
        theta_before + turn,
    )


# -- IV.B: the dynamic window ----------------------------------------------------------------------


class Velocities(NamedTuple):
    """A set of velocities: bounds of v (m/s) and of omega (rad/s)."""

    v_min: float
    v_max: float
    omega_min: float
    omega_max: float


def possible(limits: Limits) -> Velocities:
    """Eq. 5: V_m = {v in [v_min, v_max], omega in [omega_min, omega_max]}, with v_min = 0."""
    return Velocities(0.0, limits.v_max, -limits.omega_max, limits.omega_max)


def reachable(v_c: float, omega_c: float, limits: Limits, dt: float) -> Velocities:
    """Eq. 6: V_d = {v in [v_c - v_b dt, v_c + v_a dt], omega likewise}.

    (v_c, omega_c) are the current speeds; a marks the largest acceleration, b the largest deceleration.
    """
    return Velocities(
        v_c - limits.v_brake * dt,
        v_c + limits.v_accel * dt,
        omega_c - limits.omega_brake * dt,
        omega_c + limits.omega_accel * dt,
    )


def multiples(low: float, high: float, step: float, most: int) -> Floats:
    """Multiples of ``step`` from low to high, or of a multiple of it that gives at most ``most``.

    Where there is none in between: the value between low and high that is nearest to 0.
    """
    step *= max(1, math.ceil((high - low) / step / most))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    if last < first:
        return np.array([min(max(0.0, low), high)])
    return step * np.arange(first, last + 1, dtype=np.float64)


def sampled(V_m: Velocities, V_d: Velocities, settings: Settings) -> tuple[Floats, Floats]:
    """Samples v and omega (n,) in both V_m and V_d, at the resolutions of Table II."""
    v = multiples(
        max(V_m.v_min, V_d.v_min),
        min(V_m.v_max, V_d.v_max),
        settings.v_resolution,
        settings.v_samples,
    )
    omega = multiples(
        max(V_m.omega_min, V_d.omega_min),
        min(V_m.omega_max, V_d.omega_max),
        settings.omega_resolution,
        settings.omega_samples,
    )
    return np.repeat(v, len(omega)), np.tile(omega, len(v))


def time_to_contact(clearance: Floats, dt: float) -> Floats:
    """Seconds (n,) until a trajectory's clearance (n, k) falls below 0, at most k dt."""
    touches = np.column_stack([clearance < 0.0, np.ones(len(clearance), np.bool_)])
    return touches.argmax(axis=1) * dt


def admissible(v: Floats, omega: Floats, free: Floats, limits: Limits) -> Mask:
    """Eq. 7: V_a = {v <= sqrt(2 dist(v, omega) v_b), omega <= sqrt(2 dist(v, omega) omega_b)}.

    dist(v, omega) is measured along the trajectory, which is ``free`` for so many seconds (n,): in
    metres for v, in radians for omega.
    """
    omega = np.abs(omega)
    can_stop = v <= np.sqrt(2.0 * (v * free) * limits.v_brake)
    can_stop_turning = omega <= np.sqrt(2.0 * (omega * free) * limits.omega_brake)
    return can_stop & can_stop_turning


# -- IV.B: the evaluation function -----------------------------------------------------------------


class Terms(NamedTuple):
    """The terms of Eq. 9 for each sample (n,)."""

    heading: Floats
    dist: Floats
    vel: Floats
    simi: Floats


def heading(end: Trajectories, target: Floats) -> Floats:
    """heading of Eq. 8: pi - |theta - bearing of the target|, at the end points, in rad."""
    off = end.theta - np.arctan2(target[1] - end.y, target[0] - end.x)
    return math.pi - np.abs((off + math.pi) % math.tau - math.pi)


def dist(clearance: Floats) -> Floats:
    """dist of Eq. 8: the clearance (m) of the end points, 0 in contact."""
    return np.maximum(clearance, 0.0)


def simi(curves: Trajectories, path: Floats, stray: float) -> Floats:
    """simi of Eq. 9: 1 - mean distance of the trajectory from the global path / ``stray``.

    ``path`` is (m, 2); points of the trajectory farther from it than ``stray`` (m) count as that far.
    """
    apart = np.hypot(curves.x[..., None] - path[:, 0], curves.y[..., None] - path[:, 1])
    return 1.0 - np.minimum(apart.min(axis=-1), stray).mean(axis=1) / stray


def normalised(term: Floats) -> Floats:
    """A term divided by its sum over the admissible samples."""
    total = term.sum()
    return term / total if total > 0.0 else term


def evaluated(terms: Terms, settings: Settings) -> Floats:
    """Eq. 9: G = alpha heading + beta dist + gamma vel + sigma simi; without simi it is Eq. 8."""
    return (
        settings.alpha * normalised(terms.heading)
        + settings.beta * normalised(terms.dist)
        + settings.gamma * normalised(terms.vel)
        + settings.sigma * normalised(terms.simi)
    )


# -- V: the hybrid system --------------------------------------------------------------------------


class GlobalPath(PlannedPath):
    """Steps 1 and 4: the path of the improved A* (Eqs. 2 and 3), planned anew after straying."""

    def __init__(self, costmap: Costmap, robot: Robot, settings: Settings) -> None:
        self._radius = robot.footprint.circumscribed + PADDING
        super().__init__(costmap, [self._radius], PlannerConfig(planner="improved"))
        self._settings = settings

    def update(self, here: tuple[float, float], goal: Goal, now: float) -> bool:
        """Plans where there is no path, or the robot is farther than ``stray`` from it.

        With ``replan_blocked`` also where the path is blocked.
        """
        if self.path is not None:
            self.s = self.path.project(*here, low=self.s - 0.5, high=self.s + 2.0)
            strayed = math.dist(here, self.path.at(self.s)) > self._settings.stray
            blocked = self._settings.replan_blocked and self.blocked(self._radius)
            if not (strayed or blocked):
                return False
        self.drop()
        self.plan, self.s = self.planners[0].plan(here, (goal.x, goal.y)), 0.0
        return True


def path_to_target(path: Path, s: float, here: Pose2D, radius: float) -> Floats:
    """Step 2: the path (m, 2) from ``s`` on to the intermediate target, its last point.

    The target is where the path leaves the circle of ``radius`` (m) around the robot, or its end.
    """
    points = path.resampled(s, s + 3.0 * radius, SPACING)
    outside = np.hypot(points[:, 0] - here.x, points[:, 1] - here.y) > radius
    return points[: int(outside.argmax()) + 1] if outside.any() else points


class Printed(PathController):
    """The hybrid path planning system of section V; it gives up after 30 s without progress."""

    settings = Settings()
    stuck_after, retries = 30.0, 0

    def make_route(self) -> GlobalPath:
        """Step 1: the global path."""
        return GlobalPath(self.costmap, self.robot, self.settings)

    def follow(self, state: RobotState) -> Twist | None:
        """Step 3: the admissible velocity with the largest G; None where none is admissible."""
        limits, settings, dt = self.robot.limits, self.settings, self.settings.step
        V_m, V_d = possible(limits), reachable(*state.twist, limits, self.config.period)
        v, omega = sampled(V_m, V_d, settings)
        steps = round(settings.time / dt)
        braking = max(v.max() / limits.v_brake, np.abs(omega).max() / limits.omega_brake)
        looked_at = max(steps, int(0.5 * braking / dt) + 1)  # as far as a stop takes
        curves = trajectories(state.pose, v, omega, dt, looked_at)
        clearance = self._clearance(curves)
        V_a = admissible(v, omega, time_to_contact(clearance, dt), limits)
        if not V_a.any():
            return None
        v, omega = v[V_a], omega[V_a]
        curves = Trajectories(*(part[V_a, :steps] for part in curves))
        end = Trajectories(*(part[:, -1] for part in curves))
        assert self.route.path is not None
        path = path_to_target(
            self.route.path,
            self.route.s,
            state.pose,
            settings.target or limits.v_max * settings.time,
        )
        terms = Terms(
            self.towards(state, end, path),
            dist(clearance[V_a, steps - 1]),
            v,
            simi(curves, path, settings.stray),
        )
        best = evaluated(terms, settings).argmax()
        return Twist(float(v[best]), float(omega[best]))

    def towards(self, state: RobotState, end: Trajectories, path: Floats) -> Floats:
        """heading of Eq. 8, to the target at the end of the path."""
        return heading(end, path[-1])

    def _clearance(self, curves: Trajectories) -> Floats:
        """Metres (n, k) from the robot's disc to the nearest obstacle, below 0 in contact."""
        around = Surroundings(self.costmap.grid, self.costmap.blocked, (0, 0))
        disc = np.array([[0.0, 0.0, self.robot.footprint.circumscribed]])
        poses = np.column_stack([part.ravel() for part in curves])
        return around.gaps(poses, disc).reshape(curves.x.shape)


class PrintedReplanning(Printed):
    """The second reading: it replans for unknown obstacles, too, and its target is 1 m ahead."""

    settings = Settings(target=1.0, replan_blocked=True)
