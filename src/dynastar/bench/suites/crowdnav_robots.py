"""Robots of the suite crowdnav that need more than a scan: one that is told, and one moved by ORCA."""

import math
from typing import Any

import numpy as np

from dynastar.bench.controllers.status import Status
from dynastar.bench.suites.crowdnav_people import ENDS, OrcaPeople
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.navigator import Navigator, RobotState
from dynastar.robot import Robot
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario, World


class ToldNavigator(Navigator):
    """The navigator, told where people are and how they moved last."""

    def __init__(self, grid: Any, robot: Robot, config: Any, people: OrcaPeople) -> None:
        super().__init__(grid, robot, config)
        self._people = people

    def command(self, state: RobotState, scan: Any, movers: Any = None) -> Twist:
        """The twist to drive from now on."""
        return super().command(state, scan, self._people.obstacles(state.stamp))


class Passenger:
    """Says when the robot that ORCA moves has arrived."""

    def __init__(self, grid: Any, robot: Robot, config: Any) -> None:
        self.status, self._tolerance = Status("following"), config.goal_tolerance

    def set_goal(self, goals: tuple[Goal, ...]) -> None:
        """Takes the goal."""
        self._goal = goals[0]

    def command(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """Nothing to drive."""
        if math.dist(state.pose[:2], self._goal[:2]) <= self._tolerance:
            self.status = Status("arrived")
        return Twist(0.0, 0.0)


class OrcaWorld(World):
    """A world whose robot moves by ORCA in any direction, whatever it is commanded."""

    def __init__(self, scenario: Scenario, start: Pose2D, seed: int, walkers: OrcaPeople) -> None:
        self._people, self._velocity = walkers, np.zeros(2)
        super().__init__(scenario, start, seed, walkers)

    @property
    def twist(self) -> Twist:
        """The robot's speed over ground."""
        return Twist(float(np.hypot(*self._velocity)), 0.0)

    @property
    def resting(self) -> bool:
        """Always: a robot without inertia may rest at any time."""
        return True

    def step(self, command: Twist, duration: float) -> None:
        """Lets ``duration`` seconds pass, a step of the people."""
        here, goal = np.array(self.pose[:2]), np.array(ENDS[1])
        self._velocity = self._people.velocity_among(here, self._velocity, goal)
        super().step(command, duration)

    def _drive(self, until: float) -> Twist:
        """Moves straight on; returns the speed."""
        x, y = np.array(self.pose[:2]) + (until - self.time) * self._velocity
        heading = math.atan2(self._velocity[1], self._velocity[0])
        self.pose, self.time = Pose2D(float(x), float(y), heading), until
        return self.twist
