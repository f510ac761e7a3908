"""Recordings: MCAP in rosbag2's form, written and read without ROS by the library rosbags."""

import shutil
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np

from dynastar.errors import DataError
from dynastar.extras import require
from dynastar.io.paths import local_path


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

    ``aside=False`` writes in place, so that what was recorded up to a crash is kept. Raises DataError
    where there is something of that name.
    """

    def __init__(self, folder: Path, aside: bool = True) -> None:
        _types()
        from rosbags.rosbag2 import StoragePlugin, Writer

        self.folder = local_path(folder, DataError).absolute()
        if self.folder.exists():
            raise DataError(f"{folder} exists: a recording needs a new folder")
        self.folder.parent.mkdir(parents=True, exist_ok=True)
        self._aside = Path(tempfile.mkdtemp(dir=self.folder.parent)) if aside else None
        written = self.folder if self._aside is None else self._aside / self.folder.name
        version = Writer.VERSION_LATEST
        self._writer = Writer(written, version=version, storage_plugin=StoragePlugin.MCAP)
        self._writer.open()
        self._connections: dict[str, Any] = {}
        self._last = -1

    def write(self, topic: str, kind: str, time: float, message: Any) -> None:
        """Writes a message that ``make`` has made, at a time in seconds."""
        self.write_cdr(topic, kind, time, _types().serialize_cdr(message, kind))

    def write_cdr(self, topic: str, kind: str, time: float, data: bytes | memoryview) -> None:
        """Writes a message that is serialized already, as rclpy does it.

        Times are whole microseconds; within one, nanoseconds keep the order of writing.
        """
        connection = self._connections.get(topic)
        if connection is None:
            connection = self._writer.add_connection(topic, kind, typestore=_types())
            self._connections[topic] = connection
        self._last = max(1000 * round(1e6 * time), self._last + 1)
        self._writer.write(connection, self._last, data)

    def close(self) -> None:
        """Ends the recording and gives it its name."""
        self._writer.close()
        if self._aside is not None:
            (self._aside / self.folder.name).rename(self.folder)
            self._aside.rmdir()

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
            self._writer.abort()
            shutil.rmtree(self._aside, ignore_errors=True)


class Recorded(NamedTuple):
    """A message of a recording: its topic, its time in seconds (whole microseconds), and the message."""

    topic: str
    time: float
    message: Any


class BagReader:
    """A recording: a folder in rosbag2's form, or an .mcap file alone. DataError where it is none."""

    def __init__(self, path: Path) -> None:
        self.path, self._store = local_path(path, DataError), _types()
        from rosbags.highlevel import AnyReader

        if not self.path.exists():
            raise DataError(f"{path}: there is no such recording")
        try:
            self._reader = AnyReader([self.path], default_typestore=self._store)
            self._reader.open()
        except Exception as error:  # rosbags raises many kinds for damage
            raise DataError(f"{path}: not a recording that can be read: {error!s:.200}") from None

    @property
    def topics(self) -> dict[str, str]:
        """The type of each topic."""
        return {found.topic: found.msgtype for found in self._reader.connections}

    def messages(self, topics: set[str]) -> Iterator[Recorded]:
        """Messages of topics by time, those of one time as they were written."""
        wanted = [found for found in self._reader.connections if found.topic in topics]
        try:
            for connection, time, data in self._reader.messages(connections=wanted):
                message = self._reader.deserialize(data, connection.msgtype)
                yield Recorded(connection.topic, 1e-6 * (time // 1000), message)
        except Exception as error:  # as above
            raise DataError(f"{self.path}: damaged: {error!s:.200}") from None

    def close(self) -> None:
        """Closes the files."""
        self._reader.close()
