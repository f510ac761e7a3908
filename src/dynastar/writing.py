"""Writing files so that nobody ever sees half of one."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from dynastar.errors import InputError
from dynastar.paths import local_path


@contextmanager
def written_aside(path: str | Path, error: type[InputError] = InputError) -> Iterator[Path]:
    """A path beside ``path``, of the same suffix, to write to: renamed to ``path`` at the end.

    A link is followed; what is there and no regular file is refused.
    On any exception it is deleted instead. Folders that are missing are made. Raises ``error``
    where the system refuses.
    """
    path = local_path(path, error)
    try:
        path = path.resolve() if path.is_symlink() else path
        if path.exists() and not path.is_file():
            raise error(f"{path}: is no regular file; name another")
    except OSError as trouble:
        raise error(f"{path!s:.200}: cannot be written ({reason_of(trouble)})") from None
    aside = path.with_name(f".{path.stem}.{secrets.token_hex(4)}.aside{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield aside
        os.replace(aside, path)
    except OSError as trouble:
        raise error(f"{path}: cannot be written ({reason_of(trouble)})") from None
    finally:
        with suppress(OSError):  # the folder itself is not there, or not ours: nothing was written
            aside.unlink(missing_ok=True)


def reason_of(trouble: Exception) -> str:
    """Why the system refused, in its words."""
    return getattr(trouble, "strerror", None) or str(trouble)
