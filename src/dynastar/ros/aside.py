"""Folders that are written beside their place; what a killed process has left of them goes."""

import shutil
import tempfile
from pathlib import Path
from typing import IO

try:
    import fcntl
except ImportError:  # not a POSIX system
    fcntl = None  # type: ignore[assignment]

ENDING = ".aside"
LOCK = "lock"  # a file that is locked while its folder is written


class AsideFolder:
    """A new hidden folder beside ``target``, which ``keep`` gives what was written to ``written``."""

    def __init__(self, target: Path) -> None:
        _clear(target.parent)
        self._target = target
        self._folder = Path(tempfile.mkdtemp(ENDING, f".{target.name}.", target.parent))
        self._lock = _locked(self._folder)
        self.written = self._folder / target.name

    def keep(self) -> None:
        """Gives what was written its name."""
        self.written.rename(self._target)
        self.drop()

    def drop(self) -> None:
        """Deletes what is left."""
        shutil.rmtree(self._folder, ignore_errors=True)
        if self._lock is not None:
            self._lock.close()


def _clear(parent: Path) -> None:
    """Deletes the folders of processes that are no more; a lock ends with its process."""
    for folder in parent.glob(f".*{ENDING}"):
        if not (folder / LOCK).is_file():
            continue
        lock = _locked(folder)
        if lock is not None:
            shutil.rmtree(folder, ignore_errors=True)
            lock.close()


def _locked(folder: Path) -> IO[str] | None:
    """The locked file of a folder, or None if another process has locked it or locks are missing."""
    if fcntl is None:
        return None
    try:
        lock = (folder / LOCK).open("w")
    except OSError:
        return None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return lock
    except OSError:
        lock.close()
        return None
