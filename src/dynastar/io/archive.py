"""Arrays of an ``.npz`` file, read within a limit of bytes, also where the file was cut off."""

import io
import struct
import zipfile
import zlib
from collections.abc import Iterator
from typing import Any

import numpy.typing as npt

from dynastar.errors import EpisodeError
from dynastar.io.npy import TEXT_TOO, read_npy

Arrays = dict[str, npt.NDArray[Any]]

MAX_MEMBERS = 1000
_HEAD = struct.Struct("<4sHHHHHIIIHH")  # of a member: signature, version, flags, method ...
_SIGNATURE, _INDEXED, _DEFLATED = b"PK\x03\x04", b"PK\x01\x02", 8
_SUFFIX = ".npy"


def arrays_in(data: bytes, names: set[str], limit: int) -> Arrays:
    """The arrays of these names in a whole file; other members are not unpacked.

    EpisodeError for more than ``limit`` bytes unpacked; zipfile and zlib raise for damage.
    """
    check_count(data)
    found = {}
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        files = {f"{name}{_SUFFIX}" for name in names}
        members = [member for member in archive.infolist() if member.filename in files]
        if sum(member.file_size for member in members) > limit:
            raise _too_large(limit)
        for member in members:
            # zipfile unpacks other methods than these without a limit.
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise EpisodeError(f"'{member.filename}' is not compressed as in an .npz file")
            with archive.open(member) as stream:
                content = stream.read(member.file_size)
            found[member.filename.removesuffix(_SUFFIX)] = read_npy(content, TEXT_TOO)
    return found


def arrays_before_cut(data: bytes, limit: int) -> Arrays:
    """The arrays by name up to the first that is not whole; EpisodeError for more than ``limit`` bytes."""
    check_count(data)
    return {
        name.removesuffix(_SUFFIX): read_npy(content, TEXT_TOO)
        for name, content in _members(data, limit)
    }


def check_count(data: bytes) -> None:
    """Raises EpisodeError for a file of more than ``MAX_MEMBERS`` members."""
    if max(data.count(_SIGNATURE), data.count(_INDEXED)) > MAX_MEMBERS:
        raise EpisodeError(f"it has more than {MAX_MEMBERS} members")


def _members(data: bytes, limit: int) -> Iterator[tuple[str, bytes]]:
    """Name and content of each member that is whole."""
    at, left = 0, limit
    while len(data) - at > _HEAD.size:
        signature, _, _, method, _, _, checksum, _, _, named, extra = _HEAD.unpack_from(data, at)
        start = at + _HEAD.size + named + extra
        if signature != _SIGNATURE or method != _DEFLATED:
            return
        inflated = zlib.decompressobj(-zlib.MAX_WBITS)
        try:
            content = inflated.decompress(data[start:], left + 1)
        except zlib.error:
            return
        left -= len(content)
        if left < 0:
            raise _too_large(limit)
        if not inflated.eof or zlib.crc32(content) != checksum:
            return
        yield data[at + _HEAD.size : start - extra].decode(errors="replace"), content
        at = len(data) - len(inflated.unused_data)


def _too_large(limit: int) -> EpisodeError:
    return EpisodeError(f"unpacked, it has more than {limit} bytes")
