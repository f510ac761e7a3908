"""A YAML file as a mapping: no tags, aliases or doubled keys, and 1e-05 is a number (YAML 1.2)."""

import re
from pathlib import Path
from typing import Any

import yaml

from dynastar.errors import MapError


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader without what a settings file never needs and an attacker does."""

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            raise yaml.composer.ComposerError(None, None, "aliases are not read here")
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [key for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        seen: set[str] = set()
        for key in keys:
            if key.value in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key.value:.40}' is there twice", key.start_mark
                )
            seen.add(key.value)
        return super().construct_mapping(node, deep)


# PyYAML lets out what Python says of a tagged value that is none.
_BROKEN = yaml.YAMLError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError

_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?[0-9]+(\.[0-9]*)?[eE][-+]?[0-9]+$"),
    list("-+0123456789"),
)


def read_yaml(data: bytes, path: Path) -> dict[Any, Any]:
    """The mapping in a YAML file's ``data``; ``path`` is for the messages. Raises MapError."""
    try:
        table = yaml.load(data, _Loader)
    except yaml.MarkedYAMLError as error:
        where = f" in line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise MapError(f"{path}: this is not valid YAML{where}: {error.problem!s:.100}") from None
    except RecursionError:
        raise MapError(f"{path}: this YAML is nested too deep") from None
    except _BROKEN as error:
        reason = " ".join(str(error).split())
        raise MapError(f"{path}: this is not valid YAML: {reason:.100}") from None
    if not isinstance(table, dict):
        raise MapError(f"{path}: expected keys and values, as in 'resolution: 0.05'")
    return table
