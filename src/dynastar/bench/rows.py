"""Rows of an experiment, one a job: made by all cores, kept as they come, gone on with where they end."""

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tqdm import tqdm

import dynastar
from dynastar.bench.runner import spread
from dynastar.errors import InputError
from dynastar.io.files import MAX_TEXT_BYTES, jsonable, read_bytes, written_aside


def collect(
    name: str,
    work: Callable[[Any], dict[str, Any]],
    jobs: Sequence[Any],
    file: Path,
    settings: dict[str, Any],
    workers: int = 1,
    progress: bool = False,
) -> list[dict[str, Any]]:
    """A row for every job, in the jobs' order; those that ``file`` has are not made again.

    The file holds JSON by lines: the settings first, then each row with its job. Other settings, or a
    file that is none of ours, begin anew; a line that was damaged or cut off in writing is dropped.
    """
    done = _kept(file, settings)
    left = [job for job in jobs if _key(job) not in done]
    lines = [settings, *({"job": json.loads(key), "row": row} for key, row in done.items())]
    with written_aside(file) as aside:
        text = "".join(json.dumps(jsonable(line)) + "\n" for line in lines)
        aside.write_text(text, encoding="utf-8")
    with (
        file.open("a", encoding="utf-8") as kept,
        tqdm(
            total=len(jobs), initial=len(jobs) - len(left), desc=name, disable=not progress
        ) as bar,
    ):
        rows = map(work, left) if workers == 1 else spread(work, left, min(workers, len(left) or 1))
        for job, row in zip(left, rows, strict=True):
            kept.write(json.dumps(jsonable({"job": job, "row": row})) + "\n")
            kept.flush()
            done[_key(job)] = row
            bar.update()
    return [done[_key(job)] for job in jobs]


def version(*modules: str) -> str:
    """A digest of all that rows can depend on: the library, bench's runner, and its ``modules`` named.

    Of the rest of bench, of cli and of viewer nothing has to do with a row.
    """
    package = Path(dynastar.__file__).parent
    outside = {"cli", "viewer", "bench"}
    sources = [
        source
        for source in package.rglob("*.py")
        if source.relative_to(package).parts[0] not in outside
    ]
    digest = hashlib.sha256()
    for source in sorted(
        [*sources, *(package / "bench" / f"{name}.py" for name in {"runner", *modules})]
    ):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _key(job: Any) -> str:
    return json.dumps(jsonable(job))


def _kept(file: Path, settings: dict[str, Any]) -> dict[str, dict[str, Any]]:
    if not file.exists() or file.stat().st_size == 0:
        return {}
    first, *lines = (
        read_bytes(file, MAX_TEXT_BYTES, InputError).decode(errors="replace").split("\n")
    )
    if _parsed(first) != jsonable(settings):
        return {}
    entries = [_parsed(line) for line in lines]
    return {
        _key(entry["job"]): entry["row"]
        for entry in entries
        if isinstance(entry, dict) and "job" in entry and isinstance(entry.get("row"), dict)
    }


def _parsed(line: str) -> Any:
    try:
        return json.loads(line)
    except ValueError:  # damaged, or cut off in writing
        return None
