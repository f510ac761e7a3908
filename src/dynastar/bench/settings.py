"""Settings of the navigator by dotted name, as ``--set`` takes them."""

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from dynastar.errors import ConfigError
from dynastar.navigator.config import configured


def parsed(pairs: Sequence[str]) -> dict[str, Any]:
    """The nested table that ``KEY=VALUE`` pairs stand for; ConfigError for one that is none.

    A key is a dotted name below ``[navigator]`` (``dwa.weights.vel``); a value is written as in TOML,
    a word without quotes.
    """
    table: dict[str, Any] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        names = [name.strip() for name in key.split(".")]
        if not equals or not all(names):
            raise ConfigError(f"--set {pair!r}: expected KEY=VALUE, as in dwa.weights.vel=0.3")
        nested: Any = _value(text.strip())
        for name in reversed(names):
            nested = {name: nested}
        table = merged(table, nested)
    return table


def read_settings(
    pairs: Sequence[str], preset: str, base: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """The table of ``parsed``, checked as the settings of a scenario file are.

    ``base`` are the scenario's own settings. Raises ConfigError, which names the nearest right key.
    """
    table = parsed(pairs)
    try:
        configured(preset, merged(base or {}, table))
    except ConfigError as error:
        raise ConfigError(f"--set: {error}") from None
    return table


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with ``over`` on top, table by table."""
    result = dict(base)
    for key, value in over.items():
        nested = isinstance(value, Mapping) and isinstance(result.get(key), Mapping)
        result[key] = merged(result[key], value) if nested else value
    return result


def _value(text: str) -> Any:
    try:
        table = tomllib.loads(f"value = {text}")
    except ValueError:
        return text
    return table["value"] if set(table) == {"value"} else text
