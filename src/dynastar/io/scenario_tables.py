"""The keys of a scenario file and of its tables: the file is checked by them, and its schema made."""

from typing import Annotated, Any, NamedTuple

from dynastar.config import Field
from dynastar.navigator import NavigatorConfig, Preset
from dynastar.navigator.config import GoalTolerance, HeadingTolerance, Latency, UnknownSpace
from dynastar.simulation.imperfections import ControlLoop, Drivetrain, LidarDriver, Odometry
from dynastar.simulation.scenario import AfterLast, Attention

DEFAULT = NavigatorConfig()

Metres = Annotated[float, Field("a coordinate", "m", -1e6, 1e6)]
_Corners = tuple[tuple[Metres, Metres], ...]
_Size = Annotated[float, Field("a size", "m", 1e-3, 1e4)]
_Seconds = Annotated[float, Field("a time", "s", 0.0, 1e6)]
_TrackTime = Annotated[float, Field("a time", "s", -1e6, 1e6)]


class ScenarioTable(NamedTuple):
    """The keys of a scenario file; it needs ``map``, ``robot``, ``start``, and a goal."""

    map: Annotated[Any, Field("what the robot knows: a map's file, or a table with a drawn map")]
    robot: Annotated[
        Any, Field("name of a robot that comes with dynastar, or a table that changes one")
    ]
    start: Annotated[Any, Field("x, y and heading; without a heading the robot faces its path")]
    goals: Annotated[Any, Field("goals to visit in this order")] = None
    goal: Annotated[Any, Field("the only goal, in place of goals")] = None
    name: Annotated[str, Field("name in tables and pictures; the file's if left out")] = ""
    world: Annotated[Any, Field("the true map, where it differs from what the robot knows")] = None
    keepout: Annotated[Any, Field("mask over the map: occupied cells must not be entered")] = None
    speed_limit: Annotated[Any, Field("mask over the map that limits the speed")] = None
    seed: Annotated[int, Field("seed of all noise", "", 0, 2**63 - 1)] = 0
    time_limit: Annotated[
        float, Field("time after which the mission is a timeout", "s", 0.1, 1e5)
    ] = 300.0
    latency: Latency = DEFAULT.latency
    unknown: UnknownSpace = DEFAULT.unknown
    goal_tolerance: GoalTolerance = DEFAULT.goal_tolerance
    heading_tolerance: HeadingTolerance = DEFAULT.heading_tolerance
    preset: Annotated[Preset, Field("the navigator's settings")] = "default"
    sensor: Annotated[Any, Field("changes of the robot's lidar, and sensor errors")] = None
    drive: Drivetrain = Drivetrain()
    odometry: Odometry = Odometry()
    lidar: LidarDriver = LidarDriver()
    loop: ControlLoop = ControlLoop()
    obstacles: Annotated[Any, Field("obstacles at rest that the map lacks")] = None
    movers: Annotated[Any, Field("walkers and other discs that move")] = None
    attention: Annotated[
        Attention,
        Field("late: movers stop in front of a robot that rests or moves away, and go round it"),
    ] = "none"
    legs: Annotated[bool, Field("the lidar sees the legs of movers, not their discs")] = False
    navigator: Annotated[Any, Field("settings that replace those of the preset")] = None


class MapTable(NamedTuple):
    """A map drawn in the scenario itself: see ``OccupancyGrid.from_text``."""

    rows: Annotated[tuple[str, ...], Field("the map from the top: # occupied, . free, ? unknown")]
    resolution: Annotated[float, Field("side of a cell", "m", 1e-3, 1e3)] = 1.0
    origin: Annotated[tuple[float, float], Field("lowest corner", "m", -1e6, 1e6)] = (0.0, 0.0)


class RobotTable(NamedTuple):
    """A ready-made robot with changes; a footprint is a radius or a convex polygon round (0, 0)."""

    base: Annotated[str, Field("the robot to change")]
    limits: Annotated[Any, Field("limits that differ from those of the base")] = None
    radius: Annotated[float | None, Field("footprint: radius of a disc", "m", 0.01, 10.0)] = None
    polygon: Annotated[
        tuple[tuple[float, float], ...] | None,
        Field("footprint: corners of a convex polygon", "m", -10.0, 10.0),
    ] = None


class PlaceTable(NamedTuple):
    """Where to start or to go."""

    x: Annotated[float, Field("position along x", "m", -1e6, 1e6)]
    y: Annotated[float, Field("position along y", "m", -1e6, 1e6)]
    heading: Annotated[
        float | None,
        Field("direction, counter-clockwise from x; any if left out", "rad", -7.0, 7.0),
    ] = None


class ObstacleTable(NamedTuple):
    """One shape: a box (x, y of its centre, length, width) turned by yaw, a disc, or a polygon."""

    box: Annotated[
        tuple[Metres, Metres, _Size, _Size] | None,
        Field("x and y of the centre, length, width", "m"),
    ] = None
    yaw: Annotated[float | None, Field("rotation of the box", "rad", -7.0, 7.0)] = None
    disc: Annotated[
        tuple[Metres, Metres, _Size] | None, Field("x and y of the centre, radius", "m")
    ] = None
    polygon: Annotated[_Corners | None, Field("x and y of each corner", "m")] = None


class MoverTable(NamedTuple):
    """A disc and one way of moving; ``from_`` is written ``from`` in the file.

    Waypoints are walked at ``speed``, with a rest of ``pause`` at each; ``start`` delays the first
    step. A track has its own times, so it takes neither.
    """

    radius: Annotated[float, Field("radius of the disc", "m", 0.01, 10.0)]
    waypoints: Annotated[
        _Corners | None, Field("x and y of the places to walk to in turn", "m")
    ] = None
    from_: Annotated[
        tuple[Metres, Metres] | None, Field("x and y of the start of a straight motion", "m")
    ] = None
    track: Annotated[
        tuple[tuple[_TrackTime, Metres, Metres], ...] | None,
        Field("time (s), x and y (m) of each keyframe; linear between them"),
    ] = None
    speed: Annotated[float | None, Field("speed between waypoints", "m/s", 1e-3, 50.0)] = None
    pause: Annotated[float | None, Field("rest at each waypoint", "s", 0.0, 1e6)] = None
    after: Annotated[
        AfterLast | None,
        Field("after the last place: begin again, walk to and fro, stay, or vanish"),
    ] = None
    velocity: Annotated[
        tuple[float, float] | None, Field("velocity along x and y, with from", "m/s", -50.0, 50.0)
    ] = None
    start: Annotated[float | None, Field("time of the first step", "s", 0.0, 1e6)] = None
