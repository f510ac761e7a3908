"""What a node is told besides the navigator's settings, and settings by dotted name."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

from dynastar.config import Field, checked
from dynastar.errors import ConfigError
from dynastar.footprint import Footprint
from dynastar.navigator import NavigatorConfig, Preset, configured
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.ros.localization import PoseSource
from dynastar.simulation import Scenario
from dynastar.simulation.run import effective_config

SIMULATED_PERIOD = 0.05  # s between the scans of `dynastar ros-sim`, by default
AGE = Field("largest age of scan and odometry before the robot brakes", "s", 0.05, 2.0)


class NodeSettings(NamedTuple):
    """What a node is told besides the navigator's settings; read once, at the start."""

    robot: Annotated[str, Field(f"one of {', '.join(ROBOTS)}")] = "turtlebot3_burger"
    radius: Annotated[float, Field("of a round robot, 0: as built in", "m", 0.0, 10.0)] = 0.0
    polygon: Annotated[
        tuple[float, ...], Field("corners x, y, x, y ... of the footprint", "m", -10.0, 10.0)
    ] = ()
    preset: Annotated[Preset, Field("settings to start from")] = "default"
    global_frame: Annotated[str, Field("frame of map, goals and poses")] = "map"
    base_frame: Annotated[str, Field("frame of the robot")] = "base_link"
    pose_source: Annotated[
        PoseSource, Field("odometry alone, or corrected by amcl_pose or by tf")
    ] = "odom"
    laser_pose: Annotated[
        tuple[float, ...],
        Field("x, y, yaw of the lidar; empty: from tf, or as built in", "", -10.0, 10.0),
    ] = ()
    laser_beams: Annotated[int, Field("readings of a scan, 0: as built in", "", 0, 100_000)] = 0
    laser_fov: Annotated[
        float, Field("angle between a scan's ends, 0: as built in", "rad", 0.0, math.tau)
    ] = 0.0
    laser_range: Annotated[
        tuple[float, ...],
        Field("smallest and largest range of the lidar; empty: as built in", "m", 0.0, 1000.0),
    ] = ()
    laser_nothing: Annotated[
        tuple[float, ...],
        Field("readings that mean no return, as 0, nan or 65.5", "m", nan_is_legal=True),
    ] = ()
    enable_stamped_cmd_vel: Annotated[bool, Field("TwistStamped instead of Twist")] = False
    data_age: Annotated[float, AGE] = 0.2
    pose_age: Annotated[
        float,
        Field("largest age, or lead, of a transform from odometry to map, with tf", "s", 0.1, 1e9),
    ] = 2.0
    bag: Annotated[str, Field("new folder to record to, as MCAP; empty: none")] = ""
    speed_filter_type: Annotated[
        Literal["percent", "absolute"], Field("meaning of the speed mask")
    ] = "percent"
    speed_filter_base: Annotated[float, Field("limit where the mask is 0", "", -1e3, 1e3)] = 100.0
    speed_filter_multiplier: Annotated[float, Field("of the mask's value", "", -1e3, 1e3)] = -1.0


class GuardSettings(NamedTuple):
    """What a guard's node is told besides."""

    use_map: Annotated[
        bool, Field("use map and masks; poses then have to be in the map's frame")
    ] = False
    command_age: Annotated[
        float, Field("largest age of a command before the robot brakes", "s", 0.05, 5.0)
    ] = 0.5


