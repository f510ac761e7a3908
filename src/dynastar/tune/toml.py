"""TOML with comments."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any


def toml_text(table: Mapping[str, Any], comments: Mapping[str, str], head: Sequence[str]) -> str:
    """Nested tables as TOML; ``comments`` by dotted key stand above it, ``head`` leads the file."""
    lines = [f"# {line}".rstrip() for line in head]
    _add(table, "", comments, lines)
    return "\n".join(lines) + "\n"


def rounded(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values with their floats rounded to six digits."""
    return {
        key: float(f"{value:.6g}") if isinstance(value, float) else value
        for key, value in values.items()
    }


def _add(
    table: Mapping[str, Any], where: str, comments: Mapping[str, str], lines: list[str]
) -> None:
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    if where and plain:
        lines += ["", f"[{where}]"]
    for key, value in plain.items():
        dotted = f"{where}.{key}" if where else key
        lines += [f"# {line}" for line in comments.get(dotted, "").splitlines()]
        lines.append(f"{key} = {_value(value)}")
    for key, value in table.items():
        if isinstance(value, Mapping):
            _add(value, f"{where}.{key}" if where else key, comments, lines)


def _value(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        value = float(value)  # numpy's own has another repr
        if not math.isfinite(value):
            return "nan" if math.isnan(value) else ("inf" if value > 0.0 else "-inf")
        return repr(value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {_value(one)}' for key, one in value.items())} }}"
    return str(value)
