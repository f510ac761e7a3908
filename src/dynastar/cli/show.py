"""How results reach stdout: JSON alone, or an aligned table."""

import json
from collections.abc import Mapping
from typing import Any

from dynastar.io import jsonable


def as_json(data: Mapping[str, Any]) -> str:
    """``data`` as JSON in which every number is finite: what is not becomes null."""
    return json.dumps(jsonable(data), allow_nan=False)


def as_table(data: Mapping[str, Any]) -> str:
    """``data`` as two aligned columns; None is a dash, floats have three decimals."""
    width = max(map(len, data))
    return "\n".join(f"{name:<{width}}  {_shown(value)}" for name, value in data.items())


def _shown(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if isinstance(value, float) else str(value)
