"""Pedestrians who avoid walls, one another and the robot, simulated by JuPedSim (an extra).

The model is JuPedSim's anticipation velocity model [Xu2021]. The robot is one of its agents and is
moved to its true pose in every step. Pedestrians whom others hold up, as in a door, go back to the
waypoint before after 2 to 4 s, each after another time, since in the model they would stand there for
good. The model keeps pedestrians off walls by a soft force only, so a
pedestrian's position is what the model says, moved to the nearest place where its disc touches no wall.
"""

import importlib.util
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.errors import ScenarioError
from dynastar.extras import how_to_install
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.simulation.contact import occupied_runs
from dynastar.simulation.scenario import Pedestrian

Floats = npt.NDArray[np.float64]

STEP = 0.05  # s, one step of the pedestrian model
WALL_GAP = 0.01  # m kept between a pedestrian's disc and a wall
NEAR_WAYPOINT = 1.0  # m from a waypoint at which it counts as reached: a robot may stand there
STUCK = 0.15  # m within which a pedestrian has not got on
SEAM = 1e-3  # m by which the walkable area is shrunk, so that its outline is simple
ROBOT_MARGIN = 0.1  # m that pedestrians keep from a robot beyond what they keep from each other
THIN = 0.01  # m, the radius with which the robot's agent comes in, so that nobody refuses it
MOST_LAG = 0.02  # m between the robot's agent and where it was told to go
ROBOT_TIME_GAP = 0.01  # s, so small that other agents do not hold the robot's agent back


def jupedsim_installed() -> bool:
    """Whether JuPedSim can be imported."""
    return importlib.util.find_spec("jupedsim") is not None


def walkable_area(grid: OccupancyGrid, obstacles: Sequence[Floats]) -> shapely.Geometry:
    """All of the map that is neither occupied nor covered by polygons (k, 2), in metres."""
    runs = occupied_runs(grid)
    cells = np.vstack([runs, [[0, 0, grid.rows, grid.columns]]])
    corners = cells[:, [[0, 1], [0, 3], [2, 3], [2, 1]]]
    boxes = shapely.polygons(grid.frame.points_to_world(corners).reshape(corners.shape))
    solid = shapely.union_all([*boxes[:-1], *(shapely.Polygon(ring) for ring in obstacles)])
    area = shapely.difference(boxes[-1], solid).simplify(1e-6)
    return area.buffer(-SEAM, join_style="mitre")


