"""Messages by rclpy's classes, and which of ROS 2's optional packages are installed."""

import array
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

TYPECODES = {np.dtype(np.int8): "b", np.dtype(np.float32): "f"}


@cache
def message_class(name: str) -> Any:
    """The class of a type such as "std_msgs/msg/Header", None where its package is not installed."""
    package, kind, last = name.split("/")
    try:
        return getattr(import_module(f"{package}.{kind}"), last)
    except ImportError:
        return None


def make(name: str, /, **fields: Any) -> Any:
    """A message of a type; arrays go in as arrays, since lists are checked item by item."""
    for key, value in fields.items():
        if isinstance(value, np.ndarray):
            fields[key] = array.array(TYPECODES[value.dtype], value.tobytes())
    return message_class(name)(**fields)
