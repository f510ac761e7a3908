"""Results that are kept in the repository: measured over days, they let a reader check the tables.

docs/measured has the result of each part with the rows of its missions, packed by gzip, the rows of parts
that were cut off, and record.json.
"""

import gzip
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from results_parts import Part

from dynastar import io
from dynastar.writing import written_aside

Record = dict[str, dict[str, Any]]  # of each part: tree, commit, machine, date, minutes, complete

RECORD = "record.json"
PACKED = ".gz"
DATA = b"$DYNASTAR_DATA"  # stands for the folder of the data sets, which differs from machine to machine


def read_record(folder: Path) -> Record:
    """What was measured in a folder: by part the sources, machine, date and minutes."""
    file = folder / RECORD
    found: Record = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return found


def is_begun(part: Part, record: Mapping[str, Mapping[str, Any]], tree: str) -> bool:
    """Whether a part was measured, perhaps not to its end, by its command on these sources."""
    of = record.get(part.name, {})
    return of.get("tree") == tree and of.get("command") == " ".join(part.command)


def is_done(part: Part, record: Mapping[str, Mapping[str, Any]], tree: str, folder: Path) -> bool:
    """Whether a part was measured to its end on these sources."""
    if not (is_begun(part, record, tree) and record[part.name]["complete"]):
        return False
    return any((folder / f"{part.name}.json{packed}").is_file() for packed in ("", PACKED))


def files_of(part: str, complete: bool, folder: Path, packed: str = "") -> list[Path]:
    """The result of a part; of one that was cut off, the rows that it has so far."""
    if complete:
        return list(folder.glob(f"{part}.json{packed}"))
    rows = [f"{part}.json.rows.jsonl{packed}", f"paper/{part}*.jsonl{packed}"]
    rows += [f"paper/terms.jsonl{packed}"] if part == "ablation" else []
    return [file for name in rows for file in folder.glob(name)]


def keep(folder: Path, kept: Path, tree: str, data: str) -> None:
    """Packs what was measured on these sources, with data in the folder ``data``; all else is removed."""
    record = {part: of for part, of in read_record(folder).items() if of["tree"] == tree}
    files = [file for part, of in record.items() for file in files_of(part, of["complete"], folder)]
    packed = {kept / f"{file.relative_to(folder)}{PACKED}": file for file in files}
    for old in set(kept.rglob(f"*{PACKED}")) - set(packed):
        old.unlink()
    for name, file in packed.items():
        with written_aside(name) as aside:
            aside.write_bytes(
                gzip.compress(file.read_bytes().replace(data.encode(), DATA), mtime=0)
            )
    io.write_json(kept / RECORD, record)


def restore(kept: Path, folder: Path, tree: str, data: str) -> None:
    """Unpacks what was kept of these sources, but for parts that are begun or done in ``folder``."""
    record = read_record(folder)
    for part, of in read_record(kept).items():
        if of["tree"] != tree or record.get(part, {}).get("tree") == tree:
            continue
        for file in files_of(part, of["complete"], kept, PACKED):
            with written_aside(folder / file.relative_to(kept).with_suffix("")) as aside:
                aside.write_bytes(gzip.decompress(file.read_bytes()).replace(DATA, data.encode()))
        io.write_json(folder / RECORD, record := {**record, part: of})
