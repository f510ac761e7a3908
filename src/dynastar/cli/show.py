"""How results reach stdout: JSON alone, or an aligned table."""

from collections.abc import Mapping
from typing import Any

from dynastar import io
from dynastar.terminal import printable

# Of the numbers that commands print, by name.
UNITS = {
    "time": "s",
    "wall_s": "s",
    "cpu_s": "s",
    "length": "m",
    "grid_length": "m",
    "min_clearance": "m",
    "time_ms": "ms",
    "command_ms_mean": "ms",
    "command_ms_max": "ms",
    "tick_ms_median": "ms",
    "tick_ms_p99": "ms",
    "smoothness": "rad/s/m",
    "nearest": "m",
    "jerk": "m/s3",
    "angular_acceleration": "rad/s2",
    "omega_changes": "1/m",
    "turning_angle": "rad",
    "speed": "m/s",
    "resolution": "m",
    "radius": "m",
    "expanded": "cells",
}


def as_json(data: Mapping[str, Any]) -> str:
    """``data`` as JSON in which every number is finite: what is not becomes null."""
    import json

    return json.dumps(io.jsonable(data), allow_nan=False)


def as_table(data: Mapping[str, Any]) -> str:
    """``data`` in aligned columns, with units; None is a dash, floats have three decimals."""
    width = max(map(len, data))
    rows = (f"{name:<{width}}  {_shown(value)}{_unit(name, value)}" for name, value in data.items())
    return "\n".join(rows)


def _shown(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if isinstance(value, float) else printable(str(value))


def _unit(name: str, value: Any) -> str:
    unit = UNITS.get(name.removeprefix("mean_"), "")
    return f" {unit}" if unit and isinstance(value, float | int) else ""


def side_by_side(tables: Mapping[str, Mapping[str, Any]]) -> str:
    """Tables by name in aligned columns, a row for each of their keys; None is a dash."""
    keys = list(dict.fromkeys(key for table in tables.values() for key in table))
    rows = [["", *tables]]
    rows += [[key, *(_shown(table.get(key)) for table in tables.values())] for key in keys]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip()
        for row in rows
    )
