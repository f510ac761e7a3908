"""How results reach stdout: JSON alone, or an aligned table."""

import json
from collections.abc import Mapping
from typing import Any

from dynastar.io import jsonable

# Of the numbers that commands print, by name.
UNITS = {
    "time": "s",
    "wall_s": "s",
    "length": "m",
    "grid_length": "m",
    "min_clearance": "m",
    "time_ms": "ms",
    "command_ms_mean": "ms",
    "command_ms_max": "ms",
    "tick_ms_median": "ms",
    "tick_ms_p99": "ms",
    "smoothness": "rad/s/m",
    "speed": "m/s",
    "resolution": "m",
    "radius": "m",
    "expanded": "cells",
}


def as_json(data: Mapping[str, Any]) -> str:
    """``data`` as JSON in which every number is finite: what is not becomes null."""
    return json.dumps(jsonable(data), allow_nan=False)


def as_table(data: Mapping[str, Any]) -> str:
    """``data`` in aligned columns, with units; None is a dash, floats have three decimals."""
    width = max(map(len, data))
    rows = (f"{name:<{width}}  {_shown(value)}{_unit(name, value)}" for name, value in data.items())
    return "\n".join(rows)


def _shown(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def _unit(name: str, value: Any) -> str:
    unit = UNITS.get(name.removeprefix("mean_"), "")
    return f" {unit}" if unit and isinstance(value, float | int) else ""
