"""The keys of a scenario file and of its tables: the file is checked by them, and its schema made."""

from typing import Annotated, Any, NamedTuple

from dynastar.config import Field
from dynastar.navigator import NavigatorConfig, Preset
from dynastar.navigator.config import GoalTolerance, HeadingTolerance, Latency, UnknownSpace
from dynastar.simulation.imperfections import ControlLoop, Drivetrain, LidarDriver, Odometry
from dynastar.simulation.scenario import AfterLast, Attention

DEFAULT = NavigatorConfig()

Metres = Annotated[float, Field("a coordinate", "m", -1e6, 1e6)]
_Size = Annotated[float, Field("a size", "m", 1e-3, 1e4)]
_Seconds = Annotated[float, Field("a time", "s", 0.0, 1e6)]
_Speed = Annotated[float, Field("a speed", "m/s", 1e-3, 50.0)]


class ScenarioTable(NamedTuple):
    """The keys of a scenario file; it needs ``map``, ``robot``, ``start``, and a goal."""

    map: Any
    robot: Any
    start: Any
    goals: Any = None
    goal: Any = None
    name: str = ""
    world: Any = None
    keepout: Any = None
    speed_limit: Any = None
    seed: Annotated[int, Field("seed of all noise", "", 0, 2**63 - 1)] = 0
    time_limit: Annotated[
        float, Field("time after which the mission is a timeout", "s", 0.1, 1e5)
    ] = 300.0
    latency: Latency = DEFAULT.latency
    unknown: UnknownSpace = DEFAULT.unknown
    goal_tolerance: GoalTolerance = DEFAULT.goal_tolerance
    heading_tolerance: HeadingTolerance = DEFAULT.heading_tolerance
    preset: Annotated[Preset, Field("the navigator's settings")] = "default"
    sensor: Any = None
    drive: Drivetrain = Drivetrain()
    odometry: Odometry = Odometry()
    lidar: LidarDriver = LidarDriver()
    loop: ControlLoop = ControlLoop()
    obstacles: Any = None
    movers: Any = None
    attention: Annotated[
        Attention,
        Field("late: movers stop in front of a robot that rests or moves away, and go round it"),
    ] = "none"
    navigator: Any = None


class MapTable(NamedTuple):
    """A map drawn in the scenario itself: see ``OccupancyGrid.from_text``."""

    rows: tuple[str, ...]
    resolution: Annotated[float, Field("side of a cell", "m", 1e-3, 1e3)] = 1.0
    origin: Annotated[tuple[float, float], Field("lowest corner", "m", -1e6, 1e6)] = (0.0, 0.0)


class RobotTable(NamedTuple):
    """A ready-made robot with changes; a footprint is a radius or a convex polygon round (0, 0)."""

    base: str
    limits: Any = None
    radius: Annotated[float | None, Field("of a disc", "m", 0.01, 10.0)] = None
    polygon: Annotated[
        tuple[tuple[float, float], ...] | None, Field("corners", "m", -10.0, 10.0)
    ] = None


class PlaceTable(NamedTuple):
    """Where to start or to go."""

    x: Metres
    y: Metres
    heading: Annotated[float | None, Field("any heading if left out", "rad", -7.0, 7.0)] = None


class ObstacleTable(NamedTuple):
    """One shape: a box (x, y of its centre, length, width) turned by yaw, a disc, or a polygon."""

    box: tuple[Metres, Metres, _Size, _Size] | None = None
    yaw: Annotated[float | None, Field("of the box", "rad", -7.0, 7.0)] = None
    disc: tuple[Metres, Metres, _Size] | None = None
    polygon: tuple[tuple[Metres, Metres], ...] | None = None


class MoverTable(NamedTuple):
    """A disc and one way of moving; ``from_`` is written ``from`` in the file.

    Waypoints are walked at ``speed``, with a rest of ``pause`` at each; ``start`` delays the first
    step. A track has its own times, so it takes neither.
    """

    radius: Annotated[float, Field("of the disc", "m", 0.01, 10.0)]
    waypoints: tuple[tuple[Metres, Metres], ...] | None = None
    from_: tuple[Metres, Metres] | None = None
    track: tuple[tuple[_Seconds, Metres, Metres], ...] | None = None
    speed: _Speed | None = None
    pause: _Seconds | None = None
    after: AfterLast | None = None
    velocity: Annotated[tuple[float, float] | None, Field("a velocity", "m/s", -50.0, 50.0)] = None
    start: _Seconds | None = None
