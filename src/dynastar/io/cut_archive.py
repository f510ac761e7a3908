"""Arrays of an ``.npz`` file that was cut off: those before the cut, read without its index."""

import io
import struct
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import EpisodeError

_HEAD = struct.Struct("<4sHHHHHIIIHH")  # of a member: signature, version, flags, method ...
_SIGNATURE, _DEFLATED = b"PK\x03\x04", 8


def arrays_before_cut(data: bytes, limit: int) -> dict[str, npt.NDArray[Any]]:
    """The arrays by name up to the first that is not whole; EpisodeError for more than ``limit`` bytes."""
    found = {}
    for name, content in _members(data, limit):
        found[name.removesuffix(".npy")] = np.lib.format.read_array(
            io.BytesIO(content), allow_pickle=False
        )
    return found


def _members(data: bytes, limit: int) -> Iterator[tuple[str, bytes]]:
    """Name and content of each member that is whole."""
    at = 0
    while len(data) - at > _HEAD.size:
        signature, _, _, method, _, _, checksum, _, _, named, extra = _HEAD.unpack_from(data, at)
        start = at + _HEAD.size + named + extra
        if signature != _SIGNATURE or method != _DEFLATED:
            return
        inflated = zlib.decompressobj(-zlib.MAX_WBITS)
        try:
            content = inflated.decompress(data[start:], limit + 1)
        except zlib.error:
            return
        limit -= len(content)
        if limit < 0:
            raise EpisodeError("unpacked, it has too many bytes")
        if not inflated.eof or zlib.crc32(content) != checksum:
            return
        yield data[at + _HEAD.size : start - extra].decode(errors="replace"), content
        at = len(data) - len(inflated.unused_data)
