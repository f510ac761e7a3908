"""ROS parameters: the node's own, and one for every setting of the navigator and limit of the robot."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

from dynastar.config import Field, checked, choose
from dynastar.navigator import NavigatorConfig, Preset, configured
from dynastar.robot import ROBOTS, Footprint, Limits, Robot
from dynastar.ros.localization import PoseSource

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
    pose_source: Annotated[PoseSource, Field("odometry alone, or corrected by amcl_pose")] = "odom"
    laser_pose: Annotated[
        tuple[float, ...], Field("x, y, yaw of the lidar; empty: as built in", "", -10.0, 10.0)
    ] = ()
    enable_stamped_cmd_vel: Annotated[bool, Field("TwistStamped instead of Twist")] = False
    data_age: Annotated[float, AGE] = 0.2
    speed_filter_type: Annotated[
        Literal["percent", "absolute"], Field("meaning of the speed mask")
    ] = "percent"
    speed_filter_base: Annotated[float, Field("limit where the mask is 0", "", -1e3, 1e3)] = 100.0
    speed_filter_multiplier: Annotated[float, Field("of the mask's value", "", -1e3, 1e3)] = -1.0


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


class Parameters:
    """A node's parameters as checked settings."""

    def __init__(self, node: Node) -> None:
        self.node = node
        own = {name: _declare(node, name, field, NodeSettings._field_defaults[name])
               for name, field in fields_of(NodeSettings).items()}  # fmt: skip
        self.settings = checked(NodeSettings, own)
        base = choose(self.settings.robot, ROBOTS, "robot")
        limits = _declare_all(node, base.limits, "limits.")
        self.robot = self._robot(base, checked(Limits, limits, "limits"))
        preset = configured(self.settings.preset)
        self._defaults = flat(preset)
        self.config = self.changed(_declare_all(node, preset, ""))

    def changed(self, values: Mapping[str, Any]) -> NavigatorConfig:
        """The configuration with parameters changed; ConfigError where one is illegal."""
        known = {name: value for name, value in values.items() if name in self._defaults}
        present = getattr(self, "config", None)
        base = self._defaults if present is None else flat(present)
        return configured(self.settings.preset, nested({**base, **known}))

    def is_setting(self, name: str) -> bool:
        """Whether a parameter is one of the navigator's settings, which may change while it runs."""
        return name in self._defaults

    def _robot(self, base: Robot, limits: Limits) -> Robot:
        footprint, lidar, own = base.footprint, base.lidar, self.settings
        if own.radius > 0.0:
            footprint = Footprint.disc(own.radius)
        if own.polygon:
            footprint = Footprint.polygon(
                list(zip(own.polygon[::2], own.polygon[1::2], strict=True))
            )
        if own.laser_pose:
            x, y, yaw = own.laser_pose
            lidar = lidar._replace(x=x, y=y, theta=yaw)
        return replace(base, limits=limits, footprint=footprint, lidar=lidar)


def _declare_all(node: Node, values: Any, prefix: str) -> dict[str, Any]:
    """Declares the fields of a tuple of settings; their values by dotted name without the prefix."""
    fields = fields_of(type(values))
    return {
        name: _declare(node, f"{prefix}{name}", fields.get(name, Field("")), value)
        for name, value in flat(values).items()
    }


def _declare(node: Node, name: str, field: Field, default: Any) -> Any:
    unit = f" ({field.unit})" if field.unit else ""
    described = ParameterDescriptor(description=f"{field.doc}{unit}", dynamic_typing=True)
    if abs(field.low) < float("inf"):
        if isinstance(default, int) and not isinstance(default, bool):
            described.integer_range = [
                IntegerRange(
                    from_value=int(field.low), to_value=int(min(field.high, 2**62)), step=0
                )
            ]
        elif isinstance(default, float):
            described.floating_point_range = [
                FloatingPointRange(
                    from_value=float(field.low), to_value=float(field.high), step=0.0
                )
            ]
    value = list(default) or None if isinstance(default, tuple) else default
    node.declare_parameter(name, value, described)
    found = node.get_parameter(name).value
    if isinstance(default, tuple):
        return tuple(found or ())
    if isinstance(default, float) and isinstance(found, int):
        return float(found)
    return default if found is None else found
