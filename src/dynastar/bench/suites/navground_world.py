"""A true world whose robot is an agent of navground, which makes its scans and finds its contacts."""

import math
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from navground.core import Behavior, Frame, Kinematics, SensingState, Twist2

from dynastar.adapters.navground import scan_of
from dynastar.bench.suites.common import DirectWorld
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import RobotState
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario
from dynastar.simulation.contact import RESTING
from dynastar.simulation.movers import Movers

STUCK = 5.0  # s without motion, from which on navground calls it a deadlock

Floats = npt.NDArray[np.float64]


class Told(Behavior, name="Told"):  # type: ignore[call-arg, misc]
    """Does as it is told, by its ``command``; its lidar writes into ``state``."""

    def __init__(self, kinematics: Kinematics | None = None, radius: float = 0.0) -> None:
        super().__init__(kinematics, radius)
        self.command, self.state = Twist(0.0, 0.0), SensingState()

    def get_environment_state(self) -> SensingState:
        """What the lidar writes into."""
        return self.state

    def compute_cmd_internal(self, time_step: float) -> Twist2:
        """The command."""
        return Twist2((self.command.v, 0.0), self.command.omega, frame=Frame.relative)


class Watched:
    """A world of navground whose first agent is watched: ``time`` (s), ``position`` (m).

    In a corridor that repeats itself, the position goes on where navground takes the agent back.
    """

    def __init__(self, world: Any, step: float) -> None:
        world.update_dry(step, advance_time=False)  # prepares the agents
        self.world, self.agent, self.time, self.period = world, world.agents[0], 0.0, step
        self.position: Floats = self.agent.position.astype(np.float64)
        self._lattice = world.get_lattice(0)
        self._efficacies: list[float] = []

    def step(self) -> None:
        """Lets one of navground's steps pass."""
        self.world.update(self.period)
        self.time = round(self.time + self.period, 6)
        self.position = self.near(self.agent.position, self.position)
        self._efficacies.append(self.agent.behavior.efficacy)

    def near(self, point: Any, place: Floats) -> Floats:
        """A point (2,) of navground where it repeats itself nearest to a place."""
        moved = np.array(point, dtype=np.float64)
        if self._lattice is not None:
            length = self._lattice[1] - self._lattice[0]
            moved[0] += length * round((place[0] - moved[0]) / length)
        return moved

    @property
    def contact(self) -> Literal["", "moving", "resting"]:
        """What the first collision of the agent was, if it had one, by its last command.

        navground stops agents that collide.
        """
        if self.agent.last_collision_time < 0.0:
            return ""
        command = self.agent.get_last_cmd(Frame.relative)
        speeds = (*command.velocity.tolist(), command.angular_speed)
        return "resting" if all(abs(speed) < RESTING for speed in speeds) else "moving"

    @property
    def twist(self) -> Twist:
        """The agent's speeds; its behavior has those of the step before."""
        twist = self.agent.twist.relative(self.agent.pose)
        return Twist(float(twist.velocity[0]), twist.angular_speed)

    def facts(self) -> dict[str, Any]:
        """navground's efficacy (mean over the steps) and whether the agent is in a deadlock."""
        efficacy = float(np.mean(self._efficacies)) if self._efficacies else None
        stuck = self.agent.has_been_stuck_since(max(self.world.time - STUCK, 0.0))
        return {"efficacy": efficacy, "deadlock": bool(stuck)}


def drive_agent(watched: Watched, scenario: Scenario) -> dict[str, Any]:
    """Lets an agent of navground's own drive to the scenario's goal, and says how that ended."""
    goal, tolerance, outcome = scenario.goals[-1], scenario.goal_tolerance, "timeout"
    across = 0.0 if watched.world.walls else 1.0  # a corridor's agents keep no place across it
    while watched.time < scenario.time_limit - 1e-6 and outcome == "timeout":
        watched.step()
        dx, dy = (watched.position - goal[:2]).tolist()
        if watched.contact:
            outcome = "contact"
        elif math.hypot(dx, across * dy) <= tolerance:
            outcome = "arrived"
    contacts = {f"contacts_{kind}": int(watched.contact == kind) for kind in ("moving", "resting")}
    return {"outcome": outcome, "time": watched.time, **contacts, **watched.facts()}


class NavgroundWorld(DirectWorld):
    """The world of a navground agent with the behavior ``Told``; ``movers`` are the other agents."""

    def __init__(self, scenario: Scenario, start: Pose2D, seed: int, watched: Watched) -> None:
        self._watched = watched
        watched.world.seed = seed  # of the lidar's noise
        super().__init__(scenario, start, seed)

    def _set_movers(self, movers: Movers) -> None:
        """Takes navground's other agents for the movers."""
        super()._set_movers(movers)
        others = self._watched.world.agents[1:]
        self.mover_radii = np.array([agent.radius for agent in others], dtype=np.float64)

    @property
    def twist(self) -> Twist:
        """The robot's speeds."""
        return self._watched.twist

    @property
    def movers(self) -> Floats:
        """Where the other agents are now, (m, 2) metres."""
        watched = self._watched
        others = watched.world.agents[1:]
        return np.array([watched.near(agent.position, watched.position) for agent in others])

    def scan(self) -> LaserScan:
        """The present scan of navground's lidar, which looks before each step, and so once more."""
        agent, world = self._watched.agent, self._watched.world
        agent.state_estimation.update(agent, world, agent.behavior.state)
        return scan_of(agent.behavior.state, self.time)

    def sensed_state(self) -> RobotState:
        """The true state."""
        return RobotState(self.time, self.pose, self.twist)

    def step(self, command: Twist, duration: float) -> None:
        """Lets navground make as many steps as the duration holds, at the same command."""
        watched = self._watched
        watched.agent.behavior.command = command
        for _ in range(round(duration / watched.period)):
            if not self.contact:
                watched.step()
                self.time = watched.time
                x, y = watched.position.tolist()
                self.pose = Pose2D(x, y, watched.agent.orientation)
                self._look(self.twist, thoroughly=True)

    def _look(self, twist: Twist, thoroughly: bool) -> None:
        """Takes contacts from navground's record, and the clearance from its discs and walls."""
        radius = self._robot.footprint.circumscribed
        gaps = [math.dist(place, self.pose[:2]) for place in self.movers] - self.mover_radii
        gap = float(
            np.min(gaps, initial=self._solids.gap(self.pose, self._robot.footprint) + radius)
        )
        self.contact = self._watched.contact
        self.clearance = 0.0 if self.contact else max(gap - radius, 0.0)
