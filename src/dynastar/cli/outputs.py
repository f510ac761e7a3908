"""Outputs are checked before anything is run, so that nothing is lost at the end of an hour."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from dynastar.errors import InputError
from dynastar.extras import require
from dynastar.paths import local_path

MOST_TEXT = 2**20  # bytes, of a file that may name others
PICTURES = ".png", ".svg", ".pdf"


def check_file(option: str, name: str | Path | None, read: Iterable[Path] = ()) -> Path | None:
    """The file to write, None for none or "-"; InputError if it cannot be written.

    It may not be one of the files that are ``read``, nor one that these name, as a map its image.
    """
    if name is None or str(name) == "-":
        return None
    file = local_path(name)
    try:
        folder = (file.resolve() if file.is_symlink() else file.absolute()).parent
        known = file.exists()
    except OSError as error:
        raise InputError(f"{option} {name!s:.200}: {error.strerror}; name another") from None
    if not folder.is_dir():
        raise InputError(f"{option} {name}: its folder is not there; make it first")
    if file.is_dir():
        raise InputError(f"{option} {name}: that is a folder; name a file")
    if known and not file.is_file():
        raise InputError(f"{option} {name}: is no regular file; name another")
    if not os.access(folder, os.W_OK) or (known and not os.access(file, os.W_OK)):
        raise InputError(f"{option} {name}: cannot be written; name another")
    if known and file.resolve() in set().union(*map(_read_with, read)):
        raise InputError(f"{option} {name}: that is what is read here; name another file")
    return file


def _read_with(file: Path, found: frozenset[Path] = frozenset()) -> frozenset[Path]:
    """A file and those that it names, if it is a text that may: a scenario its map, a map its image."""
    try:
        if file.resolve() in found or not file.is_file():
            return found
        names = file.suffix.lower() in NAMING and file.stat().st_size < MOST_TEXT
        table = NAMING[file.suffix.lower()](file) if names else {}
    except (OSError, RuntimeError, ValueError, InputError):  # no file's name, a loop, or no table
        return found
    found |= {file.resolve()}
    for name in _strings(table):
        try:
            found = _read_with(file.parent / local_path(os.path.expandvars(name)), found)
        except InputError:  # of something on another computer
            continue
    return found


def _strings(value: Any) -> Iterator[str]:
    """All strings in nested tables and lists."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        for part in value.values() if isinstance(value, Mapping) else value:
            yield from _strings(part)


def _toml(file: Path) -> dict[str, Any]:
    import tomllib

    return tomllib.loads(file.read_text(encoding="utf-8-sig"))


def _yaml(file: Path) -> dict[Any, Any]:
    from dynastar.io.yaml_table import read_yaml

    return read_yaml(file.read_bytes(), file)


NAMING = {".toml": _toml, ".yaml": _yaml, ".yml": _yaml}  # how texts that may name files are read


def check_picture(option: str, name: str | Path | None, read: Iterable[Path] = ()) -> Path | None:
    """As ``check_file``, for a picture that Matplotlib draws. MissingPackage without it."""
    refuse_dash(option, name)
    file = check_file(option, name, read)
    if file is not None and file.suffix and file.suffix.lower() not in PICTURES:
        raise InputError(f"{option} {name}: expected a file in {', '.join(PICTURES)}")
    if file is not None:
        require("viewer", "pictures need")
    return file


def refuse_dash(option: str, name: str | Path | None) -> None:
    """InputError for "-", where what is written is nothing for a terminal."""
    if str(name) == "-":
        raise InputError(f"{option} -: expected a file")


def make_folder(option: str, folder: Path) -> Path:
    """Makes ``folder`` if it is not there; InputError if that cannot be done or it cannot be written."""
    if folder.is_file():
        raise InputError(f"{option} {folder}: that is a file; name a folder")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{option} {folder}: cannot make this folder ({error.strerror}); name another"
        ) from error
    if not os.access(folder, os.W_OK):
        raise InputError(f"{option} {folder}: nothing can be written into it; name another")
    return folder


def check_new(option: str, folder: Path) -> None:
    """Raises InputError where ``folder`` is there already or cannot be made."""
    if folder.exists() or folder.is_symlink():
        raise InputError(f"{option} {folder}: is there already; name a new folder")
    make_folder(option, folder.absolute().parent)
