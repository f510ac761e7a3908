"""A true world whose robot is moved, and whose contacts are found, by MuJoCo."""

import math

from dynastar.bench.suites.physics_model import Body, Engine
from dynastar.geometry import Pose2D, Twist
from dynastar.simulation import Scenario, World
from dynastar.simulation.contact import RESTING


class PhysicsWorld(World):
    """A world with forces, friction and masses; nothing in it moves but the robot.

    The scenario's drive ramps the commanded speeds, as the firmware of a robot does; motors of limited
    torque turn the wheels that fast. Scans are those of the project's own simulator.
    """

    def __init__(
        self, scenario: Scenario, start: Pose2D, seed: int, body: Body, floor: float, loaded: bool
    ) -> None:
        self._engine, self._touching = Engine(scenario, start, body, floor, loaded), False
        super().__init__(scenario, start, seed)
        self.pose = self._engine.pose

    @property
    def twist(self) -> Twist:
        """The robot's speeds over ground."""
        return self._engine.twist

    @property
    def wheels(self) -> Twist:
        """The speeds that the wheels have, from which odometry takes its own."""
        return self._engine.wheels

    @property
    def resting(self) -> bool:
        """Whether the robot stands and no command that it was given will move it."""
        return self.drive.resting and all(abs(speed) < RESTING for speed in self.twist)

    def _drive(self, until: float) -> Twist:
        """Lets the engine run; returns the twist at its end."""
        duration = until - self.time
        self.drive.advance(duration)
        self._touching = self._engine.drive(self.drive.wheels, duration)
        self.pose, self.time = self._engine.pose, until
        return self.twist

    def _look(self, twist: Twist, thoroughly: bool) -> None:
        """Takes contacts from the engine, and the clearance from the geometry."""
        if thoroughly or self._touching:
            gap = self._solids.gap(self.pose, self._robot.footprint)
            self.clearance = 0.0 if self._touching else min(self.clearance, gap)
        if self._touching:
            at_rest = math.hypot(*twist) < RESTING
            self.contact = "resting" if at_rest else "moving"
