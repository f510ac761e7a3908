"""The dynamic window alone, beside which the hybrid is measured: no path but the straight line."""

from collections.abc import Sequence

import numpy as np

from dynastar.geometry import Goal, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState, Status
from dynastar.robot import Robot
from dynastar.scan import LaserScan


class Unplanned:
    """The navigator on the straight line to its goals, whatever the map has in between.

    Obstacles are passed as on any path that is given: within the local map.
    """

    def __init__(self, grid: OccupancyGrid, robot: Robot, config: NavigatorConfig) -> None:
        self._navigator = Navigator(grid, robot, config)
        self._goals: list[Goal] = []

    @property
    def status(self) -> Status:
        """The navigator's."""
        return self._navigator.status

    def set_goal(self, goal: Goal | Sequence[Goal]) -> None:
        """One goal, or several to reach in order; the line begins where the robot is next."""
        self._goals = [goal] if isinstance(goal, Goal) else list(goal)

    def command(self, state: RobotState, scan: LaserScan | None) -> Twist:
        """The twist to drive from now on."""
        if self._goals:
            line = np.array([state.pose[:2], *(goal[:2] for goal in self._goals)])
            self._navigator.follow(line, self._goals[-1].heading)
            self._goals = []
        return self._navigator.command(state, scan)
