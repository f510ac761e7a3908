"""JSON Schema of scenario files, from the same definitions that check them."""

import math
import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from dynastar.config import Field
from dynastar.io.scenario_tables import (
    MapTable,
    MoverTable,
    ObstacleTable,
    PlaceTable,
    RobotTable,
    ScenarioTable,
)
from dynastar.masks import SpeedScale
from dynastar.navigator import NavigatorConfig
from dynastar.robot import ROBOTS, Lidar, Limits
from dynastar.simulation.scenario import Noise

Schema = dict[str, Any]

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_PLAIN = {bool: "boolean", int: "integer", float: "number", str: "string"}


def scenario_schema() -> Schema:
    """The schema of a scenario file, once TOML has been read as JSON has it."""
    map_ = {"oneOf": [{"type": "string", "description": "a map's file"}, _table(MapTable)]}
    pair = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 3}
    place = {"oneOf": [pair, _table(PlaceTable)]}
    speed_limit = _table(SpeedScale) | {"required": ["mask"]}
    speed_limit["properties"]["mask"] = {**map_, "description": "the mask, drawn as a map"}
    robot = _table(RobotTable)
    robot["properties"]["base"] |= {"enum": list(ROBOTS)}
    robot["properties"]["limits"] = _of_base(_table(Limits))
    sensor = _of_base(_table(Lidar))
    sensor["properties"] |= _table(Noise)["properties"]
    mover = _table(MoverTable)
    mover["properties"] = {name.rstrip("_"): of for name, of in mover["properties"].items()}
    known = {
        "map": map_,
        "world": map_,
        "keepout": map_,
        "speed_limit": speed_limit,
        "robot": {"oneOf": [{"enum": list(ROBOTS)}, robot]},
        "start": place,
        "goal": place,
        "goals": {"type": "array", "items": place},
        "sensor": sensor,
        "obstacles": {"type": "array", "items": _table(ObstacleTable)},
        "movers": {"type": "array", "items": mover},
        "navigator": _optional(_table(NavigatorConfig)),
    }
    schema = _table(ScenarioTable)
    for name, of in known.items():  # a meaning in the file goes before that of a table alone
        schema["properties"][name] = of | schema["properties"][name]
    schema["oneOf"] = [{"required": ["goal"]}, {"required": ["goals"]}]
    return {"$schema": DIALECT, "title": "dynastar scenario", **schema}


def _table(cls: Any, given: Any = None) -> Schema:
    """A table with the keys of a NamedTuple, and the defaults of an instance where one is ``given``."""
    hints = get_type_hints(cls, include_extras=True)
    defaults = cls._field_defaults if given is None else given._asdict()
    properties = {}
    for name, hint in hints.items():
        default = defaults.get(name)
        nested = hasattr(default, "_field_defaults")
        properties[name] = _table(hint, default) if nested else _value(hint)
        if isinstance(default, bool | int | float | str) and default not in ("", math.inf):
            properties[name]["default"] = default
    schema: Schema = {
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "required": [name for name in hints if name not in defaults],
    }
    words = (cls.__doc__ or "").split("\n\n")[0]
    return {"description": " ".join(words.split()), **schema} if words else schema


def _optional(schema: Schema) -> Schema:
    """The same table with nothing that has to be there: it changes what there is."""
    properties = {
        name: _optional(of) if of.get("type") == "object" else of
        for name, of in schema["properties"].items()
    }
    return {**schema, "required": [], "properties": properties}


def _of_base(schema: Schema) -> Schema:
    """A table in which what is not given is that of the base robot: ``otherwise`` says so."""
    schema = _optional(schema)
    for of in schema["properties"].values():
        of.pop("default", None)
        of["otherwise"] = "of the base robot"
    return schema


def _value(hint: Any, field: Field | None = None) -> Schema:
    """Schema of a value of a declared type."""
    if get_origin(hint) is Annotated:
        hint, *notes = get_args(hint)
        field = next((note for note in notes if isinstance(note, Field)), field)
    origin = get_origin(hint)
    if origin in (Union, types.UnionType):
        return _value(next(one for one in get_args(hint) if one is not type(None)), field)
    if origin is Literal:
        return _described({"enum": list(get_args(hint))}, field)
    if origin is tuple:
        return _described(_list(get_args(hint), field), field)
    if hasattr(hint, "_field_defaults"):
        return _table(hint)
    if hint not in _PLAIN:
        return _described({}, field)
    schema: Schema = {"type": _PLAIN[hint]}
    if field is not None and hint in (int, float):
        bounds = (("minimum", field.low), ("maximum", field.high))
        schema |= {name: bound for name, bound in bounds if abs(bound) != float("inf")}
    return _described(schema, field)


def _list(kinds: tuple[Any, ...], field: Field | None) -> Schema:
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        return {"type": "array", "items": _value(kinds[0], field)}
    items = [_value(kind, field) for kind in kinds]
    return {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}


def _described(schema: Schema, field: Field | None) -> Schema:
    if field is None or not field.doc:
        return schema
    unit = f" ({field.unit})" if field.unit else ""
    described = {**schema, "description": f"{field.doc}{unit}"}
    return {**described, "unit": field.unit} if field.unit else described
