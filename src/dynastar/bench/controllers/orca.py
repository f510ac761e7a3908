"""ORCA [vandenBerg2011] for a differential drive on a replanned path; it stands on pyrvo (an extra)."""

import math
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt
import pyrvo

from dynastar.bench.controllers.base import REST, PathController
from dynastar.bench.controllers.costmap import REACH, Surroundings
from dynastar.geometry import Pose2D, Twist, compose, wrap_angle
from dynastar.grid import OccupancyGrid
from dynastar.navigator import RobotState
from dynastar.perception import MovingObstacle, PlanningMap, Tracker
from dynastar.perception.placed_scan import placed
from dynastar.robot import Robot, arc
from dynastar.scan import LaserScan

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Cell = tuple[int, int]


class Settings(NamedTuple):
    """The settings of the controller."""

    lookahead: float = 0.6  # m ahead on the path, where the preferred velocity points
    step: float = 0.25  # s within which an overlap is to end, as in the suite crowdnav
    horizon: float = 3.0  # s of looking ahead to people
    static_horizon: float = 1.0  # s of looking ahead to static obstacles
    people_margin: float = 0.1  # m beside people, for what a turn leaves of the velocity asked for
    static_margin: float = 0.05  # m beside static obstacles
    around: float = 10.0  # m within which people count
    rounds: int = 4  # in which ORCA is solved, each from the velocity of the one before
    cleared: float = 0.15  # m round a person, within which blocked cells belong to the person
    braking: float = 0.7  # fraction of the robot's braking that it counts on
    least: float = 0.02  # m/s, below which it stands
    rotate_from: float = 0.785  # rad off the velocity, from which it turns on the spot