def flat(values: Any, prefix: str = "") -> dict[str, Any]:
    """The fields of a tuple of settings by dotted name."""
    found: dict[str, Any] = {}
    for name, value in values._asdict().items():
        if hasattr(value, "_asdict"):
            found |= flat(value, f"{prefix}{name}.")
        else:
            found[f"{prefix}{name}"] = value
    return found


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted names as nested tables."""
    tables: dict[str, Any] = {}
    for name, value in values.items():
        *path, last = name.split(".")
        table = tables
        for key in path:
            table = table.setdefault(key, {})
        table[last] = value
    return tables


def fields_of(cls: Any, prefix: str = "") -> dict[str, Field]:
    """The Field of every setting by dotted name."""
    found: dict[str, Field] = {}
    for name, hint in get_type_hints(cls, include_extras=True).items():
        if get_origin(hint) is Annotated:
            notes = [note for note in get_args(hint)[1:] if isinstance(note, Field)]
            found[f"{prefix}{name}"] = notes[0] if notes else Field("")
        elif hasattr(hint, "_field_defaults"):
            found |= fields_of(hint, f"{prefix}{name}.")
    return found


def robot_of(base: Robot, limits: Limits, own: NodeSettings) -> Robot:
    """A robot built in, with the limits, footprint and lidar that were given instead."""
    footprint, lidar = base.footprint, base.lidar
    if own.radius > 0.0:
        footprint = Footprint.disc(own.radius)
    if own.polygon:
        if len(own.polygon) % 2:
            raise ConfigError(f"'polygon' has {len(own.polygon)} values: expected x, y, x, y ...")
        footprint = Footprint.polygon(list(zip(own.polygon[::2], own.polygon[1::2], strict=True)))
    if own.laser_pose:
        if len(own.laser_pose) != 3:
            raise ConfigError(f"'laser_pose' has {len(own.laser_pose)} values: expected x, y, yaw")
        x, y, yaw = own.laser_pose
        lidar = lidar._replace(x=x, y=y, theta=yaw)
    if own.laser_beams:
        lidar = lidar._replace(beams=own.laser_beams)
    if own.laser_fov:
        lidar = lidar._replace(fov=own.laser_fov)
    if own.laser_range:
        if len(own.laser_range) != 2:
            raise ConfigError(f"'laser_range' has {len(own.laser_range)} values: expected two")
        lidar = lidar._replace(range_min=own.laser_range[0], range_max=own.laser_range[1])
    if own.laser_nothing:
        lidar = lidar._replace(nothing=own.laser_nothing)
    return replace(base, limits=limits, footprint=footprint, lidar=lidar)


def parameters_of(scenario: Scenario) -> list[str]:
    """ROS arguments that give a node a scenario's robot, settings and errors."""
    config = effective_config(scenario)._replace(period=SIMULATED_PERIOD)
    return ros_arguments(scenario.robot, config, scenario.preset, period=SIMULATED_PERIOD)


def ros_arguments(
    robot: Robot, config: NavigatorConfig, preset: Preset = "default", **more: float
) -> list[str]:
    """ROS arguments that give a node a robot, the settings that are not the preset's, and ``more``."""
    words = ["--ros-args"]
    for name, value in {**_parameters(robot, config, preset), **more}.items():
        words += ["-p", f"{name}:={_yaml(value)}"]
    return words


def _yaml(value: Any) -> str:
    """A value as YAML has it."""
    if isinstance(value, list):
        return f"[{', '.join(map(_yaml, value))}]"
    special = isinstance(value, float) and not math.isfinite(value)
    return f"{value}".replace("nan", ".nan").replace("inf", ".inf") if special else f"{value}"


def _parameters(robot: Robot, config: NavigatorConfig, preset: Preset) -> dict[str, Any]:
    """The node's parameters that differ from its defaults, and all that tells of the robot.

    The lidar's mount is left to tf unless the robot has another one than the built-in robot.
    """
    base = robot.name if robot.name in ROBOTS else next(iter(ROBOTS))
    found: dict[str, Any] = {"robot": base}
    found["preset"], usual = preset, flat(configured(preset))
    found |= {name: value for name, value in flat(config).items() if value != usual[name]}
    found |= {f"limits.{name}": value for name, value in robot.limits._asdict().items()}
    if robot.footprint.is_disc:
        found["radius"] = robot.footprint.circumscribed
    else:
        found["polygon"] = [float(value) for value in robot.footprint.vertices.reshape(-1)]
    lidar = robot.lidar
    if lidar.mount != ROBOTS[base].lidar.mount:
        found["laser_pose"] = [float(value) for value in lidar.mount]
    if "scan_age" in found:
        found["data_age"] = max(NodeSettings().data_age, config.scan_age)
    found |= {"laser_beams": lidar.beams, "laser_fov": float(lidar.fov)}
    found["laser_range"] = [float(lidar.range_min), float(lidar.range_max)]
    if lidar.nothing:
        found["laser_nothing"] = [float(value) for value in lidar.nothing]
    return found


def robot_table(robot: Robot) -> dict[str, Any]:
    """A robot as plain data, for a recording."""
    return {
        "name": robot.name,
        "limits": robot.limits._asdict(),
        "lidar": robot.lidar._asdict(),
        "radius": robot.footprint.circumscribed,
        "polygon": robot.footprint.vertices.tolist(),
    }


def robot_from(table: Mapping[str, Any]) -> Robot:
    """The robot of a ``robot_table``; ConfigError where it is none."""
    try:
        polygon = table["polygon"]
        shape = Footprint.polygon(polygon) if polygon else Footprint.disc(float(table["radius"]))
        limits = checked(Limits, table["limits"], "limits")
        return Robot(str(table["name"]), limits, shape, checked(Lidar, table["lidar"], "lidar"))
    except (KeyError, TypeError, ValueError) as error:
        raise ConfigError(f"a robot's table cannot be read: {error}") from None
