"""File names as people write them: ``~`` is the home folder, a ``file://`` URL is a local file."""

import re
from pathlib import Path
from urllib.parse import unquote

from dynastar.errors import InputError

_URL = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):/+")


def local_path(name: str | Path, error: type[InputError] = InputError) -> Path:
    """The path that a name stands for; raises ``error`` for the URL of what is no local file."""
    text = str(name)
    found = _URL.match(text)
    if found is not None:
        if found[1].lower() != "file":
            raise error(f"{text:.200}: this is a URL, expected a file on this computer")
        text = _of_url(text, error)
    try:
        return Path(text).expanduser() if text.startswith("~") else Path(text)
    except RuntimeError:  # no such user: the name of a file that begins with ~
        return Path(text)


def _of_url(text: str, error: type[InputError]) -> str:
    """The path in a ``file:`` URL, also with one slash, which is what ``pathlib`` leaves of three."""
    rest = unquote(text.partition(":")[2])
    if not rest.startswith("//"):
        return rest
    host, slash, path = rest[2:].partition("/")
    if host in ("", "localhost"):
        return slash + path
    if host.startswith("~"):
        return host + slash + path
    raise error(
        f"{text:.200}: this URL names the computer '{host:.80}', expected three slashes, "
        f"as in {Path(rest[2:]).absolute().as_uri()}"
    )