class Crowd:
    """Pedestrians in a true world, stepped beside the robot; the same seed gives the same steps.

    Raises ScenarioError without JuPedSim, and for pedestrians who start or walk in a wall, off the
    map or in each other.
    """

    def __init__(
        self,
        pedestrians: Sequence[Pedestrian],
        grid: OccupancyGrid,
        obstacles: Sequence[Floats],
        footprint: Footprint,
        seed: int = 0,
    ) -> None:
        if not jupedsim_installed():
            raise ScenarioError(
                f"pedestrians who react need JuPedSim: {how_to_install('pedestrians')}"
            )
        self.radii = np.array([pedestrian.radius for pedestrian in pedestrians])
        self._area = _part_with(pedestrians, walkable_area(grid, obstacles))
        self._clear = [self._area.buffer(-(radius + WALL_GAP)) for radius in self.radii]
        for shape in (self._area, *self._clear):
            shapely.prepare(shape)
        try:
            self._start(pedestrians, footprint.circumscribed + ROBOT_MARGIN, seed)
        except RuntimeError as error:
            raise ScenarioError(f"the pedestrians cannot start: {error}") from error
        self._steps = 0
        self._before = self._after = self._positions()
        self._stood, self._since = self._after.copy(), np.zeros(len(self.radii), np.int64)

    def at(self, time: float) -> Floats:
        """Centres (m, 2) in metres at ``time`` (s), which lies in the step advanced to last."""
        begun = STEP * (self._steps - 1)
        fraction = min(max((time - begun) / STEP, 0.0), 1.0)
        return self._before + fraction * (self._after - self._before)

    def advance(self, time: float, pose: Pose2D) -> None:
        """Takes the steps that begin up to ``time`` (s), with the robot at ``pose``."""
        while self._steps * STEP <= time + 1e-9:
            self._move_robot(pose)
            self._simulation.iterate()
            self._turn_back(self._after)
            self._before, self._after = self._after, self._positions()
            self._steps += 1

    def _start(self, pedestrians: Sequence[Pedestrian], robot_radius: float, seed: int) -> None:
        import jupedsim

        model = jupedsim.AnticipationVelocityModel(rng_seed=seed)
        self._simulation: Any = jupedsim.Simulation(model=model, geometry=self._area, dt=STEP)
        self._walkers: list[int] = []
        self._journeys: list[tuple[int, list[int]]] = []
        for pedestrian in pedestrians:
            stages = [
                self._simulation.add_waypoint_stage((float(x), float(y)), NEAR_WAYPOINT)
                for x, y in pedestrian.waypoints
            ]
            journey = jupedsim.JourneyDescription(stages)
            for here, onward in zip(stages, [*stages[1:], stages[0]], strict=True):
                towards = jupedsim.Transition.create_fixed_transition(onward)
                journey.set_transition_for_stage(here, towards)
            self._journeys.append((self._simulation.add_journey(journey), stages))
            parameters = jupedsim.AnticipationVelocityModelAgentParameters(
                position=pedestrian.start,
                desired_speed=pedestrian.speed,
                radius=pedestrian.radius,
                journey_id=self._journeys[-1][0],
                stage_id=stages[0],
            )
            self._walkers.append(self._simulation.add_agent(parameters))
        self._steering = self._simulation.add_direct_steering_stage()
        self._driving = self._simulation.add_journey(jupedsim.JourneyDescription([self._steering]))
        self._robot: int | None = None
        self._robot_at = (math.nan, math.nan)  # where its agent was told to go
        self._robot_radius = robot_radius

    def _add_robot(self, x: float, y: float) -> None:
        import jupedsim

        parameters = jupedsim.AnticipationVelocityModelAgentParameters(
            position=(x, y),
            desired_speed=0.0,
            radius=THIN,
            journey_id=self._driving,
            stage_id=self._steering,
            time_gap=0.1,
            reaction_time=STEP,
            strength_neighbor_repulsion=0.0,
            wall_buffer_distance=0.0,
        )
        try:
            self._robot = self._simulation.add_agent(parameters)
        except RuntimeError:  # it overlaps a pedestrian: try again in the next step
            return
        model = self._simulation.agent(self._robot).model
        model.time_gap, model.radius = ROBOT_TIME_GAP, self._robot_radius
        self._robot_at = x, y

    def _move_robot(self, pose: Pose2D) -> None:
        """Lets the robot's agent walk to ``pose`` within one step.

        An agent that others held back is taken out, and put where the robot is in the next step.
        """
        if not self._area.contains(shapely.Point(pose.x, pose.y)):
            return
        if self._robot is None:
            self._add_robot(pose.x, pose.y)
            return
        agent = self._simulation.agent(self._robot)
        x, y = agent.position
        if math.dist((x, y), self._robot_at) > MOST_LAG:
            self._simulation.mark_agent_for_removal(self._robot)
            self._robot = None
            return
        self._robot_at = pose.x, pose.y
        agent.target = self._robot_at
        agent.model.desired_speed = math.hypot(pose.x - x, pose.y - y) / STEP

    def _turn_back(self, positions: Floats) -> None:
        """Sends pedestrians who have not got on for their patience to the waypoint before."""
        got_on = np.hypot(*(positions - self._stood).T) > STUCK
        self._stood[got_on], self._since[got_on] = positions[got_on], self._steps
        for i in np.flatnonzero(
            (self._steps - self._since) * STEP >= 2.0 + np.arange(len(positions)) % 3
        ):
            walker, (journey, stages) = self._walkers[i], self._journeys[i]
            before = stages[stages.index(self._simulation.agent(walker).stage_id) - 1]
            self._simulation.switch_agent_journey(walker, journey, before)
            self._since[i] = self._steps

    def _positions(self) -> Floats:
        found = np.array([self._simulation.agent(walker).position for walker in self._walkers])
        inside = shapely.contains_xy(self._clear, found[:, 0], found[:, 1])
        for i in np.flatnonzero(~inside):
            line = shapely.shortest_line(self._clear[i], shapely.Point(found[i]))
            found[i] = shapely.get_coordinates(line)[0]
        return found


def _part_with(pedestrians: Sequence[Pedestrian], area: shapely.Geometry) -> shapely.Geometry:
    """The connected part of the area in which the first pedestrian starts, checked for the others."""
    parts = [p for p in shapely.get_parts(area) if p.contains(shapely.Point(pedestrians[0].start))]
    if not parts:
        raise ScenarioError(f"pedestrian 0 starts in a wall or off the map: {pedestrians[0].start}")
    for number, pedestrian in enumerate(pedestrians):
        if not (pedestrian.radius > 0.0 and pedestrian.speed > 0.0):
            raise ScenarioError(
                f"pedestrian {number} has radius {pedestrian.radius} m and speed "
                f"{pedestrian.speed} m/s: expected more than 0"
            )
        clear = parts[0].buffer(-pedestrian.radius)
        for x, y in (pedestrian.start, *pedestrian.waypoints):
            if not clear.contains(shapely.Point(x, y)):
                raise ScenarioError(
                    f"pedestrian {number} has no room at ({x:.2f}, {y:.2f}): expected a place "
                    f"{pedestrian.radius:g} m from walls that the others can reach, too"
                )
    return parts[0]
