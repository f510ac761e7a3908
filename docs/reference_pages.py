"""Writes the reference pages from the definitions in the code: commands, settings, scenarios, Python."""

import argparse
import inspect
import math
import re
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

import dynastar
from dynastar.cli import build_parser
from dynastar.config import Field
from dynastar.io.scenario_schema import scenario_schema

LARGEST_SHOWN = 1e15  # of a range; beyond it any number will do
LONGEST_NUMBER = 10  # characters of a default

MODULES = {
    "dynastar.masks": ("SpeedScale", "with_keepout", "with_speed_limits"),
    "dynastar.planning": (
        *("ALGORITHMS", "PLANNERS", "Planner", "plan_by", "HeuristicConfig"),
        *("SearchGrid", "SearchResult", "smooth", "straighten", "segment_clear"),
    ),
    "dynastar.check": ("check_robot", "Check", "Finding", "Passage"),
    "dynastar.io": ("load_robot", "save_ros_map", "load_ros_map", "load_scenarios", "write_json"),
    "dynastar.metrics": ("Metrics", "measure"),
    "dynastar.viewer.figure": (
        *("draw_map", "draw_plan", "draw_world", "draw_mission", "draw_episode"),
        *("episode_view", "label_axes", "label_speeds"),
    ),
    "dynastar.viewer.animation": ("animate_episode",),
    "dynastar.viewer.panels": ("Searched", "draw_searches", "draw_unaware", "draw_driven"),
    "dynastar.viewer.commands": ("draw_commands",),
    "dynastar.viewer.intervals": ("Measure", "draw_intervals"),
    "dynastar.viewer.spread": ("Spread", "Column", "draw_spreads", "draw_columns", "draw_parts"),
    "dynastar.page": ("write_report", "framed"),
    "dynastar.smoothness": (
        "smoothness",
        "jerk",
        "angular_acceleration",
        "omega_changes",
        "circles",
        "turning_angle",
    ),
}


def write(folder: Path) -> None:
    """Writes the pages into ``folder``, and leaves those alone that are as they should be."""
    folder.mkdir(exist_ok=True)
    pages = {
        "commands.md": commands(),
        "settings.md": settings(),
        "scenario.md": scenario(),
        "python.rst": python(),
    }
    for name, text in pages.items():
        page = folder / name
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")


def commands() -> str:
    """Every command's --help."""
    parser = build_parser()
    parts = ["# Commands", "", "What `dynastar --help` and `dynastar COMMAND --help` print.", ""]
    [choice] = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]
    for name, command in (("dynastar", parser), *choice.choices.items()):
        title = name if command is parser else f"dynastar {name}"
        parts += [f"## {title}", "", "```text", command.format_help().rstrip(), "```", ""]
    return "\n".join(parts)


def settings() -> str:
    """Every setting of the navigator, from the schema of scenarios."""
    table = scenario_schema()["properties"]["navigator"]
    parts = [
        "# Settings of the navigator",
        "",
        "Given as keyword arguments of `NavigatorConfig`, in `[navigator]` of a scenario file, or with",
        "`--set KEY=VALUE`. Illegal values are refused with the legal range. The no-contact guarantee",
        "assumes the bounds that are declared here.",
        "",
    ]
    return "\n".join([*parts, *_tables("[navigator]", table)])


def scenario() -> str:
    """Every key of a scenario file."""
    schema = scenario_schema()
    shown = {key: of for key, of in schema["properties"].items() if key != "navigator"}
    parts = [
        "# Scenario files",
        "",
        "TOML. `dynastar schema --out scenario.schema.json` writes the JSON Schema: with",
        "`#:schema scenario.schema.json` in the first line, editors complete and check the file. Each",
        "feature has a complete example in `examples/features`. `[navigator]` holds the",
        "[settings of the navigator](settings.md).",
        "",
    ]
    return "\n".join([*parts, *_tables("", {**schema, "properties": shown})])


def python() -> str:
    """What `import dynastar` offers, and the modules that are public besides."""
    parts = ["Python", "======", ""]
    for name in dynastar.__all__:
        if name != "__version__":
            parts += _documented("dynastar", name)
    for module, names in MODULES.items():
        parts += [module, "-" * len(module), ""]
        for name in names:
            parts += _documented(module, name)
    return "\n".join(parts)


def _documented(module: str, name: str) -> list[str]:
    thing = getattr(__import__(module, fromlist=[name]), name)
    if inspect.isclass(thing) and hasattr(thing, "_field_defaults"):
        return _documented_tuple(f"{module}.{name}", thing)
    if inspect.isclass(thing):
        return [f".. autoclass:: {module}.{name}", "   :members:", ""]
    if inspect.isfunction(inspect.unwrap(thing)):
        return [f".. autofunction:: {module}.{name}", ""]
    kinds = (
        ", ".join(f"``{value!s:.40}``" for value in thing)
        if isinstance(thing, dict | tuple)
        else ""
    )
    values = getattr(thing, "__args__", ())
    kinds = kinds or ", ".join(f"``{value!r}``" for value in values)
    return [f".. py:data:: {module}.{name}", "", f"   {kinds}", ""]


