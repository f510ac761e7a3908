"""A true world whose robot is moved, whose scans are made, and whose contacts are found, by ir-sim."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.adapters.irsim import scan_of, state_of
from dynastar.bench.suites.common import DirectWorld
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import RobotState
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario
from dynastar.simulation.movers import Movers


class IrSimWorld(DirectWorld):
    """The world of an ir-sim environment with one robot; ``movers`` are its walkers."""

    def __init__(self, scenario: Scenario, start: Pose2D, seed: int, env: Any) -> None:
        self._env = env
        self._walkers = [thing for thing in env.obstacle_list if not thing.static]
        env.set_random_seed(seed)
        super().__init__(scenario, start, seed)

    def _set_movers(self, movers: Movers) -> None:
        """Takes ir-sim's walkers for the movers."""
        super()._set_movers(movers)
        self.mover_radii = np.array([thing.radius for thing in self._walkers], dtype=np.float64)

    @property
    def twist(self) -> Twist:
        """The robot's speeds."""
        return self.sensed_state().twist

    @property
    def movers(self) -> npt.NDArray[np.float64]:
        """Where the walkers are now, (m, 2) metres."""
        return np.array([thing.state[:2, 0] for thing in self._walkers]).reshape(-1, 2)

    def scan(self) -> LaserScan:
        """The present scan of ir-sim's lidar."""
        return scan_of(self._env.robot, self.time)

    def sensed_state(self) -> RobotState:
        """The true state."""
        return state_of(self._env.robot, self.time)

    def step(self, command: Twist, duration: float) -> None:
        """Lets ir-sim make as many of its steps as the duration holds, at the same command."""
        for _ in range(round(duration / self._env.step_time)):
            if not self.contact:
                self._env.step(list(command))
                self.time = self._env.time
                self.pose = self.sensed_state().pose
                self._look(self.twist, thoroughly=True)

    def _look(self, twist: Twist, thoroughly: bool) -> None:
        """Takes contacts from ir-sim's flag, and the clearance from its shapes."""
        robot = self._env.robot
        shapes = [thing.geometry for thing in self._env.obstacle_list]
        self.clearance = float(np.min(shapely.distance(robot.geometry, shapes), initial=math.inf))
        if robot.collision:
            self.clearance, self.contact = 0.0, "resting" if self.resting else "moving"
