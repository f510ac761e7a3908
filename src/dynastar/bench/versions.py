"""Digests of the sources that rows depend on, so that rows of other code are not taken for these."""

import hashlib
import importlib.util
from collections.abc import Sequence
from pathlib import Path

import dynastar

SHARED = ("missions", "selection")  # of bench, by which every table chooses and runs missions


def version(*modules: str) -> str:
    """A digest of what the rows of a table depend on: the library and ``modules`` of bench.

    With them go the modules that choose and run missions; cli, viewer, tune and the rest of bench have no
    influence on these rows.
    """
    package = Path(dynastar.__file__).parent
    named = [package / "bench" / f"{name}.py" for name in {*SHARED, *modules}]
    return _digest([*_sources({"cli", "viewer", "tune", "bench"}), *named])


def code_version() -> str:
    """A digest of the library and all of bench: what the rows of a suite can depend on."""
    return _digest(_sources({"cli", "viewer", "tune"}))


def controller_version(name: str) -> str:
    """A digest of the file of a controller named MODULE:CLASS; "" for one of dynastar's own."""
    module, colon, _ = name.partition(":")
    found = importlib.util.find_spec(module) if colon else None
    if found is None or found.origin is None or not Path(found.origin).is_file():
        return ""
    return "-" + hashlib.sha256(Path(found.origin).read_bytes()).hexdigest()[:16]


def _sources(outside: set[str]) -> list[Path]:
    package = Path(dynastar.__file__).parent
    return [
        source
        for source in package.rglob("*.py")
        if source.relative_to(package).parts[0] not in outside
    ]


def _digest(sources: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
