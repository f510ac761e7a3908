"""Settings of the navigator by dotted name, as ``--set`` takes them."""

import ast
from collections.abc import Mapping, Sequence
from typing import Any

from dynastar.errors import ConfigError


def parsed(pairs: Sequence[str]) -> dict[str, Any]:
    """The nested table that ``KEY=VALUE`` pairs stand for; ConfigError for one that is none.

    A key is a dotted name (``dwa.weights.vel``); a value is a number, true, false, a list or a word.
    """
    table: dict[str, Any] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        names = key.strip().split(".")
        if not equals or not all(names):
            raise ConfigError(f"--set {pair!r}: expected KEY=VALUE, as in dwa.weights.vel=0.3")
        nested: Any = _value(text.strip())
        for name in reversed(names):
            nested = {name: nested}
        table = merged(table, nested)
    return table


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with ``over`` on top, table by table."""
    result = dict(base)
    for key, value in over.items():
        nested = isinstance(value, Mapping) and isinstance(result.get(key), Mapping)
        result[key] = merged(result[key], value) if nested else value
    return result


def _value(text: str) -> Any:
    lowered = text.lower()
    if lowered in ("true", "false"):
        return lowered == "true"
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text
