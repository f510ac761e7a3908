"""The true world: the robot as it really moves, and what it really touches (Eq. 4, section V)."""

import math
from collections.abc import Sequence
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

from dynastar.config import counted, shown, summary
from dynastar.errors import InputError, ScenarioError
from dynastar.geometry import Pose2D, Twist, wrap_angle
from dynastar.navigator import RobotState
from dynastar.robot import Limits, arc
from dynastar.scan import LaserScan
from dynastar.simulation.attention import LateWalkers
from dynastar.simulation.contact import RESTING, Solids
from dynastar.simulation.crowd import Crowd
from dynastar.simulation.drivetrain import DriveSimulator
from dynastar.simulation.legs import Legs
from dynastar.simulation.lidar import LidarSimulator
from dynastar.simulation.movers import Movers, gap_to_discs
from dynastar.simulation.noise import cut_gaussian
from dynastar.simulation.scenario import Scenario
from dynastar.simulation.start import start_pose

Floats = npt.NDArray[np.float64]
Contact = Literal["", "moving", "resting"]

SUBSTEP = 0.01  # s, the longest stretch driven at one twist


class Walkers(Protocol):
    """People in a world who are stepped beside the robot, as ``Crowd`` is; ``radii`` is (m,) metres."""

    radii: Floats

    def at(self, time: float) -> Floats:
        """Centres (m, 2) in metres at ``time`` (s), which lies in the step advanced to last."""

    def advance(self, time: float, pose: Pose2D) -> None:
        """Takes the steps that begin up to ``time`` (s), with the robot at ``pose``."""


