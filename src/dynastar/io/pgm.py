"""Portable grey maps: P5 (binary, 8 or 16 bits) and P2 (plain), read and written exactly."""

import re
import warnings
from pathlib import Path

import numpy as np
import numpy.typing as npt

from dynastar.errors import MapError
from dynastar.io.files import MAX_TEXT_BYTES, check_size

MOST_HEADER = 2**16  # bytes, with comments

_GAP = rb"(?:\s|#[^\r\n]*[\r\n])+"
_HEADER = re.compile(rb"P([25])" + _GAP.join([b"", *3 * [rb"(\d{1,9})"]]) + rb"\s")


def read_pgm(data: bytes, path: Path) -> tuple[npt.NDArray[np.unsignedinteger], int]:
    """Pixels [rows, columns] from the image's top, uint8 or uint16, and their largest legal value.

    ``path`` is for the messages. Raises MapError if header and content disagree.
    """
    header = _HEADER.match(data, 0, MOST_HEADER)
    if header is None:
        raise MapError(
            f"{path}: the PGM header is broken, expected P2 or P5, width, height, maximum"
        )
    kind, columns, rows, full = (int(group) for group in header.groups())
    check_size(rows, columns, path)
    if not 1 <= full <= 65535:
        raise MapError(f"{path}: the PGM header's maximum is {full}, expected 1 to 65535")
    body = memoryview(data)[header.end() :]
    if kind == 5:
        pixels = _binary(body, rows * columns, np.dtype("u1" if full < 256 else ">u2"), path)
    else:
        pixels = _plain(body, rows * columns, path)
    if pixels.max() > full or pixels.min() < 0:
        raise MapError(f"{path}: a pixel lies outside 0 to {full}, the header's maximum")
    return pixels.reshape(rows, columns).astype(np.uint8 if full < 256 else np.uint16), full


def write_pgm(pixels: npt.NDArray[np.uint8]) -> bytes:
    """A P5 file of ``pixels`` [rows, columns], top row first."""
    rows, columns = pixels.shape
    return b"P5\n%d %d\n255\n" % (columns, rows) + pixels.tobytes()


def _binary(body: memoryview, count: int, dtype: np.dtype, path: Path) -> npt.NDArray[np.integer]:
    expected = count * dtype.itemsize
    if len(body) < expected:
        raise MapError(
            f"{path}: the image ends after {len(body)} of the {expected} bytes its header promises"
        )
    if len(body) > expected and bytes(body[expected:]).strip():
        raise MapError(
            f"{path}: the image has {len(body) - expected} bytes more than its header promises"
        )
    return np.frombuffer(body[:expected], dtype)


def _plain(body: memoryview, count: int, path: Path) -> npt.NDArray[np.integer]:
    if len(body) > MAX_TEXT_BYTES:
        raise MapError(f"{path}: a plain PGM has at most {MAX_TEXT_BYTES} bytes, use P5")
    if not set(bytes(body)) <= set(b"0123456789 \t\r\n\v\f"):
        raise MapError(f"{path}: a plain PGM holds digits and spaces only, this one does not")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            pixels = np.fromstring(bytes(body).decode("ascii"), dtype=np.int64, sep=" ")
        except (ValueError, DeprecationWarning):
            raise MapError(f"{path}: the numbers of this plain PGM cannot be read") from None
    if len(pixels) != count:
        raise MapError(
            f"{path}: the image has {len(pixels)} pixels where its header promises {count}"
        )
    return pixels
