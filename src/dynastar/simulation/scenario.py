"""A scenario: everything that a run depends on, as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, counted, self_checking, shown, summary
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid, Unknown
from dynastar.navigator import NavigatorConfig, Preset
from dynastar.path import ends_of
from dynastar.robot import Robot
from dynastar.simulation.faults import Fault
from dynastar.simulation.imperfections import ControlLoop, Drivetrain, LidarDriver, Odometry

Floats = npt.NDArray[np.float64]
DEFAULT = NavigatorConfig()
AfterLast = Literal["loop", "back_and_forth", "stay", "vanish"]
Attention = Literal["none", "late"]


@self_checking
class Noise(NamedTuple):
    """Errors of the simulated senses: Gaussian with half the bound as deviation, cut at the bound."""

    range_bound: Annotated[float, Field("largest error of a range", "m", 0.0, 1.0)] = 0.0
    pose_bound: Annotated[float, Field("largest error of x and of y", "m", 0.0, 1.0)] = 0.0
    heading_bound: Annotated[float, Field("largest error of the heading", "rad", 0.0, 0.5)] = 0.0


@dataclass(frozen=True, eq=False)
class Mover:
    """A disc that follows keyframes, and notices the robot only with the scenario's ``attention``.

    ``times`` (k,) s rising, ``points`` (k, 2) m, linear between. After the last key it starts over
    ("loop": from the first key, jumping there), goes back the way it came ("back_and_forth"),
    stands ("stay") or is gone ("vanish", then also absent before the first key).
    """

    radius: float
    times: Floats
    points: Floats
    after: AfterLast = "back_and_forth"

    def __repr__(self) -> str:
        disc, keys = f"disc of radius {self.radius:g} m", counted(len(self.times), "keyframe")
        return summary(self, disc, keys, ends_of(np.asarray(self.points)), f"then {self.after}")


@dataclass(frozen=True, eq=False)
class Pedestrian:
    """A simulated pedestrian: a disc that walks to its waypoints in turn, over and over.

    It starts at ``start`` (x, y) m, heads for ``waypoints`` (k >= 2, 2) m at ``speed`` (m/s) at most,
    and avoids walls, other pedestrians and the robot.
    """

    radius: float
    speed: float
    start: tuple[float, float]
    waypoints: Floats

    def __repr__(self) -> str:
        walks = f"{self.speed:g} m/s through {counted(len(self.waypoints), 'waypoint')}"
        x, y = self.start
        return summary(self, f"disc of radius {self.radius:g} m", walks, f"from ({x:g}, {y:g}) m")


@dataclass(frozen=True, eq=False)
class Scenario:
    """A mission in a world; ``grid`` is what the robot knows, ``world`` what is true (None: the same).

    ``start`` is (x, y, heading), heading None for "towards the first point of the path".
    ``obstacles`` are simple polygons (k, 2) in metres that no map has. ``faults`` strike during the
    run; ``drive``, ``odometry``, ``lidar`` and ``loop`` are what hardware does all the time, whatever
    the navigator is told. With ``attention`` "late", movers stop in front of a robot that rests or moves
    away, and go round it (``LateWalkers``). With ``legs`` the lidar sees the legs of movers and pedestrians
    (``Legs``); contacts are with their discs. ``crowd`` are pedestrians who react to the robot (needs the
    extra ``pedestrians``). ``navigator`` overrides settings of the preset, as nested tables. ``source`` is
    what the scenario was read from.
    """

    name: str
    grid: OccupancyGrid
    robot: Robot
    start: tuple[float, float, float | None]
    goals: tuple[Goal, ...]
    world: OccupancyGrid | None = None
    obstacles: tuple[Floats, ...] = ()
    movers: tuple[Mover, ...] = ()
    attention: Attention = "none"
    legs: bool = False
    crowd: tuple[Pedestrian, ...] = ()
    faults: tuple[Fault, ...] = ()
    noise: Noise = Noise()
    drive: Drivetrain = Drivetrain()
    odometry: Odometry = Odometry()
    lidar: LidarDriver = LidarDriver()
    loop: ControlLoop = ControlLoop()
    latency: float = DEFAULT.latency
    goal_tolerance: float = DEFAULT.goal_tolerance
    heading_tolerance: float = DEFAULT.heading_tolerance
    time_limit: float = 300.0
    unknown: Unknown = DEFAULT.unknown
    seed: int = 0
    preset: Preset = "default"
    navigator: Mapping[str, Any] = field(default_factory=dict)
    source: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        x, y, _ = self.start
        things = (self.obstacles, "obstacle"), (self.movers, "mover"), (self.crowd, "pedestrian")
        return summary(
            self,
            shown(self.name),
            f"robot {shown(self.robot.name)} from ({x:g}, {y:g}) m",
            counted(len(self.goals), "goal"),
            self.grid.size(),
            self.grid.extent(),
            *(counted(len(some), name) for some, name in things),
            counted(len(self.faults), "fault"),
            f"at most {self.time_limit:g} s",
        )