def _documented_tuple(name: str, cls: Any) -> list[str]:
    """A named tuple: its docstring, a table of its fields, and its methods."""
    defaults, hints = cls._field_defaults, get_type_hints(cls, include_extras=True)
    shown = (f"{key}={_shown(defaults[key])}" if key in defaults else key for key in hints)
    fields = ", ".join(hints)
    parts = [f".. autoclass:: {name}({', '.join(shown)})", "   :members:"]
    parts += [f"   :exclude-members: {fields}", ""]
    header = ("name", "type", "unit", "range", "default", "meaning")
    rows = [header, *(_field_row(key, hint, defaults) for key, hint in hints.items())]
    used = [i for i in range(len(header)) if any(row[i] for row in rows[1:])]
    parts += ["   .. list-table::", "      :header-rows: 1", ""]
    for row in rows:
        cells = [row[i] for i in used]
        parts += [f"      * - {cells[0]}", *(f"        - {cell}" for cell in cells[1:])]
    return [*parts, ""]


def _field_row(name: str, hint: Any, defaults: dict[str, Any]) -> tuple[str, ...]:
    """The cells of a field's row."""
    field = Field("")
    if get_origin(hint) is Annotated:
        hint, field = get_args(hint)[:2]
    low, high = field.low, field.high
    legal = f"{low:g} to {high:g}" if math.isfinite(low) and high <= LARGEST_SHOWN else ""
    default = f"``{_shown(defaults[name])}``" if name in defaults else ""
    nested = hint.__doc__.partition("\n")[0] if hasattr(hint, "_field_defaults") else ""
    return f"``{name}``", _type(hint), field.unit, legal, default, field.doc or nested


def _shown(value: Any) -> str:
    """A default as it is written in Python; of settings the class alone."""
    if hasattr(value, "_field_defaults"):
        return f"{type(value).__name__}(...)" if value else f"{type(value).__name__}()"
    long = isinstance(value, float) and len(repr(value)) > LONGEST_NUMBER
    return f"{value:.6g}" if long else repr(value)


def _type(hint: Any) -> str:
    """A declared type in words."""
    if get_origin(hint) is Literal:
        return ", ".join(f"``{value!r}``" for value in get_args(hint))
    if hint is type(None):
        return "None"
    if get_origin(hint) in (Union, types.UnionType):
        return " or ".join(_type(one) for one in get_args(hint))
    if get_origin(hint) is Annotated:
        return _type(get_args(hint)[0])
    if get_origin(hint) in (tuple, list):
        inner = [one for one in get_args(hint) if one is not Ellipsis]
        kind = get_origin(hint).__name__
        return f"{kind} of {', '.join(dict.fromkeys(map(_type, inner)))}"
    if get_origin(hint) is np.ndarray:
        return "array"
    return str(getattr(hint, "__name__", hint))


def _tables(name: str, schema: dict[str, Any]) -> Iterator[str]:
    """A table of keys for an object, and then for each object in it."""
    nested = []
    yield from [f"## `{name}`" if name else "## The file", ""]
    if schema.get("description"):
        words = schema["description"].replace("``", "`")
        yield from [words[0].upper() + words[1:], ""]
    yield from ["| key | type | unit | range | default | meaning |", "|:--|:--|:--|:--|:--|:--|"]
    for key, of in schema["properties"].items():
        inner = _objects(of)
        if inner:
            path = f"{name.strip('[]')}.{key}" if name else key
            nested.append((f"[[{path}]]" if of.get("type") == "array" else f"[{path}]", inner))
        shown = _default(of.get("default")) or of.get("otherwise", "")
        if key in schema.get("required", ()):
            shown = "required"
        unit = of.get("unit", "")
        words = of.get("description", "").removesuffix(f" ({unit})").replace("``", "`")
        words = re.split(r"(?<!Eq)\. ", words)[0] if inner else words
        yield f"| `{key}` | {_kind(of)} | {unit} | {_range(of)} | {shown} | {words} |"
    yield ""
    for path, inner in nested:
        yield from _tables(path, inner)


def _objects(schema: dict[str, Any]) -> dict[str, Any] | None:
    """The table in a value's schema, if there is one."""
    choices = [schema, schema.get("items", {}), *schema.get("oneOf", ())]
    return next((of for of in choices if of.get("type") == "object"), None)


def _kind(schema: dict[str, Any]) -> str:
    """A value's type and range in words."""
    if "oneOf" in schema:
        return " or ".join(_kind(of) for of in schema["oneOf"])
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if schema.get("type") == "array":
        if "prefixItems" in schema:
            return f"{len(schema['prefixItems'])} numbers"
        inner = schema.get("items", {})
        if "prefixItems" in inner:
            return f"list of {_kind(inner)} each"
        if "oneOf" in inner:
            return f"list, each {_kind(inner)}"
        return "list of tables" if _objects(schema) else f"list of {inner.get('type', 'value')}s"
    if schema.get("type") == "object":
        return "table"
    return str(schema.get("type", ""))


def _range(schema: dict[str, Any]) -> str:
    """A value's range in words."""
    inner: dict[str, Any] = schema
    while "minimum" not in inner and ("items" in inner or "prefixItems" in inner):
        items = inner.get("items") or inner["prefixItems"][0]
        if "prefixItems" in inner and any(one != items for one in inner["prefixItems"]):
            return ""
        inner = items
    low, high = inner.get("minimum"), inner.get("maximum")
    if low is None:
        return ""
    return f"from {low:g}" if high is None or high > LARGEST_SHOWN else f"{low:g} to {high:g}"


def _default(value: Any) -> str:
    """A default as it is written in a scenario file."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{_shown(value) if isinstance(value, float) else value}`"
