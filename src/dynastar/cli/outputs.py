"""Outputs are checked before anything is run, so that nothing is lost at the end of an hour."""

import os
from pathlib import Path

from dynastar.errors import InputError
from dynastar.io.paths import local_path


def check_file(option: str, name: str | Path | None) -> Path | None:
    """The file to write, None for none or "-"; InputError if it cannot be written."""
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
    return file


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