class World:
    """True state of the robot: ``time`` (s), ``pose``, ``twist``, ``clearance`` (m), ``contact``.

    ``drive`` is the simulated drive. ``clearance`` is the smallest gap between footprint and anything since
    the last ``step`` began; ``contact`` says what a touch was, and the world then stands still.
    ``late`` are the movers of a scenario with ``attention = "late"``, whose bumps are no contact.
    ``walkers`` replace the scenario's crowd. The robot begins at ``start``, (x, y, heading) in metres and
    radians, by default the scenario's; see ``start_pose`` for a heading of None.
    Raises ScenarioError for obstacles, movers or a seed that no world can be made of.
    """

    def __init__(
        self,
        scenario: Scenario,
        start: Sequence[float | None] | None = None,
        seed: int | None = None,
        walkers: Walkers | None = None,
    ) -> None:
        seed = scenario.seed if seed is None else seed
        if seed < 0:
            raise ScenarioError(f"the seed is {seed}: expected 0 or more")
        grid = scenario.grid if scenario.world is None else scenario.world
        senses = np.random.SeedSequence(seed).spawn(3)
        self._scenario, self._robot = scenario, scenario.robot
        self._solids = Solids(grid, scenario.obstacles)
        self.time, self.pose = 0.0, start_pose(scenario, start)
        self._crowd = walkers
        if walkers is None and scenario.crowd:
            footprint = scenario.robot.footprint
            self._crowd = Crowd(scenario.crowd, grid, scenario.obstacles, footprint, seed)
        self._set_movers(Movers(scenario.movers))
        self.late = self._late_walkers(scenario)
        self._lidar = LidarSimulator(
            scenario.robot.lidar,
            grid,
            scenario.obstacles,
            scenario.noise.range_bound,
            np.random.default_rng(senses[0]),
            scenario.lidar,
        )
        self.obstacles = tuple(np.asarray(ring, dtype=np.float64) for ring in scenario.obstacles)
        self._pose_random = np.random.default_rng(senses[1])
        self.drive = DriveSimulator(
            scenario.robot.limits,
            scenario.drive,
            scenario.latency,
            np.random.default_rng(senses[2]),
        )
        self.contact: Contact = ""
        self._solid_gap, self._travelled = 0.0, 0.0
        self.clearance = math.inf
        self._look(Twist(0.0, 0.0), thoroughly=True)

    def __repr__(self) -> str:
        (x, y, theta), (v, omega) = self.pose, self.twist
        return summary(
            self,
            shown(self._scenario.name),
            f"at {self.time:.2f} s",
            f"robot at ({x:.2f}, {y:.2f}) m, {theta:.2f} rad, {v:.2f} m/s, {omega:.2f} rad/s",
            f"clearance {self.clearance:.2f} m",
            f"contact ({self.contact})" if self.contact else "",
            counted(len(self.obstacles), "obstacle"),
            counted(len(self.mover_radii), "mover"),
        )

    @property
    def twist(self) -> Twist:
        """The robot's speeds over ground."""
        return self.drive.twist

    @property
    def wheels(self) -> Twist:
        """The speeds that the wheels have, from which odometry takes its own."""
        return self.drive.wheels

    @property
    def resting(self) -> bool:
        """Whether the robot stands and no command that it was given will move it."""
        return self.drive.resting

    @property
    def movers(self) -> Floats:
        """Where movers and pedestrians are now, (m, 2) metres, NaN for those that are not there."""
        scripted = (self.late or self._movers).at(self.time)
        return scripted if self._crowd is None else np.vstack([scripted, self._crowd.at(self.time)])

    def scan(self) -> LaserScan:
        """The present scan."""
        discs = np.column_stack([self.movers, self.mover_radii])
        if self._scenario.legs:
            discs = self._legs.discs(self.movers)
        return self._lidar.scan(self.pose, self.time, discs)

    def sensed_state(self) -> RobotState:
        """The state as localisation and odometry tell it now, errors included."""
        wheels, errors = self.wheels, self._scenario.odometry
        twist = Twist(errors.gain_v * wheels.v, errors.gain_omega * wheels.omega)
        return RobotState(self.time, self.sensed_pose(), twist)

    def sensed_pose(self) -> Pose2D:
        """The pose as the robot's localisation tells it now, errors included."""
        noise = self._scenario.noise
        error = cut_gaussian(self._pose_random, 1.0, 3)
        return Pose2D(
            self.pose.x + noise.pose_bound * error[0],
            self.pose.y + noise.pose_bound * error[1],
            wrap_angle(self.pose.theta + noise.heading_bound * error[2]),
        )

    def add_obstacle(self, ring: Floats) -> None:
        """Puts another polygon (k, 2), metres, into the true world; ScenarioError if it is none."""
        self._set_obstacles((*self.obstacles, ring))
        self._look(self.twist, thoroughly=True)

    def change(self, scenario: Scenario) -> None:
        """Takes obstacles, movers and the robot's limits of a scenario; all else goes on as it is.

        Raises ScenarioError for what cannot be, and then changes nothing. A contact is forgotten.
        """
        movers, late = Movers(scenario.movers), self._late_walkers(scenario)
        self._set_obstacles(scenario.obstacles)
        self._set_movers(movers)
        self.late = late
        self._robot, self.contact, self.clearance = scenario.robot, "", math.inf
        self.drive.limits = scenario.robot.limits
        self._look(self.twist, thoroughly=True)

    def _late_walkers(self, scenario: Scenario) -> LateWalkers | None:
        """The movers of a scenario in which they notice the robot late."""
        if scenario.attention != "late":
            return None
        return LateWalkers(scenario.movers, scenario.robot.footprint, self.gaps, self.time)

    def _set_movers(self, movers: Movers) -> None:
        crowd_radii = np.empty(0) if self._crowd is None else self._crowd.radii
        self._movers, self.mover_radii = movers, np.concatenate([movers.radii, crowd_radii])
        self._legs = Legs(len(self.mover_radii))

    def _set_obstacles(self, rings: Sequence[Floats]) -> None:
        self._solids.change(rings)
        self._lidar.change(rings)
        self.obstacles = tuple(rings)

    def gaps(self, points: Floats) -> Floats:
        """Metres (n,) from points (n, 2) to the nearest obstacle; 0 inside of one, or off the map."""
        return self._solids.gaps(points)

    def place(self, pose: Pose2D) -> None:
        """Puts the robot somewhere else; its speeds stay."""
        self.pose = start_pose(self._scenario, pose)
        self._look(self.twist, thoroughly=True)

    def step(self, command: Twist, duration: float) -> None:
        """Takes in ``command`` and lets ``duration`` seconds pass, or less where a contact ends it.

        Raises InputError for a command that is not finite, and for a duration that is not positive.
        """
        if not 0.0 < duration < math.inf:
            raise InputError(f"the duration of a step is {duration}: expected seconds, more than 0")
        if not all(map(math.isfinite, command)):
            raise InputError(f"the command at {self.time:g} s is {command}: expected finite speeds")
        if self.contact:
            return
        end = self.time + duration
        self.drive.take(command, self.time)
        self.clearance = math.inf
        while self.time < end and not self.contact:
            until = min(end, self.drive.act(self.time))
            substeps = math.ceil((until - self.time) / SUBSTEP - 1e-6)
            if substeps > 1:
                until = self.time + (until - self.time) / substeps
            self._look(self._drive(until), thoroughly=self.time >= end)

    @property
    def limits(self) -> Limits:
        """The limits of the drive."""
        return self.drive.limits

    def _drive(self, until: float) -> Twist:
        """Moves along one exact arc at the mean of the speeds before and after, and returns it."""
        duration = until - self.time
        mean = self.drive.advance(duration)
        self.pose = arc(self.pose, mean, duration)
        self.time = until
        reach = self._robot.footprint.circumscribed
        self._travelled += duration * (abs(mean.v) + reach * abs(mean.omega))
        return mean

    def _look(self, twist: Twist, thoroughly: bool) -> None:
        """Check for contact: with moving obstacles always, with others after half the gap to them.

        No point of the footprint has moved further than ``_travelled`` since the last check of those.
        """
        footprint = self._robot.footprint
        if thoroughly or self._travelled >= 0.5 * self._solid_gap:
            self._solid_gap = self._solids.gap(self.pose, footprint)
            self._travelled = 0.0
            self.clearance = min(self.clearance, self._solid_gap)
        if self._crowd is not None:
            self._crowd.advance(self.time, self.pose)
        if self.late is not None:
            self.late.advance(self.time, self.pose, twist)
        movers = self.movers
        gap = self._gap_to(movers)
        self.clearance = max(0.0, min(self.clearance, gap))
        if gap <= 0.0 and self.late is not None:
            movers[: len(self.late.radii)][self.late.bumping] = math.nan
            gap = self._gap_to(movers)
        if min(self._solid_gap, gap) <= 0.0:
            at_rest = abs(twist.v) < RESTING and abs(twist.omega) < RESTING
            self.contact = "resting" if at_rest else "moving"

    def _gap_to(self, movers: Floats) -> float:
        """Metres from the footprint to movers at (m, 2); inf without any."""
        return gap_to_discs(self.pose, self._robot.footprint, movers, self.mover_radii)
