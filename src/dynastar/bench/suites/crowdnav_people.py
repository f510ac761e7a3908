"""The people of the suite crowdnav, who walk by ORCA [vandenBerg2011].

As in print an agent decides every 0.25 s, knows the others' positions and last velocities, and wants to
go straight to its goal. One step of pyrvo (an extra) for all agents gives what a simulator for each of
them would, since no agent knows where the others want to go.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pyrvo

from dynastar.geometry import Pose2D
from dynastar.perception import MovingObstacle

Floats = npt.NDArray[np.float64]

STEP = 0.25  # s between decisions
RADIUS = 0.3  # m, of people and of the robot
SPEED = 1.0  # m/s
SPACE = 0.01  # m that an agent adds to every radius
CIRCLE = 4.0  # m, radius of the circle
SQUARE = 10.0  # m, side of the square
APART = 0.2  # m between agents at first, and between goals
ENDS = ((0.0, -CIRCLE), (0.0, CIRCLE))  # the robot's start and goal
NEIGHBOURS = (10.0, 10, 5.0, 5.0)  # m, number, and s of looking ahead to agents and obstacles

Point = tuple[float, float]
Random = np.random.RandomState


class Walk(NamedTuple):
    """Start and goal of an agent, m."""

    start: Point
    goal: Point


def draw_walks(seed: int, count: int, square: bool = False) -> list[Walk]:
    """Walks of people as the numpy seed of a published case gives them, in its order of draws."""
    random, agents = Random(seed), [Walk(*ENDS)]
    for _ in range(count):
        agents.append(_across_square(random, agents) if square else _across_circle(random, agents))
    return agents[1:]


def _across_circle(random: Random, agents: Sequence[Walk]) -> Walk:
    """From a place near the circle to the one opposite."""
    while True:
        angle = math.tau * random.random_sample()
        x = CIRCLE * math.cos(angle) + random.random_sample() - 0.5
        y = CIRCLE * math.sin(angle) + random.random_sample() - 0.5
        if _is_clear((x, y), [end for agent in agents for end in agent]):
            return Walk((x, y), (-x, -y))


def _across_square(random: Random, agents: Sequence[Walk]) -> Walk:
    """From one half of the square to the other."""
    side = -0.5 * SQUARE if random.random_sample() > 0.5 else 0.5 * SQUARE
    ends: list[Point] = []
    for x_most, others in (
        (side, [agent.start for agent in agents]),
        (-side, [agent.goal for agent in agents]),
    ):
        while True:
            place = (x_most * random.random_sample(), SQUARE * (random.random_sample() - 0.5))
            if _is_clear(place, others):
                ends.append(place)
                break
    return Walk(*ends)


def _is_clear(place: Point, others: Sequence[Point]) -> bool:
    return all(math.dist(place, other) >= 2.0 * RADIUS + APART for other in others)


def next_velocities(positions: Floats, velocities: Floats, goals: Floats) -> Floats:
    """Velocities (n, 2) of n agents for the next step, each of whom avoids all others."""
    simulator = pyrvo.RVOSimulator(STEP, *NEIGHBOURS, RADIUS + SPACE, SPEED)
    ahead = goals - positions
    wanted = ahead / np.maximum(np.hypot(*ahead.T), SPEED)[:, None]
    for agent, (position, velocity) in enumerate(zip(positions, velocities, strict=True)):
        simulator.add_agent(tuple(position), *NEIGHBOURS, RADIUS + SPACE, SPEED, tuple(velocity))
        simulator.set_agent_pref_velocity(agent, tuple(wanted[agent]))
    simulator.do_step()
    return np.array([simulator.get_agent_velocity(i).to_tuple() for i in range(len(positions))])


class OrcaPeople:
    """People in a true world, stepped beside the robot; ``sees`` (m,) says who avoids the robot, too.

    The robot's velocity, to those who see it, is that of the last step.
    """

    def __init__(self, walks: Sequence[Walk], sees: npt.NDArray[np.bool_]) -> None:
        self.radii = np.full(len(walks), RADIUS)
        self._positions = np.array([walk.start for walk in walks])
        self._goals = np.array([walk.goal for walk in walks])
        self._sees = sees
        self._velocities = self._last = np.zeros_like(self._positions)
        self._robot = np.array(ENDS[0])
        self._steps = 0

    def at(self, time: float) -> Floats:
        """Centres (m, 2) in metres at ``time`` (s), which lies in the step advanced to last."""
        return self._positions + (time - self._begun) * self._velocities

    def obstacles(self, time: float) -> list[MovingObstacle]:
        """The people with the velocities that can be seen at ``time`` (s): before a step, the last."""
        velocities = self._last if time <= self._begun + 1e-9 else self._velocities
        table = np.column_stack([self.at(time), velocities, self.radii])
        return [MovingObstacle(*map(float, row)) for row in table]

    def advance(self, time: float, pose: Pose2D) -> None:
        """Takes the steps that begin up to ``time`` (s), with the robot at ``pose``."""
        while self._steps * STEP <= time + 1e-9:
            self._positions = self.at(self._steps * STEP)
            robot = np.array(pose[:2])
            moved, self._robot = (robot - self._robot) / STEP, robot
            decided = next_velocities(self._positions, self._velocities, self._goals)
            if self._sees.any():
                seeing = self._with_robot(self._velocities, robot, moved, robot)[:-1]
                decided = np.where(self._sees[:, None], seeing, decided)
            self._last, self._velocities = self._velocities, decided
            self._steps += 1

    def velocity_among(self, position: Floats, velocity: Floats, goal: Floats) -> Floats:
        """The velocity (2,) by ORCA of a robot for the step that has just begun."""
        return self._with_robot(self._last, position, velocity, goal)[-1]

    @property
    def _begun(self) -> float:
        """When the present step began, s."""
        return max(self._steps - 1, 0) * STEP

    def _with_robot(self, seen: Floats, position: Floats, velocity: Floats, goal: Floats) -> Floats:
        return next_velocities(
            np.vstack([self._positions, position]),
            np.vstack([seen, velocity]),
            np.vstack([self._goals, goal]),
        )
