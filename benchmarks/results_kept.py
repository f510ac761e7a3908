"""Results that are kept in the repository: measured over days, they let a reader check the tables.

docs/measured has the result of each part with the rows of its missions, packed by gzip, and record.json.
"""

import gzip
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dynastar import io

Record = dict[str, dict[str, Any]]  # of each part: tree, commit, machine, date, minutes, complete

RECORD = "record.json"


def read_record(folder: Path) -> Record:
    """What was measured in a folder: by part the sources, machine, date and minutes."""
    file = folder / RECORD
    found: Record = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return found


def is_done(part: str, record: Mapping[str, Mapping[str, Any]], tree: str, folder: Path) -> bool:
    """Whether a part was measured to its end on these sources."""
    of = record.get(part, {})
    return of.get("tree") == tree and of["complete"] and (folder / f"{part}.json").is_file()


def keep(folder: Path, kept: Path, done: Sequence[str]) -> None:
    """Packs the results of the parts that are done; those of all others are removed."""
    kept.mkdir(parents=True, exist_ok=True)
    for file in kept.glob("*.json.gz"):
        if file.name.removesuffix(".json.gz") not in done:
            file.unlink()
    for part in done:
        text = (folder / f"{part}.json").read_bytes()
        with io.written_aside(kept / f"{part}.json.gz") as aside:
            aside.write_bytes(gzip.compress(text, mtime=0))
    record = read_record(folder)
    io.write_json(kept / RECORD, {part: record[part] for part in done})


def restore(kept: Path, folder: Path, tree: str) -> None:
    """Unpacks the results that were kept of these sources, unless they are there."""
    record = read_record(folder)
    for part, of in read_record(kept).items():
        file = kept / f"{part}.json.gz"
        if of["tree"] != tree or is_done(part, record, tree, folder) or not file.is_file():
            continue
        folder.mkdir(parents=True, exist_ok=True)
        with io.written_aside(folder / f"{part}.json") as aside:
            aside.write_bytes(gzip.decompress(file.read_bytes()))
        io.write_json(folder / RECORD, record := {**record, part: of})
