"""A scenario: everything that a run depends on, as plain data."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, checked, choose, counted, self_checking, shown, summary
from dynastar.errors import InputError
from dynastar.geometry import Goal, as_goals, as_point
from dynastar.grid import OccupancyGrid, Unknown
from dynastar.navigator import NavigatorConfig, Preset
from dynastar.navigator.inputs import as_robot
from dynastar.path import ends_of
from dynastar.robot import ROBOTS, Robot
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


class _Plain(NamedTuple):
    """The values of a scenario that are cast and checked as settings."""

    name: str
    attention: Attention
    legs: bool
    noise: Noise
    drive: Drivetrain
    odometry: Odometry
    lidar: LidarDriver
    loop: ControlLoop
    time_limit: Annotated[float, Field("time after which the mission is a timeout", "s", 0.0)]
    seed: Annotated[int, Field("seed of all noise", "", 0, 2**63 - 1)]


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
    what the scenario was read from. ``robot`` may be a name in ``ROBOTS``. Raises InputError for a part
    of a wrong type.
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

    def __post_init__(self) -> None:
        robot = self.robot
        robot = choose(robot, ROBOTS, "robot") if isinstance(robot, str) else robot
        for grid in (self.grid, self.grid if self.world is None else self.world):
            as_robot(grid, robot, DEFAULT)
        as_point(self.start, "the start")
        if not isinstance(self.navigator, Mapping):
            raise InputError(
                f"a scenario's navigator is {shown(self.navigator)}: expected a table of settings that "
                "replace the preset's, as {'period': 0.1}"
            )
        plain = checked(_Plain, {key: getattr(self, key) for key in _Plain._fields}, "Scenario")
        rings = _parts("obstacles", self.obstacles, Iterable, "polygons")
        for key, value in (
            *plain._asdict().items(),
            ("robot", robot),
            ("start", (*self.start, None)[:3]),
            ("goals", tuple(as_goals(self.goals))),
            ("obstacles", tuple(map(_ring, rings))),
            ("movers", _parts("movers", self.movers, Mover, "Mover")),
            ("crowd", _parts("crowd", self.crowd, Pedestrian, "Pedestrian")),
            ("faults", _parts("faults", self.faults, Fault, "Fault")),
        ):
            object.__setattr__(self, key, value)

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


def _parts(name: str, parts: Any, kind: type, what: str) -> tuple[Any, ...]:
    """A scenario's parts of a kind as a tuple; raises InputError for others."""
    found = tuple(parts) if isinstance(parts, Iterable) else (parts,)
    if not all(isinstance(part, kind) for part in found) or not isinstance(parts, Iterable):
        raise InputError(f"a scenario's {name} are {shown(parts)}: expected a tuple of {what}")
    return found


def _ring(corners: Any) -> Floats:
    """The corners (k, 2) of an obstacle; raises InputError for what are none."""
    try:
        ring = np.asarray(corners, dtype=np.float64)
    except (OverflowError, TypeError, ValueError):
        ring = np.empty(0)
    if ring.ndim != 2 or len(ring) < 3 or ring.shape[1] != 2 or not np.isfinite(ring).all():
        raise InputError(
            f"an obstacle is {shown(corners)}: expected a polygon (k >= 3, 2), finite metres"
        )
    return ring
