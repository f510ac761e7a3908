"""Text for terminals: names without control characters, and progress also in a pipe."""

import sys
import time
import unicodedata
from collections.abc import Iterable
from io import StringIO
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from tqdm import tqdm

EVERY = 5.0  # s between the lines of progress in a pipe
LINE = "{desc}: {n_fmt} of {total_fmt} [{elapsed}<{remaining}{postfix}]"
_CONTROL = ("Cc", "Cs", "Zl", "Zp")  # categories of characters
_BIDIRECTIONAL = {*map(chr, (*range(0x202A, 0x202F), *range(0x2066, 0x206A)))}


def printable(text: str, keep: str = "") -> str:
    """``text`` with its control characters, but for those in ``keep``, written as escapes."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        letter.encode("unicode_escape").decode("ascii")
        if letter not in keep
        and (unicodedata.category(letter) in _CONTROL or letter in _BIDIRECTIONAL)
        else letter
        for letter in text
    )


class Printable:
    """A stream that writes all control characters but line ends and tabs as escapes."""

    def __init__(self, stream: TextIO | None) -> None:
        self.stream: TextIO = StringIO() if stream is None else stream  # None: it is closed

    def write(self, text: str) -> int:
        """Writes text; letters that the stream's encoding lacks as escapes, too."""
        text = printable(text, keep="\n\t")
        encoding = getattr(self.stream, "encoding", None) or "utf-8"
        return self.stream.write(text.encode(encoding, "backslashreplace").decode(encoding))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


class _Lines:
    """A stream that takes a bar's output and writes a line of it every few seconds."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._said = stream, time.monotonic()

    def write(self, text: str) -> None:
        line, now = text.strip(), time.monotonic()
        if line and now - self._said >= EVERY:
            self._stream.write(f"{line}\n")
            self._stream.flush()
            self._said = now

    def flush(self) -> None:
        """Every line is flushed."""


def progress_bar(items: Iterable[Any] | None = None, desc: str = "", **options: Any) -> "tqdm[Any]":
    """tqdm's bar on stderr; where that is no terminal, a line every few seconds."""
    from tqdm import tqdm

    stream: Any = sys.stderr
    stream = getattr(stream, "stream", stream) if isinstance(stream, Printable) else stream
    if not stream.isatty():
        line = str(options.get("bar_format", LINE)).replace("|{bar}| ", "")
        options |= {"bar_format": line, "mininterval": EVERY}
        stream = _Lines(stream)
    return tqdm(items, desc=printable(desc), file=stream, **options)
