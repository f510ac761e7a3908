"""Writes the reference pages from the definitions in the code: commands, settings, scenarios, Python."""

import argparse
import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dynastar
from dynastar.cli import build_parser
from dynastar.io.scenario_schema import scenario_schema

MODULES = {
    "dynastar.masks": ("SpeedScale", "with_keepout", "with_speed_limits"),
    "dynastar.planning": ("Planner", "PLANNERS", "segment_clear"),
    "dynastar.io": ("save_ros_map", "load_ros_map", "load_scenarios", "write_json"),
    "dynastar.metrics": ("Metrics", "measure"),
    "dynastar.smoothness": (
        "smoothness",
        "jerk",
        "angular_acceleration",
        "omega_changes",
        "circles",
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
        "`--set KEY=VALUE`. Illegal values are refused with the legal range.",
        "",
    ]
    return "\n".join([*parts, *_tables("navigator", table)])


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
    if inspect.isclass(thing):
        return [f".. autoclass:: {module}.{name}", "   :members:", ""]
    if inspect.isfunction(thing):
        return [f".. autofunction:: {module}.{name}", ""]
    kinds = (
        ", ".join(f"``{value!s:.40}``" for value in thing)
        if isinstance(thing, dict | tuple)
        else ""
    )
    values = getattr(thing, "__args__", ())
    kinds = kinds or ", ".join(f"``{value!r}``" for value in values)
    return [f".. py:data:: {module}.{name}", "", f"   {kinds}", ""]


def _tables(name: str, schema: dict[str, Any]) -> Iterator[str]:
    """A table of keys for an object, and then for each object in it."""
    nested = []
    yield from [f"## `[{name}]`" if name else "## The file", ""]
    if schema.get("description"):
        yield from [schema["description"].replace("``", "`"), ""]
    yield from ["| key | value | default | meaning |", "|:--|:--|:--|:--|"]
    for key, of in schema["properties"].items():
        inner = _objects(of)
        if inner:
            nested.append((f"{name}.{key}" if name else key, inner))
        default = of.get("default")
        shown = (
            ""
            if default is None
            else f"`{str(default).lower() if default in (True, False) else default}`"
        )
        if key in schema.get("required", ()):
            shown = "required"
        words = of.get("description", "") if not inner or of.get("type") != "object" else ""
        yield f"| `{key}` | {_kind(of)} | {shown} | {words.replace('``', '`')} |"
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
            return f"list of {_kind(inner)}"
        return "list of tables" if _objects(schema) else f"list of {inner.get('type', 'values')}s"
    if schema.get("type") == "object":
        return "table"
    low, high = schema.get("minimum"), schema.get("maximum")
    limits = f", {low:g} to {high:g}" if low is not None and high is not None else ""
    return f"{schema.get('type', '')}{limits}"