class Orca(PathController):
    """Drives towards the velocity that is nearest to the preferred one and free by ORCA.

    The preferred velocity points to a place ahead on the path of ``PathController``, at full speed,
    slower near the goal. People are the moving obstacles that the project's tracker finds in the
    scans. Static obstacles are the outlines of the costmap's other blocked cells, and the path is
    planned without people, too. Where there is no path, the preferred velocity is 0. The robot turns
    to the velocity, drives at the part of it that lies ahead, and no faster than it can stop for
    static obstacles on that arc. Far off the velocity it turns on the spot.

    In print everybody does half of the avoiding. People of the suites do not do theirs, so ORCA is
    solved again from its own result: after ``rounds`` the robot does nearly all. Of four variants
    two were run on all 110 development missions (seeds 2000 to 2039 of ``crowdnav``, 40 of ``people``
    with seed 1, 30 of ``dynabarn``): four rounds, 3 s and both margins 0.1 m succeeded in 65, one
    round, 5 s and 0.05 m in 59, which may be chance. The other two were run on ``crowdnav`` alone. The
    static margin of 0.05 m and the pose ahead by the latency came later, without such a comparison;
    the latter after contacts in the quick worlds of ``barn``.
    """

    settings = Settings()

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: Any) -> None:
        self.tracker = Tracker(config.tracker)
        super().__init__(grid, robot, config)

    def set_map(self, grid: OccupancyGrid) -> None:
        """Another map; what was seen is forgotten."""
        super().set_map(grid)
        self.tracker.forget()
        mapped = PlanningMap(grid, self.config.resolution, self.config.unknown)
        self._known = mapped.known._replace(frame=mapped.grid.frame)

    def see(self, pose: Pose2D, scan: LaserScan) -> None:
        """Takes in a scan from the robot at ``pose``."""
        super().see(pose, scan)
        errors = self.config.range_error, self.config.heading_error
        sensor = compose(pose, scan.mount)
        view = placed(scan, sensor, errors, self.config.local_map.narrowest)
        _, left = self.tracker.update(view, self._known)
        before = [MovingObstacle(x, y, 0.0, 0.0, radius) for x, y, radius in left]
        blocked, corner = self._static(pose, REACH, self._people(scan.stamp) + before)
        self.route.mark((*corner, blocked))
        self.costmap.keep(corner, blocked)  # hidden behind them, their trace would stay

    def without_path(self, state: RobotState) -> Twist:
        """The twist out of people's way."""
        return self.follow(state) or REST

    def follow(self, state: RobotState) -> Twist | None:
        """The twist towards ORCA's velocity; None where it is to stand."""
        options, limits, latency = self.settings, self.robot.limits, self.config.latency
        pose = arc(state.pose, state.twist, latency)  # where the command acts
        state = state._replace(stamp=state.stamp + latency, pose=pose)
        people = self._people(state.stamp)
        reach = limits.v_max * options.static_horizon + self.robot.footprint.circumscribed + 0.3
        blocked, corner = self._static(pose, reach, people)
        vx, vy = self._velocity(state, people, self._outlines(blocked, corner))
        speed = math.hypot(vx, vy)
        if speed < options.least:
            return None
        around = Surroundings(self.costmap.grid, blocked, corner)
        off = wrap_angle(math.atan2(vy, vx) - pose.theta)
        if abs(off) > options.rotate_from:
            return self.turned(pose, off, around)
        v = speed * math.cos(off)
        curvature = self.turning(off) / v
        late = max(state.twist.v, 0.0) * self.config.period
        room = self.free_length(pose, curvature, reach, around) - late - 0.02
        if room <= 0.0:
            return self.turned(pose, off, around)
        v = min(v, math.sqrt(2.0 * options.braking * limits.v_brake * room))
        return Twist(v, v * curvature)

    def _people(self, now: float) -> list[MovingObstacle]:
        """The tracks that move or have moved, as of ``now``."""
        dt = now - self._scan_stamp
        return [
            MovingObstacle(t.x + t.vx * dt, t.y + t.vy * dt, t.vx, t.vy, t.radius)
            for t in self.tracker.tracks
            if t.state != "tentative"
        ]

    def _static(
        self, pose: Pose2D, reach: float, people: list[MovingObstacle]
    ) -> tuple[Mask, Cell]:
        """The blocked cells near ``pose``, people off the map left out, and the first of them."""
        window, (top, left) = self.costmap.window(pose, reach)
        blocked = window.astype(np.uint8)
        for person in people:
            row, column = self.costmap.grid.frame.to_grid(person.x, person.y)
            radius = (person.radius + self.settings.cleared) / self.costmap.resolution
            cv2.circle(blocked, (int(column) - left, int(row) - top), int(radius), 0, -1)
        rows, columns = blocked.shape
        mapped = self.costmap.mapped[top : top + rows, left : left + columns]
        return blocked.view(bool) | mapped, (top, left)

    def _outlines(self, blocked: Mask, corner: Cell) -> list[Floats]:
        """The outlines (k, 2) of blocked cells, metres; what is blocked lies to their left."""
        # Drawn on half cells, the outline of a single cell or of a thin wall encloses an area.
        halves = blocked.repeat(2, 0).repeat(2, 1).view(np.uint8)
        found, _ = cv2.findContours(halves, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
        # The library's time grows with the cube of the vertices.
        simple = [cv2.approxPolyDP(one, 1.5, True) if len(one) > 8 else one for one in found]
        frame, first = self.costmap.grid.frame, np.array(corner)
        return [frame.points_to_world(first + 0.25 + 0.5 * one[::-1, 0, ::-1]) for one in simple]

    def _velocity(
        self, state: RobotState, people: list[MovingObstacle], outlines: list[Floats]
    ) -> tuple[float, float]:
        """The robot's velocity (m/s) by ORCA."""
        options, pose, shape = self.settings, state.pose, self.robot.footprint
        radius = shape.inscribed + options.static_margin
        wider = shape.circumscribed + options.people_margin - radius  # the robot is, towards people
        fastest = self.robot.limits.v_max
        look = (options.around, len(people), options.horizon, options.static_horizon)
        simulator = pyrvo.RVOSimulator(options.step, *look, radius, fastest)
        simulator.add_agent(pose[:2])
        simulator.set_agent_pref_velocity(0, self._preferred(pose))
        for person in people:
            simulator.add_agent((person.x, person.y), *look, person.radius + wider, 0.0)
        for outline in outlines:
            simulator.add_obstacle(outline.tolist())
        simulator.process_obstacles()
        v = state.twist.v
        velocity: tuple[float, float] = (v * math.cos(pose.theta), v * math.sin(pose.theta))
        for _ in range(options.rounds):
            simulator.set_agent_position(0, pose[:2])
            simulator.set_agent_velocity(0, velocity)
            for number, person in enumerate(people, 1):
                simulator.set_agent_position(number, (person.x, person.y))
                simulator.set_agent_velocity(number, (person.vx, person.vy))
            simulator.do_step()
            velocity = simulator.get_agent_velocity(0).to_tuple()
        return velocity

    def _preferred(self, pose: Pose2D) -> tuple[float, float]:
        """The velocity (m/s) to a place ahead on the path, slow enough to stop at its end."""
        path, limits, options = self.route.path, self.robot.limits, self.settings
        if path is None:
            return 0.0, 0.0
        left = path.length - self.route.s
        stopping = math.sqrt(2.0 * options.braking * limits.v_brake * left)
        speed = min(max(stopping, 0.05), limits.v_max)
        x, y = path.at(self.route.s + options.lookahead)
        part = speed / max(math.dist(pose[:2], (x, y)), 1e-6)
        return part * (x - pose.x), part * (y - pose.y)
