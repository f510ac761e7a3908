"""Recordings: MCAP in rosbag2's form, written and read without ROS by the library rosbags."""

import heapq
import shutil
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from operator import itemgetter
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np

from dynastar.errors import DataError, DynastarWarning
from dynastar.extras import require
from dynastar.paths import local_path
from dynastar.ros.aside import AsideFolder
from dynastar.ros.cut_bag import has_journal, read_cut
from dynastar.writing import reason_of

LAYOUT = Path(__file__).parent / "foxglove.json"
STORED_EVERY = 10**9  # ns after which what was written in place is on the disk


@cache
def _types() -> Any:
    require("bags", "recordings need")
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_KILTED)


def make(name: str, /, **fields: Any) -> Any:
    """A message of a type such as "std_msgs/msg/Header", the fields that are not given being 0."""
    store = _types()
    for field, (kind, detail) in store.fielddefs[name][1]:
        value = fields.get(field)
        if value is None:
            fields[field] = _zero(kind.name, detail)
        elif isinstance(value, bytes):
            fields[field] = value[0]
    return store.types[name](**fields)


def as_read(kind: str, message: Any) -> Any:
    """A message as it is read from a recording: its numbers rounded to their fields' types."""
    store = _types()
    return store.deserialize_cdr(store.serialize_cdr(message, kind), kind)


def _zero(kind: str, detail: Any) -> Any:
    """What a field holds that is not given, by its kind and detail as rosbags describes fields."""
    if kind == "NAME":
        return make(detail)
    if kind == "BASE":
        return {"string": "", "bool": False}.get(detail[0], 0)
    (inner, innermost), count = detail
    if inner.name == "BASE" and innermost[0] != "string":
        return np.zeros(count, "uint8" if innermost[0] == "byte" else innermost[0])
    return [_zero(inner.name, innermost) for _ in range(count)]


class BagWriter:
    """Writes messages to a new folder; it appears under its name when it is closed, and is whole.

    The folder also has a layout for Foxglove, ``foxglove.json``, which shows what the navigator considers.
    ``aside=False`` writes in place, so that what was recorded up to a crash is kept but for the last
    second. Raises DataError where there is something of that name.
    """

    def __init__(self, folder: Path, aside: bool = True) -> None:
        _types()
        from rosbags.rosbag2 import StoragePlugin, Writer

        self.folder = local_path(folder, DataError).absolute()
        if self.folder.exists():
            raise DataError(f"{folder} exists: a recording needs a new folder")
        self.folder.parent.mkdir(parents=True, exist_ok=True)
        self._aside = AsideFolder(self.folder) if aside else None
        written = self.folder if self._aside is None else self._aside.written
        version = Writer.VERSION_LATEST
        self._writer = Writer(written, version=version, storage_plugin=StoragePlugin.MCAP)
        try:
            with self._writing():
                self._writer.open()
                shutil.copyfile(LAYOUT, written / LAYOUT.name)
        except DataError:
            self._drop()
            raise
        self._connections: dict[str, Any] = {}
        self._last = -1
        self._stored = -STORED_EVERY, time.monotonic_ns()  # by stamps, and by the steady clock

    def write(self, topic: str, kind: str, at: float, message: Any) -> None:
        """Writes a message that ``make`` has made, at a time in seconds."""
        self.write_cdr(topic, kind, at, _types().serialize_cdr(message, kind))

    def write_cdr(self, topic: str, kind: str, at: float, data: bytes | memoryview) -> None:
        """Writes a message that is serialized already, as rclpy does it.

        Times are whole microseconds; within one, nanoseconds keep the order of writing.
        """
        connection = self._connections.get(topic)
        if connection is None:
            connection = self._writer.add_connection(topic, kind, typestore=_types())
            self._connections[topic] = connection
        self._last = max(1000 * round(1e6 * at), self._last + 1)
        with self._writing():
            self._writer.write(connection, self._last, data)
        storage: Any = self._writer.storage
        now = self._last, time.monotonic_ns()  # stamps may stand still
        late = max(now[0] - self._stored[0], now[1] - self._stored[1]) > STORED_EVERY
        if self._aside is None and late and storage.chunk.bio.tell():
            storage.close_chunk()
            storage.bio.flush()
            self._stored = now

    def close(self) -> None:
        """Ends the recording and gives it its name."""
        try:
            with self._writing():
                self._writer.close()
                if self._aside is not None:
                    self._aside.keep()
        except DataError:
            self._drop()
            raise

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Written aside, what the system refuses is a DataError; in place it stays an OSError."""
        try:
            yield
        except OSError as trouble:
            if self._aside is None:
                raise
            raise DataError(
                f"{self.folder}: cannot be written ({reason_of(trouble)}); name a folder with room on "
                "its disk"
            ) from None

    def _drop(self) -> None:
        """Deletes what was written aside."""
        with suppress(OSError):  # it writes once more what the disk has refused
            self._writer.abort()
        if self._aside is not None:
            self._aside.drop()

    def __enter__(self) -> "BagWriter":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None or self._aside is None:
            self.close()
        else:
            self._drop()


class Recorded(NamedTuple):
    """A message of a recording: its topic, its time in seconds (whole microseconds), and the message."""

    topic: str
    time: float
    message: Any


class _Whole:
    """A recording, or one of its files, that rosbags can read."""

    def __init__(self, path: Path) -> None:
        from rosbags.highlevel import AnyReader

        self._reader = AnyReader([path], default_typestore=_types())
        self._reader.open()
        found = self._reader.connections
        counted = any(one.msgcount for one in found)  # some files do not count their messages
        self.topics = {one.topic: one.msgtype for one in found if one.msgcount or not counted}
        self.count = self._reader.message_count
        self.span = (self._reader.start_time, self._reader.end_time)

    def messages(self, topics: set[str]) -> Iterator[tuple[int, str, Any]]:
        """Time (ns), topic and message, by time."""
        wanted = [found for found in self._reader.connections if found.topic in topics]
        for connection, at, data in self._reader.messages(connections=wanted):
            yield at, connection.topic, self._reader.deserialize(data, connection.msgtype)

    def close(self) -> None:
        self._reader.close()


class _Cut:
    """A file of a recording that was cut off."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.topics: dict[str, str] = {}
        self.count, self.span = 0, (2**63, 0)
        for raw in read_cut(path):
            if raw.kind in _types().fielddefs:
                self.topics[raw.topic] = raw.kind
            self.count += 1
            self.span = (min(self.span[0], raw.time), max(self.span[1], raw.time))

    def messages(self, topics: set[str]) -> Iterator[tuple[int, str, Any]]:
        """Time (ns), topic and message, by time."""
        wanted = topics & self.topics.keys()
        found = [raw for raw in read_cut(self._path) if raw.topic in wanted]
        for raw in sorted(found, key=lambda raw: raw.time):
            yield raw.time, raw.topic, _types().deserialize_cdr(raw.data, raw.kind)

    def close(self) -> None:
        """Nothing is open."""


