"""Rows of an experiment, one a job: kept as they come, and continued where a run was cut off."""

import json
import os
import secrets
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from dynastar.bench.workers import Workers, completed
from dynastar.errors import InputError
from dynastar.io.files import MAX_TEXT_BYTES, jsonable, read_bytes
from dynastar.terminal import progress_bar
from dynastar.writing import written_aside


def collect(
    name: str,
    work: Callable[[Any], dict[str, Any]],
    jobs: Sequence[Any],
    file: Path,
    settings: dict[str, Any],
    workers: Workers = 1,
    progress: bool = False,
) -> list[dict[str, Any]]:
    """A row for every job, in the jobs' order; those that ``file`` has are not made again.

    A job is anything that JSON can hold, or has a ``key`` that is. The file holds JSON by lines: the
    settings first, then each row with its job. A file of other settings, or that is none of ours, is
    renamed to FILE.old; a line that was damaged or cut off in writing is dropped.
    """
    take_up(file, settings)
    _, done = _read(file)
    keys = [_key(job) for job in jobs]
    left = [(key, job) for key, job in zip(keys, jobs, strict=True) if key not in done]
    _write(file, settings, done)
    begun = len(jobs) - len(left)
    shown = progress_bar(
        total=len(jobs), initial=begun, desc=name, disable=not progress, delay=1e-6
    )
    with file.open("a", encoding="utf-8") as kept, shown as bar:
        arrived = sum(done[key].get("outcome") == "arrived" for key in keys if key in done)
        for index, row in completed(work, [job for _, job in left], workers):
            key = left[index][0]
            kept.write(json.dumps(jsonable({"job": json.loads(key), "row": row})) + "\n")
            kept.flush()
            done[key] = row
            if "outcome" in row:
                arrived += row["outcome"] == "arrived"
                bar.set_postfix(arrived=arrived, refresh=False)
            bar.update()
    return [done[key] for key in keys]


def take_up(file: Path, settings: dict[str, Any]) -> None:
    """Make ``file`` that of a run with these settings: what is of another run becomes FILE.old.

    If FILE.old is of this run, as after a slip in the options, it becomes ``file`` again.
    """
    wanted, old = jsonable(settings), file.with_name(f"{file.name}.old")
    if _read(file)[0] == wanted:
        return
    back = _read(old)[0] == wanted
    aside = old.with_name(f"{old.name}.{secrets.token_hex(4)}") if back else old
    if file.exists() and file.stat().st_size > 0:
        os.replace(file, aside)
        print(f"{file} was of another run: it is now {old}", file=sys.stderr)
    if back:
        os.replace(old, file)
        if aside.exists():
            os.replace(aside, old)


def drop_rows(
    file: Path,
    settings: dict[str, Any],
    jobs: Sequence[Any],
    unwanted: Callable[[dict[str, Any]], bool],
) -> None:
    """Take out of a file that ``collect`` has begun the rows of ``jobs`` that are to be made again."""
    first, done = _read(file)
    again = {key for key in map(_key, jobs) if key in done and unwanted(done[key])}
    if first == jsonable(settings) and again:
        _write(file, settings, {key: row for key, row in done.items() if key not in again})


def _key(job: Any) -> str:
    return json.dumps(jsonable(getattr(job, "key", job)))


def _read(file: Path) -> tuple[Any, dict[str, dict[str, Any]]]:
    """The settings of a file, None where it is none of ours, and its rows by the key of their job."""
    if not file.exists() or file.stat().st_size == 0:
        return None, {}
    text = read_bytes(file, MAX_TEXT_BYTES, InputError).decode(errors="replace")
    first, *entries = map(_parsed, text.split("\n"))
    return first, {
        _key(entry["job"]): entry["row"]
        for entry in entries
        if isinstance(entry, dict) and "job" in entry and isinstance(entry.get("row"), dict)
    }


def _write(file: Path, settings: Any, done: dict[str, dict[str, Any]]) -> None:
    lines = [settings, *({"job": json.loads(key), "row": row} for key, row in done.items())]
    with written_aside(file) as aside:
        text = "".join(json.dumps(jsonable(line)) + "\n" for line in lines)
        aside.write_text(text, encoding="utf-8")


def _parsed(line: str) -> Any:
    try:
        return jsonable(json.loads(line))
    except (ValueError, RecursionError):  # damaged, or cut off in writing
        return None
