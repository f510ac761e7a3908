"""The navigator's settings, and the presets."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple

from dynastar.config import Field, checked, choose, self_checking
from dynastar.dwa.config import DwaConfig, Weights
from dynastar.grid import OccupancyGrid
from dynastar.navigator.progress import ADVANCE
from dynastar.perception import LocalMapConfig, PredictionConfig, TrackerConfig
from dynastar.planning import PlannerConfig
from dynastar.robot import Robot

SMALLEST_LOCAL_MAP = 2.0  # m, its side
CELLS = 4  # of the maps, at least, to half a robot's width
FINE = 8  # cells to half the robot's width, from which on cells are not halved
MOST_CELLS = 10_000_000  # of a planning map whose cells are halved: it takes 2 s to plan on anew


# What scenario files say, too.
Latency = Annotated[float, Field("delay until a command takes effect", "s", 0.0, 1.0)]
UnknownSpace = Annotated[Literal["free", "blocked"], Field("how unknown space is planned")]
GoalTolerance = Annotated[float, Field("distance at which a goal is reached", "m", 0.01, 5.0)]
HeadingTolerance = Annotated[
    float, Field("heading error at which a goal is reached", "rad", 0.01, 3.2)
]


@self_checking
class NavigatorConfig(NamedTuple):
    """The navigator's settings. The no-contact guarantee assumes the declared bounds."""

    period: Annotated[float, Field("time between two commands", "s", 0.01, 1.0)] = 0.1
    latency: Latency = 0.0
    range_error: Annotated[float, Field("largest error of a range reading", "m", 0.0, 1.0)] = 0.01
    pose_error: Annotated[float, Field("largest error of the position", "m", 0.0, 1.0)] = 0.01
    heading_error: Annotated[float, Field("largest error of the heading", "rad", 0.0, 0.5)] = 0.0
    drive_error: Annotated[
        float, Field("largest error of the drive's speeds, as a fraction", "", 0.0, 0.5)
    ] = 0.05
    hidden_speed: Annotated[
        float,
        Field("speed of a person who steps out of unseen space; 0: nobody does", "m/s", 0.0, 20.0),
    ] = 0.5
    unseen_speed: Annotated[
        float, Field("speed of the last resort, into unseen space; 0: never", "m/s", 0.0, 2.0)
    ] = 0.0
    reverse: Annotated[bool, Field("reverse where needed and possible")] = True
    scan_age: Annotated[
        float, Field("largest age of a scan or state before the robot brakes", "s", 0.05, 2.0)
    ] = 0.3
    unknown: UnknownSpace = "blocked"
    goal_tolerance: GoalTolerance = 0.25
    heading_tolerance: HeadingTolerance = 0.1
    resolution: Annotated[
        float, Field("largest cell of the maps that are planned and driven on", "m", 0.001, 1.0)
    ] = 0.05
    comfort: Annotated[
        float, Field("extra clearance of a plan where there is room", "m", 0.0, 5.0)
    ] = 0.125
    stuck_time: Annotated[
        float, Field("time without progress until a recovery", "s", 0.5, 600.0)
    ] = 6.0
    attempts: Annotated[int, Field("recoveries before the mission is given up", "", 0, 100)] = 4
    planner: PlannerConfig = PlannerConfig(exact=True)
    dwa: DwaConfig = DwaConfig()
    local_map: LocalMapConfig = LocalMapConfig()
    tracker: TrackerConfig = TrackerConfig()
    prediction: PredictionConfig = PredictionConfig()


Preset = Literal["default", "paper"]
PRESETS: dict[str, NavigatorConfig] = {
    "default": NavigatorConfig(),
    "paper": NavigatorConfig(
        reverse=False,
        planner=PlannerConfig(),
        dwa=DwaConfig(weights=Weights(0.5, 0.2, 0.2, 0.1)),
    ),
}


def fitted(config: NavigatorConfig, robot: Robot) -> NavigatorConfig:
    """The settings as a robot needs them.

    Map cells shrink, at most by half, until half the robot's width (m) spans 4 of them. The local map
    keeps its number of cells, unless it would be smaller than a local map may be. Range noise and
    rounding close gaps by a cell or two, which a small robot needs. A slow robot is not stuck in the
    time in which it can turn round and drive as far as counts for progress.
    """
    fraction = min(1.0, max(robot.footprint.half_width / CELLS / config.resolution, 0.5))
    local = config.local_map
    size = max(SMALLEST_LOCAL_MAP, fraction * local.size)
    least_time = math.pi / robot.limits.omega_max + ADVANCE / robot.limits.v_max
    return config._replace(
        resolution=fraction * config.resolution,
        local_map=local._replace(size=size),
        stuck_time=max(config.stuck_time, least_time),
    )


def margin_of(robot: Robot, config: NavigatorConfig) -> float:
    """The margin (m) of a robot's footprint from obstacles: the declared errors.

    It is at least as far as a corner can stick out between two beams, right beside the robot.
    """
    lever = math.hypot(robot.lidar.x, robot.lidar.y)
    if not robot.footprint.is_disc:
        lever += robot.footprint.circumscribed
    errors = config.range_error + 2.0 * config.pose_error + config.heading_error * lever
    return max(errors, 0.5 * robot.lidar.increment * robot.footprint.circumscribed)


def refined(config: NavigatorConfig, grid: OccupancyGrid, robot: Robot) -> NavigatorConfig:
    """The settings for cells half as wide as those of a planning map, if these are wide for the robot."""
    wide = grid.resolution > robot.footprint.half_width / FINE
    if wide and 4 * grid.values.size <= MOST_CELLS:
        return config._replace(resolution=0.5 * grid.resolution)
    return config


def configured(
    preset: str = "default", overrides: Mapping[str, Any] | None = None
) -> NavigatorConfig:
    """Returns a preset's settings with some replaced, nested tables by field name.

    Raises ConfigError for an unknown preset or setting, or a value out of range.
    """
    config: NavigatorConfig = changed(choose(preset, PRESETS, "preset"), overrides or {})
    return config


def changed(config: Any, overrides: Mapping[str, Any], where: str = "") -> Any:
    """Returns ``config`` with some settings replaced, nested tables by field name.

    Raises ConfigError for an unknown setting, or a value out of range.
    """
    values = dict(config._asdict())
    for key, value in overrides.items():
        current = values.get(key)
        nested = hasattr(current, "_asdict") and isinstance(value, Mapping)
        values[key] = changed(current, value, f"{where}{key}.") if nested else value
    return checked(type(config), values, where.rstrip("."))


def changes(before: Any, after: Any) -> dict[str, Any]:
    """The settings of ``after`` that differ, as ``changed`` takes them."""
    found: dict[str, Any] = {}
    for key, value in after._asdict().items():
        old = getattr(before, key)
        if value != old:
            found[key] = changes(old, value) if hasattr(value, "_asdict") else value
    return found
