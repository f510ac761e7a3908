"""What a check finds: sentences, each with its level and with what would be right."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Level = Literal["ok", "warning", "problem"]
LEVELS: tuple[Level, ...] = ("ok", "warning", "problem")


@dataclass(frozen=True)
class Finding:
    """One sentence of a check.

    ``name`` is what was looked at, ``advice`` what would be right, empty where nothing has to change.
    ``values`` are the numbers behind the sentence by name, in SI units.
    """

    name: str
    level: Level
    text: str
    advice: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)

    def words(self) -> str:
        """The sentence with its advice."""
        return f"{self.text} {self.advice}".strip()


def worst(*levels: Level) -> Level:
    """The worst of levels."""
    return max(levels, key=LEVELS.index)
