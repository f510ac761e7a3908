"""Compiling kernels: where they are kept, and the bit tricks they need.

numba notices edits only in the file that a kernel stands in, not in the files it imports from, so
a shared cache would go stale; here all kernels' sources together name the folder. So it does, too,
for a program that has imported numba before.
"""

import hashlib
import os
import shutil
from pathlib import Path
from typing import Any

ROOM = "dynastar"  # in the user's cache


def caches() -> Path:
    """The folder that holds the compiled kernels of all versions."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / ROOM


def folder() -> Path:
    """The folder of this version's kernels, or the one that NUMBA_CACHE_DIR names."""
    return Path(os.environ["NUMBA_CACHE_DIR"])


def digest() -> str:
    """What tells this version of the kernels from others."""
    found = hashlib.sha256()
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        text = source.read_bytes()
        if b"njit" in text:
            found.update(source.name.encode() + text)
    return found.hexdigest()[:16]


def clear() -> int:
    """Deletes the compiled kernels of all versions; how many bytes that were."""
    folder = caches()
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    shutil.rmtree(folder, ignore_errors=True)
    return size


if "NUMBA_CACHE_DIR" not in os.environ:
    os.environ["NUMBA_CACHE_DIR"] = str(caches() / digest())

import llvmlite.ir as ir  # noqa: E402 (numba reads the variable when it is imported)
from numba import config, njit, types  # noqa: E402
from numba.extending import intrinsic  # noqa: E402

config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

__all__ = ["caches", "clear", "digest", "folder", "leading_zeros", "njit", "trailing_zeros"]


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
