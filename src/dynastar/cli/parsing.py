"""The parser that says what is wrong in one line, and the kinds of values that options take."""

import argparse
import math
import re

from dynastar.config import nearest
from dynastar.errors import InputError

TYPE_CHECKING = False
if TYPE_CHECKING:  # neither is imported for --help
    from collections.abc import Iterable, Mapping
    from pathlib import Path
    from typing import NoReturn


class OneLineParser(argparse.ArgumentParser):
    """A parser that says what is wrong in one line, and takes -1e3 and -inf as numbers."""

    def __init__(self, **settings: object) -> None:
        settings.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        settings.setdefault("allow_abbrev", False)
        super().__init__(**settings)  # type: ignore[arg-type]
        self._negative_number_matcher = re.compile(r"^-(\d|\.\d|inf|nan)", re.IGNORECASE)

    def error(self, message: str) -> "NoReturn":
        """Exits with status 2 and ``message``."""
        self.exit(2, f"{self.prog}: {' '.join(message.split())} (see {self.prog} --help)\n")

    def parse_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]
        """As the original, but names the option that is nearest to an unknown one."""
        known, others = self.parse_known_args(args, namespace)
        if others:
            command = self._commands().get(getattr(known, "command", ""), self)
            command.error(_unknown(others[0], command._option_string_actions))
        return known

    def _commands(self) -> "dict[str, OneLineParser]":
        return next(
            (
                dict(action.choices)
                for action in self._actions
                if isinstance(action, argparse._SubParsersAction)
            ),
            {},
        )

    def _check_value(self, action: argparse.Action, value: object) -> None:
        if action.choices is not None and value not in action.choices:
            what = (action.metavar or action.dest) if not action.option_strings else "value"
            words = (
                f"unknown {str(what).lower()} '{value!s:.80}'{nearest(str(value), action.choices)}"
            )
            raise argparse.ArgumentError(action if action.option_strings else None, words)


def _unknown(word: str, options: "Iterable[str]") -> str:
    """Describe an argument that no option takes."""
    if word.startswith("-"):
        option = word.partition("=")[0]
        return f"unknown option '{option:.80}'{nearest(option, options)}"
    return f"one argument too many: '{word:.80}'"


def path(text: str) -> "Path":
    """A file or folder: a path, which may start with ``~``, or a ``file://`` URL."""
    from dynastar.paths import local_path

    return local_path(text)


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r:.80}: expected a number") from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def distance(text: str) -> float:
    """A finite number of metres, 0 or more."""
    value = number(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is negative: expected 0 m or more")
    return value


def count(text: str) -> int:
    """A whole number, 1 or more."""
    value = _whole(text, "a whole number, 1 or more")
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is too small: expected 1 or more")
    return value


def seed(text: str) -> int:
    """A whole number, 0 or more."""
    value = _whole(text, "a whole number, 0 or more")
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text!r} is negative: expected 0 or more")
    return value


def replayed(text: str) -> tuple[int, int]:
    """A mission's number N, or N:R with its repeat."""
    if not re.fullmatch("[0-9]{1,18}(:[0-9]{0,18})?", text):
        raise argparse.ArgumentTypeError(f"{text!r:.80}: expected a mission's number N, or N:R")
    number, _, repeat = text.partition(":")
    return int(number), int(repeat or "0")


def port(text: str) -> int:
    """A port of TCP, or 0."""
    value = _whole(text, "0 to 65535")
    if not 0 <= value <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is no port: expected 0 to 65535")
    return value


def _whole(text: str, expected: str) -> int:
    """A whole number; raises ArgumentTypeError with what was ``expected``."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r:.80}: expected {expected}") from None


def refuse_unheard(
    arguments: argparse.Namespace, defaults: "Mapping[str, object]", why: str
) -> None:
    """Raises InputError for an option that was given though nothing would come of it."""
    for name, default in defaults.items():
        if getattr(arguments, name) != default:
            raise InputError(f"--{name.replace('_', '-')} {why}")