class BagReader:
    """A recording: a folder in rosbag2's form, or an .mcap or .db3 file alone.

    One that was cut off is read as far as it goes, with a warning. DataError where nothing can be read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = local_path(path, DataError)
        _types()
        if not self.path.exists():
            raise DataError(f"{path}: there is no such recording")
        try:
            if has_journal(self.path):
                raise DataError("it was not closed")
            self._parts: list[_Whole | _Cut] = [_Whole(self.path)]
        except Exception as error:  # rosbags raises many kinds for damage
            why = " ".join(str(error).split())
            self._parts = _files_of(self.path)
            if not self._parts:
                raise DataError(f"{path}: not a recording that can be read: {why:.200}") from None
            self._warn(why)

    def _warn(self, why: str) -> None:
        """Say where a recording that was cut off ends."""
        first, last = zip(*(part.span for part in self._parts), strict=True)
        count = sum(part.count for part in self._parts)
        words = (
            f"{self.path} was cut off or is damaged: it is read up to "
            f"{1e-9 * (max(last) - min(first)):.3f} s after its first message, {count} messages in all "
            f"({why:.200})"
        )
        warnings.warn(words, DynastarWarning, stacklevel=3)

    @property
    def topics(self) -> dict[str, str]:
        """The type of each topic that has messages."""
        return {topic: kind for part in self._parts for topic, kind in part.topics.items()}

    def messages(self, topics: set[str]) -> Iterator[Recorded]:
        """Messages of topics by time, those of one time as they were written."""
        parts = (part.messages(topics) for part in self._parts)
        try:
            for at, topic, message in heapq.merge(*parts, key=itemgetter(0)):
                yield Recorded(topic, 1e-6 * (at // 1000), message)
        except Exception as error:  # as above
            raise DataError(f"{self.path}: damaged: {error!s:.200}") from None

    def close(self) -> None:
        """Closes the files."""
        for part in self._parts:
            part.close()


def _files_of(path: Path) -> list[_Whole | _Cut]:
    """The files of a recording of which something can be read."""
    files = [path]
    if path.is_dir():
        files = sorted(file for file in path.iterdir() if file.suffix in (".mcap", ".db3"))
    parts: list[_Whole | _Cut] = []
    for file in files:
        try:
            parts.append(_Cut(file) if has_journal(file) else _Whole(file))
        except Exception:  # as above
            parts.append(_Cut(file))
    for part in parts:
        if not part.count:
            part.close()
    return [part for part in parts if part.count]
