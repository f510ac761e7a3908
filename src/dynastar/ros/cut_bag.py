"""Recordings that were cut off, as by a crash or a full disk, read as far as they go.

rosbags reads whole files alone: the index of an MCAP file is at its end, and SQLite refuses a file that
is shorter than it says. Here an MCAP file is read record by record from its beginning, and a SQLite file
row by row, until nothing whole follows.
"""

import importlib
import os
import shutil
import sqlite3
import struct
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import BinaryIO, NamedTuple
from zlib import crc32

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK = 1, 2, 3, 4, 5, 6  # opcodes of MCAP
_RECORD, _CHUNK = struct.Struct("<BQ"), struct.Struct("<QQQI")
_MESSAGE, _CHANNEL = struct.Struct("<HIQQ"), struct.Struct("<HH")


class Raw(NamedTuple):
    """A message as it is stored: its time in nanoseconds, topic, type and serialized bytes."""

    time: int
    topic: str
    kind: str
    data: bytes


def read_cut(path: Path) -> Iterator[Raw]:
    """The messages of an .mcap or .db3 file in its order, up to the first that is not whole."""
    try:
        yield from _read_mcap(path) if path.suffix == ".mcap" else _read_db3(path)
    except Exception:  # many kinds for damage: what follows cannot be read
        return


def has_journal(path: Path) -> bool:
    """Whether a SQLite file has a journal beside it, with messages that are not in the file yet."""
    journal = path.with_name(f"{path.name}-wal")
    return journal.is_file() and journal.stat().st_size > 0


def _read_mcap(path: Path) -> Iterator[Raw]:
    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, str]] = {}
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            return
        for opcode, content in _records(file, path.stat().st_size):
            if opcode == SCHEMA:
                schemas[int.from_bytes(content[:2], "little")] = _string(content, 2)[0]
            elif opcode == CHANNEL:
                number, schema = _CHANNEL.unpack_from(content)
                topic, end = _string(content, _CHANNEL.size)
                if _string(content, end)[0] == "cdr":
                    channels[number] = topic, schemas.get(schema, "")
            elif opcode == MESSAGE:
                number, _, time, _ = _MESSAGE.unpack_from(content)
                if number in channels:
                    yield Raw(time, *channels[number], content[_MESSAGE.size :])


def _records(file: BinaryIO, size: int) -> Iterator[tuple[int, bytes]]:
    """Whole records, those in chunks too: opcode and content."""
    while len(head := file.read(_RECORD.size)) == _RECORD.size:
        opcode, length = _RECORD.unpack(head)
        content = file.read(min(length, size))
        whole = len(content) == length
        if opcode == CHUNK:
            records = _unpacked(content, whole)
            start = 0
            while start + _RECORD.size <= len(records):
                inner, length = _RECORD.unpack_from(records, start)
                start += _RECORD.size + length
                if start <= len(records):
                    yield inner, records[start - length : start]
        elif whole:
            yield opcode, content
        if not whole or opcode in (0, FOOTER):
            return


def _unpacked(chunk: bytes, whole: bool) -> bytes:
    """The records of a chunk, also of one that was cut off; none of one that is damaged."""
    if len(chunk) < _CHUNK.size + 12:
        return b""
    *_, checksum = _CHUNK.unpack_from(chunk)
    compression, start = _string(chunk, _CHUNK.size)
    records = chunk[start + 8 :]
    if compression == "lz4":
        records = importlib.import_module("lz4.frame").LZ4FrameDecompressor().decompress(records)
    elif compression == "zstd":
        name = "compression.zstd" if sys.version_info >= (3, 14) else "backports.zstd"
        records = importlib.import_module(name).ZstdDecompressor().decompress(records)
    return b"" if whole and checksum and crc32(records) != checksum else records


def _string(content: bytes, start: int) -> tuple[str, int]:
    """The string at an offset, and the offset after it."""
    begin = start + 4
    end = begin + int.from_bytes(content[start:begin], "little")
    return content[begin:end].decode(), end


def _read_db3(path: Path) -> Iterator[Raw]:
    with tempfile.TemporaryDirectory() as folder, closing(_connected(path, Path(folder))) as rows:
        # Without this SQLite refuses a file that is shorter than its header says.
        rows.execute("PRAGMA writable_schema = ON")
        found = rows.execute("SELECT id, name, type FROM topics")
        topics = {number: (name, kind) for number, name, kind in found}
        for number, time, data in rows.execute("SELECT topic_id, timestamp, data FROM messages"):
            yield Raw(time, *topics[number], data)


def _connected(path: Path, folder: Path) -> sqlite3.Connection:
    """A SQLite file: with its journal, or copied to ``folder`` without a part of its last page."""
    if has_journal(path):
        return sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
    with path.open("rb") as file:
        page = int.from_bytes(file.read(18)[16:], "big") or 1
    size = path.stat().st_size
    if size % page:
        path = Path(shutil.copy(path, folder))
        os.truncate(path, size - size % page)
    return sqlite3.connect(f"{path.absolute().as_uri()}?immutable=1", uri=True)
