"""Where numba keeps compiled kernels: under a key that changes when any kernel's source does.

numba notices edits only in the file that a kernel stands in, not in the files it imports from, so
a shared cache would go stale; here all kernels' sources together name the folder.
"""

import hashlib
import os
from pathlib import Path


def use() -> None:
    """Points numba at this version's cache, unless NUMBA_CACHE_DIR says otherwise already."""
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(folder())


def folder() -> Path:
    """The folder for this version of the kernels, in the user's cache."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        text = source.read_bytes()
        if b"numba" in text:
            digest.update(source.name.encode() + text)
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "dynastar" / digest.hexdigest()[:16]
