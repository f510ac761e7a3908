"""Digests of the sources that rows depend on, so that rows of other code are not taken for these."""

import hashlib
import importlib.util
from pathlib import Path

import dynastar

APART = {"cli", "viewer", "tune"}  # packages that have no influence on rows


def code_version() -> str:
    """A digest of the library and all of bench: what rows can depend on."""
    package, digest = Path(dynastar.__file__).parent, hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        if source.relative_to(package).parts[0] not in APART:
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def controller_version(name: str) -> str:
    """A digest of the file of a controller named MODULE:CLASS; "" for one of dynastar's own."""
    module, colon, _ = name.partition(":")
    found = importlib.util.find_spec(module) if colon else None
    if found is None or found.origin is None or not Path(found.origin).is_file():
        return ""
    return "-" + hashlib.sha256(Path(found.origin).read_bytes()).hexdigest()[:16]
