"""Every setting in which the presets differ, in one table."""

from collections.abc import Iterator
from typing import Any, get_type_hints

from dynastar.bench.tables import Cell, Table
from dynastar.config import Field
from dynastar.navigator import PRESETS

ORDER = ("paper", "default")


def settings_of(config: Any, where: str = "") -> Iterator[tuple[str, str, Any]]:
    """Every setting of a config, nested ones too: its dotted name, what it means, its value."""
    hints = get_type_hints(type(config), include_extras=True)
    for name, value in config._asdict().items():
        if hasattr(value, "_asdict"):
            yield from settings_of(value, f"{where}{name}.")
        else:
            field = next(note for note in hints[name].__metadata__ if isinstance(note, Field))
            unit = f" ({field.unit})" if field.unit else ""
            yield where + name, f"{field.doc}{unit}", value


def table() -> Table:
    """A line for each setting that is not the same in all presets."""
    lines: list[tuple[Cell, ...]] = []
    for found in zip(*(settings_of(PRESETS[name]) for name in ORDER), strict=True):
        values = [_words(value) for _, _, value in found]
        if len(set(values)) > 1:
            name, doc, _ = found[0]
            lines.append((f"`{name}`", *values, doc))
    columns = (("setting", ""), *((name, "") for name in ORDER), ("what it is", "<"))
    return Table("presets", "The presets, where they differ", columns, lines)


def _words(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)
