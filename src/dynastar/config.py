"""One way to read settings: declared types and ranges, and the nearest right name for a wrong one.

A configuration is a NamedTuple whose fields are annotated with what they mean::

    class DwaConfig(NamedTuple):
        horizon: Annotated[float, Field("how far ahead to score", "s", 0.1, 30.0)] = 3.0

``checked`` turns a plain mapping (from TOML, the command line, ROS parameters) into such a tuple.
"""

import difflib
import functools
import math
import reprlib
import types
from collections.abc import Iterable, Mapping
from numbers import Integral, Real
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

from dynastar.errors import ConfigError

T = TypeVar("T")


class Field(NamedTuple):
    """Description of a setting: one line of doc, its unit, and its smallest and largest legal value.

    NaN is legal only where ``nan_is_legal``.
    """

    doc: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    nan_is_legal: bool = False


_ANY = Field("")  # a value of any size
LONGEST_TEXT = 400  # characters of what ``print`` shows of an object
_REPR = reprlib.Repr()  # looks at the start of long and deep values only
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = 80
_REPR.maxlevel = 3


def shown(value: Any) -> str:
    """``value`` as it would be written in Python, cut to what fits a message."""
    try:
        text = _REPR.repr(value)
    except ValueError:  # an integer of thousands of digits
        text = f"a huge {type(value).__name__}"
    return text if len(text) <= 80 else f"{text[:77]}..."


def summary(thing: Any, *facts: str) -> str:
    """Text of an object for ``print``: its class and facts about it, at most 400 characters."""
    return _cut(f"<{type(thing).__name__}: {', '.join(filter(None, facts))}>")


def counted(count: int, one: str) -> str:
    """``count`` of a thing in words, as "2 goals"; nothing for none."""
    return f"{count} {one}{'' if count == 1 else 's'}" if count else ""


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - 4]}...{text[-1]}"


def nearest(name: str, legal: Iterable[str]) -> str:
    """`` (did you mean 'x'?)`` for the legal name nearest to ``name``, or the list of them."""
    names = list(legal)
    close = difflib.get_close_matches(name[:80], names, n=3, cutoff=0.5)
    if close:  # letters that have changed places are the likeliest slip
        likeliest = max(close, key=lambda one: sorted(one) == sorted(name))
        return f" (did you mean '{likeliest}'?)"
    return f" (legal: {', '.join(sorted(names))})" if names else ""


def choose(name: str, table: Mapping[str, T], what: str) -> T:
    """``table[name]``, or a ConfigError that names the nearest entry."""
    if name not in table:
        raise ConfigError(f"unknown {what} '{name}'{nearest(name, table)}")
    return table[name]


def checked(cls: type[T], values: Mapping[str, Any], where: str = "") -> T:
    """An instance of the NamedTuple ``cls`` with ``values`` cast and checked over its defaults.

    ``where`` is the dotted name of the table the values come from and leads every message.
    Raises ConfigError for an unknown or missing key, a wrong type, or a value out of range.
    """
    if not isinstance(values, Mapping):
        raise ConfigError(f"{where or cls.__name__}: expected a table, got {shown(values)}")
    return cls(**_cast_all(cls, values, f"{where}." if where else ""))


def self_checking(cls: type[T]) -> type[T]:
    """A class decorator for a NamedTuple of settings: what it is made of is cast and checked.

    As by ``checked``, also by ``_replace``. An int where a float is declared becomes one, so that no
    kernel is compiled again for it. ``repr`` shows what differs from the defaults.
    """
    names: tuple[str, ...] = cls._fields  # type: ignore[attr-defined]
    defaults: dict[str, Any] = cls._field_defaults  # type: ignore[attr-defined]

    @functools.wraps(cls.__new__)
    def new(kind: type[T], *args: Any, **more: Any) -> T:
        if len(args) > len(names):
            raise ConfigError(f"{cls.__name__} has {len(names)} values, got {len(args)}")
        given = dict(zip(names, args, strict=False))
        twice = next((name for name in more if name in given), None)
        if twice is not None:
            raise ConfigError(f"'{cls.__name__}.{twice}' is given twice")
        values = _cast_all(cls, given | more, f"{cls.__name__}.")
        filled = (values.get(name, defaults.get(name)) for name in names)
        made: Any = tuple.__new__(kind, filled)  # type: ignore[type-var]
        return cast(T, made)

    def replaced(self: Any, **changes: Any) -> Any:
        return type(self)(**{**self._asdict(), **changes})

    def text(self: Any) -> str:
        pairs = zip(names, self, strict=True)
        given = (f"{k}={v!r}" for k, v in pairs if k not in defaults or v != defaults[k])
        return _cut(f"{cls.__name__}({', '.join(given)})")

    cls.__new__ = new  # type: ignore[method-assign, assignment]
    cls.__repr__ = text  # type: ignore[method-assign]
    cls._replace = replaced  # type: ignore[attr-defined]
    return cls


