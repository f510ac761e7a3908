"""Compiling kernels: where they are kept, and the bit tricks they need.

numba notices edits only in the file that a kernel stands in, not in the files it imports from, so
a shared cache would go stale; here all kernels' sources together name the folder. So it does, too,
for a program that has imported numba before.

A home that is missing or cannot be written, as in a container, is replaced by a folder of the
user's own beside other temporary files.
"""

import hashlib
import os
import pickle
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, get_type_hints

ROOM = "dynastar"  # in the user's cache
# In a source of kernels or of what they take.
IN_KERNELS = b"njit", b"@inner", b"@allocating", b"NamedTuple"
CALLABLE = bool(os.environ.get("DYNASTAR_CALLABLE_KERNELS"))  # for tests: ``inner`` is ``njit``


def caches() -> Path:
    """The folder that holds the compiled kernels of all versions."""
    try:
        usual = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / ROOM
    except RuntimeError:  # a user without a home
        return _temporary()
    return usual if _can_be_written(usual) else _temporary()


def folder() -> Path:
    """The folder of this version's kernels, or the one that NUMBA_CACHE_DIR names."""
    return Path(os.environ["NUMBA_CACHE_DIR"])


def digest() -> str:
    """Digest of the sources of all kernels and of where they are: names this version's cache folder.

    numba finds a kernel by the path of its source, so an installation cannot use another's.
    """
    package = Path(__file__).parent
    found = hashlib.sha256(os.fsencode(package) + bytes([CALLABLE]))
    for source in sorted(package.rglob("*.py")):
        text = source.read_bytes()
        if any(word in text for word in IN_KERNELS):
            found.update(source.name.encode() + text)
    return found.hexdigest()[:16]


def clear() -> int:
    """Deletes the compiled kernels of all versions; how many bytes that were."""
    folder = caches()
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    shutil.rmtree(folder, ignore_errors=True)
    return size


def is_temporary() -> bool:
    """Whether the kernels are kept with temporary files, as there is no home to write to."""
    kept = folder().parent
    return kept == caches() and kept.name != ROOM


def _can_be_written(folder: Path) -> bool:
    """Whether a folder is there, or can be made, and can be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK)


def _temporary() -> Path:
    """A folder that is this user's alone, the same one each time: what is in it will be run."""
    user = os.geteuid() if hasattr(os, "geteuid") else os.getpid()
    folder = Path(tempfile.gettempdir()) / f"{ROOM}-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
        own = stat.S_ISDIR(found.st_mode) and not found.st_mode & 0o022
        if own and (not hasattr(os, "geteuid") or found.st_uid == user):
            return folder
    except OSError:
        pass
    return Path(tempfile.mkdtemp(prefix=f"{ROOM}-"))


if not os.environ.get("NUMBA_CACHE_DIR"):
    os.environ["NUMBA_CACHE_DIR"] = str(caches() / digest())

import llvmlite.ir as ir  # noqa: E402 (numba reads the variable when it is imported)
import numba  # noqa: E402
import numpy as np  # noqa: E402
from numba import config, types  # noqa: E402
from numba.core.caching import IndexDataCacheFile  # noqa: E402
from numba.core.ir import Expr  # noqa: E402
from numba.extending import intrinsic  # noqa: E402

config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

__all__ = [
    "allocating",
    "caches",
    "clear",
    "digest",
    "folder",
    "inner",
    "leading_zeros",
    "njit",
    "record",
    "trailing_zeros",
]

DAMAGED = (EOFError, pickle.UnpicklingError, ValueError, TypeError, LookupError, AttributeError)


class _CacheFile(IndexDataCacheFile):  # type: ignore[misc]
    """A kernel's files in the cache; what is cut off or damaged is compiled again."""

    def _load_index(self) -> dict[Any, str]:
        try:
            found: dict[Any, str] = super()._load_index()
        except DAMAGED:
            return {}
        return found

    def _load_data(self, name: str) -> Any:
        try:
            return super()._load_data(name)
        except DAMAGED as error:
            raise OSError(f"{name}: {error}") from error


def njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """numba's decorator of this name, with a cache that survives damaged files.

    Division follows IEEE 754, as NumPy's does: kernels that check for 0 take longer to compile. A kernel
    that calls this one with a constant does not have it compiled once more for that constant.
    """
    options.setdefault("error_model", "numpy")

    def compiled(function: Callable[..., Any]) -> Any:
        kernel = numba.njit(**options)(function)
        if options.get("cache"):
            kernel._cache._cache_file.__class__ = _CacheFile
        template = kernel.get_call_template

        def of_kinds(args: Iterable[Any], keywords: dict[str, Any]) -> Any:
            kinds = {name: types.unliteral(kind) for name, kind in keywords.items()}
            return template(tuple(map(types.unliteral, args)), kinds)

        kernel.get_call_template = of_kinds
        return kernel

    return compiled


def inner(function: Callable[..., Any]) -> Any:
    """Decorate a kernel that only other kernels call, and that neither makes nor returns arrays.

    It has no wrapper for Python, and numba counts no references to the arrays that it reads: that
    counting takes more than half of the time of roll-outs. Python code must not call such a kernel:
    numba would crash. Tests set ``DYNASTAR_CALLABLE_KERNELS`` to call them nevertheless.
    """
    kernel = _unwrapped(function, counts_references=False)
    add_overload = kernel.add_overload

    def checked(compiled: Any) -> None:
        kinds, calls = compiled.fndesc.typemap or {}, compiled.fndesc.calltypes or {}
        returned = [compiled.signature.return_type]
        for call, signature in calls.items():
            is_call = isinstance(call, Expr) and call.op == "call"
            if is_call and isinstance(kinds[call.func.name], types.Dispatcher):
                returned.append(signature.return_type)
        if any(map(_holds_array, returned)):
            name = function.__qualname__
            raise TypeError(
                f"{name} returns an array, or calls a kernel that does: use @allocating"
            )
        add_overload(compiled)

    kernel.add_overload = checked
    return kernel


def allocating(function: Callable[..., Any]) -> Any:
    """As ``inner``, for a kernel that makes or returns arrays, or calls one that does."""
    return _unwrapped(function, counts_references=True)


def _unwrapped(function: Callable[..., Any], counts_references: bool) -> Any:
    wrappers = {"no_cpython_wrapper": not CALLABLE, "no_cfunc_wrapper": not CALLABLE}
    return njit(cache=True, **wrappers, _nrt=counts_references)(function)


def _holds_array(kind: Any) -> bool:
    """Whether a numba type is an array, or a tuple with one in it."""
    if isinstance(kind, types.BaseTuple):
        return any(map(_holds_array, kind))
    return isinstance(kind, types.Array)


def record(fields: type) -> np.dtype[Any]:
    """The dtype of records with the annotated fields of a class; kernels read them as attributes."""
    return np.dtype(list(get_type_hints(fields).items()))


@intrinsic
def trailing_zeros(typing_context: Any, word: Any) -> Any:
    """Number of trailing zero bits of a uint64 that is not 0."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.IntType(1)(1))

    return types.int64(types.uint64), generate


@intrinsic
def leading_zeros(typing_context: Any, word: Any) -> Any:
    """Number of leading zero bits of a uint64 that is not 0."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.ctlz(args[0], ir.IntType(1)(1))

    return types.int64(types.uint64), generate
