"""ROS parameters: the node's own, and one for every setting of the navigator and limit of the robot."""

from collections.abc import Mapping
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import ParameterException
from rclpy.node import Node

from dynastar.config import Field, checked, choose
from dynastar.errors import ConfigError
from dynastar.navigator import NavigatorConfig, configured
from dynastar.robot import ROBOTS, Limits
from dynastar.ros.settings import NodeSettings, fields_of, flat, nested, robot_of


class Parameters:
    """A node's parameters as checked settings.

    Settings of the node in ``left_out`` are not declared; ``defaults`` replace the navigator's.
    """

    def __init__(self, node: Node, left_out: tuple[str, ...] = (), **defaults: Any) -> None:
        self.node = node
        own = {name: declare(node, name, field, NodeSettings._field_defaults[name])
               for name, field in fields_of(NodeSettings).items() if name not in left_out}  # fmt: skip
        self.settings = checked(NodeSettings, own)
        base = choose(self.settings.robot, ROBOTS, "robot")
        limits = _declare_all(node, base.limits, "limits.")
        self.robot = robot_of(base, checked(Limits, limits, "limits"), self.settings)
        preset = configured(self.settings.preset, defaults)
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


def _declare_all(node: Node, values: Any, prefix: str) -> dict[str, Any]:
    """Declares the fields of a tuple of settings; their values by dotted name without the prefix."""
    fields = fields_of(type(values))
    return {
        name: declare(node, f"{prefix}{name}", fields.get(name, Field("")), value)
        for name, value in flat(values).items()
    }


def declare(node: Node, name: str, field: Field, default: Any) -> Any:
    """Declares a parameter and returns its value."""
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
    try:
        node.declare_parameter(name, value, described)
    except ParameterException as error:
        raise ConfigError(f"the parameter '{name}': {' '.join(str(error).split())}") from None
    found = node.get_parameter(name).value
    if isinstance(default, tuple):
        return tuple(found or ())
    if isinstance(default, float) and isinstance(found, int):
        return float(found)
    return default if found is None else found
