"""What a check finds: sentences, each with its level and with what would be right."""

import math
from collections.abc import Callable, Mapping
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


def at_most(value: float, digits: int = 2) -> str:
    """A number of advice, rounded down so that the number itself follows the advice."""
    return _rounded(value, digits, math.floor)


def at_least(value: float, digits: int = 2) -> str:
    """A number of advice, rounded up so that the number itself follows the advice."""
    return _rounded(value, digits, math.ceil)


def _rounded(value: float, digits: int, rounding: Callable[[float], int]) -> str:
    if value <= 0.0:
        return "0"
    places = digits - 1 - math.floor(math.log10(value))
    exact = round(value * 10.0**places, 6)  # 0.3 / 0.1 is no 3
    return f"{rounding(exact) / 10.0**places:.{digits + 1}g}"
