"""Compiling kernels: where they are kept, what is said meanwhile, and the bit tricks they need.

numba notices edits only in the file that a kernel stands in, not in the files it imports from, so
a shared cache would go stale; here all kernels' sources together name the folder. So it does, too,
for a program that has imported numba before.
"""

import hashlib
import os
import shutil
import sys
from pathlib import Path
from typing import Any

ROOM = "dynastar"  # in the user's cache
ANNOUNCE = "DYNASTAR_ANNOUNCE"  # set by the command line, for its process and its workers
ABOUT = 200  # compilations that driving takes, all in all


def caches() -> Path:
    """The folder that holds the compiled kernels of all versions."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / ROOM


def cache() -> Path:
    """The folder for this version of the kernels."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        text = source.read_bytes()
        if b"njit" in text:
            digest.update(source.name.encode() + text)
    return caches() / digest.hexdigest()[:16]


def clear() -> int:
    """Deletes the compiled kernels of all versions; how many bytes that were."""
    folder = caches()
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    shutil.rmtree(folder, ignore_errors=True)
    return size


if "NUMBA_CACHE_DIR" not in os.environ:
    os.environ["NUMBA_CACHE_DIR"] = str(cache())

import llvmlite.ir as ir  # noqa: E402 (numba reads the variable when it is imported)
from numba import config, njit, types  # noqa: E402
from numba.core import event  # noqa: E402
from numba.extending import intrinsic  # noqa: E402

config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

__all__ = ["caches", "clear", "leading_zeros", "njit", "trailing_zeros"]


class _Announcer(event.Listener):  # type: ignore[misc]
    """Tells on stderr that kernels are being compiled, and on a terminal how far it is."""

    def __init__(self) -> None:
        self.done = 0
        self._bar: Any = None

    def on_start(self, event: Any) -> None:
        """Announces the first compilation and counts all; those of other packages are left out."""
        if not event.data["dispatcher"].py_func.__module__.startswith("dynastar"):
            return
        if self.done == 0:
            from tqdm import tqdm

            words = "dynastar compiles its kernels, once for this version"
            if sys.stderr.isatty():
                self._bar = tqdm(total=ABOUT, desc=words, file=sys.stderr, leave=False)
            else:
                print(f"{words}: about 40 s", file=sys.stderr)
        self.done += 1
        if self._bar is not None:
            self._bar.total = max(self._bar.total, self.done)
            self._bar.update()

    def on_end(self, event: Any) -> None:
        """Nothing to say."""


if ANNOUNCE in os.environ:
    event.register("numba:compile", _Announcer())


@intrinsic
def trailing_zeros(typing_context: Any, word: Any) -> Any:
    """How many of a uint64's lowest bits are 0; the word must not be 0."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.IntType(1)(1))

    return types.int64(types.uint64), generate


@intrinsic
def leading_zeros(typing_context: Any, word: Any) -> Any:
    """How many of a uint64's highest bits are 0; the word must not be 0."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.ctlz(args[0], ir.IntType(1)(1))

    return types.int64(types.uint64), generate