@functools.cache
def _hints(cls: Any) -> dict[str, Any]:
    return get_type_hints(cls, include_extras=True)


def _cast_all(cls: type[Any], values: Mapping[str, Any], dotted: str) -> dict[str, Any]:
    """The values of a settings tuple, cast and checked; ``dotted`` leads every name in a message."""
    hints = _hints(cast(Any, cls))
    for key in values:
        if key not in hints:
            raise ConfigError(f"unknown key '{dotted}{key!s:.80}'{nearest(str(key), hints)}")
    defaults: dict[str, Any] = getattr(cls, "_field_defaults", {})
    for key in hints:
        if key not in values and key not in defaults:
            raise ConfigError(f"missing key '{dotted}{key}'")
    return {key: _cast(hints[key], value, f"{dotted}{key}") for key, value in values.items()}


def _cast(hint: Any, value: Any, where: str, field: Field = _ANY) -> Any:
    if get_origin(hint) is Annotated:
        hint, *notes = get_args(hint)
        field = next((note for note in notes if isinstance(note, Field)), field)
    origin = get_origin(hint)
    if origin in (Union, types.UnionType):
        options = get_args(hint)
        if value is None and type(None) in options:
            return None
        return _cast(next(o for o in options if o is not type(None)), value, where, field)
    if origin is Literal:
        options = get_args(hint)
        if value not in options:
            raise ConfigError(
                f"'{where}' is {shown(value)}: expected one of {', '.join(map(repr, options))}"
            )
        return value
    if origin is tuple:
        return _cast_tuple(hint, value, where, field)
    if hasattr(hint, "_field_defaults"):
        return value if isinstance(value, hint) else checked(hint, value, where)
    if hint is bool:
        if not isinstance(value, bool):
            raise ConfigError(f"'{where}' is {shown(value)}: expected true or false")
        return value
    if hint is int or hint is float:
        return _cast_number(hint, value, where, field)
    if hint is str:
        if not isinstance(value, str):
            raise ConfigError(f"'{where}' is {shown(value)}: expected a string")
        return value
    return value


def _cast_tuple(hint: Any, value: Any, where: str, field: Field) -> tuple[Any, ...]:
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
        raise ConfigError(f"'{where}' is {shown(value)}: expected a list")
    items, kinds = list(value), get_args(hint)
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        kinds = (kinds[0],) * len(items)
    if len(items) != len(kinds):
        raise ConfigError(f"'{where}' has {len(items)} values: expected {len(kinds)}")
    return tuple(
        _cast(kind, item, f"{where}[{i}]", field)
        for i, (kind, item) in enumerate(zip(kinds, items, strict=True))
    )


def _cast_number(hint: Any, value: Any, where: str, field: Field) -> float:
    unit = f" {field.unit}" if field.unit else ""
    legal = f"from {field.low:g} to {field.high:g}{unit}"
    if not _is_number(value):
        raise ConfigError(f"'{where}' is {shown(value)}: expected a number {legal}")
    if not (field.low <= value <= field.high or (field.nan_is_legal and math.isnan(value))):
        raise ConfigError(
            f"'{where}' is {shown(value)}{unit}: legal is {legal}{_as_radians(value, field)}"
        )
    if hint is int and not (isinstance(value, Integral) or float(value).is_integer()):
        raise ConfigError(f"'{where}' is {shown(value)}: expected a whole number {legal}")
    try:
        return hint(value)
    except OverflowError:
        raise ConfigError(f"'{where}' is {shown(value)}: legal is {legal}") from None


def _as_radians(value: Any, field: Field) -> str:
    """A hint for an angle that must be meant in degrees, else nothing."""
    radians = math.radians(value) if field.unit == "rad" and abs(value) <= 720.0 else math.nan
    if not field.low <= radians <= field.high:
        return ""
    return f", and {value:g} degrees are {radians:.4f} rad"


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
