"""PNG images, decoded only after their own header, check sums and content agree."""

import io
import struct
import warnings
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image
from PIL.PngImagePlugin import PngImageFile

from dynastar.errors import MapError
from dynastar.grid import MAX_CELLS
from dynastar.io.files import check_size

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # by colour type
_ADAM7 = (
    (0, 0, 8, 8),
    (4, 0, 8, 8),
    (0, 4, 4, 8),
    (2, 0, 4, 4),
    (0, 2, 2, 4),
    (1, 0, 2, 2),
    (0, 1, 1, 2),
)
_PIECE = 2**20
MAX_DECODED = MAX_CELLS  # bytes of a decoded image: a byte for each cell of the largest map


def read_png(data: bytes, path: Path) -> npt.NDArray[np.unsignedinteger]:
    """Pixels from the image's top: [rows, columns] grey, or [rows, columns, 3 or 4] in colour.

    The fourth is alpha. uint16 for grey of 16 bits, else uint8. ``path`` is for the messages.
    Raises MapError.
    """
    if len(data) < 33 or data[12:16] != b"IHDR":
        raise MapError(f"{path}: the PNG header is broken or cut off")
    columns, rows = struct.unpack(">II", data[16:24])
    check_size(rows, columns, path)
    depth, colour = data[24:26]
    if (rows * columns * depth * _CHANNELS.get(colour, 1)) // 8 > MAX_DECODED:
        raise MapError(
            f"{path}: {columns} x {rows} pixels have more than {MAX_DECODED} bytes: "
            "expected grey of 8 bits"
        )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            PngImageFile(io.BytesIO(data)).verify()
            _check_length(data, columns, rows)
            return _pixels(PngImageFile(io.BytesIO(data)))
        except MemoryError:
            raise MapError(f"{path}: {columns} x {rows} pixels do not fit in memory") from None
        except Exception as trouble:  # Pillow raises a dozen kinds, and warnings, for damage
            raise MapError(f"{path}: the PNG image is damaged ({trouble!s:.100})") from None


def write_png(pixels: npt.NDArray[np.uint8]) -> bytes:
    """A PNG file of ``pixels`` [rows, columns] grey or [rows, columns, 2] grey and alpha."""
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()


def _pixels(image: PngImageFile) -> npt.NDArray[np.unsignedinteger]:
    image.load()
    if image.mode.startswith("I"):
        return np.asarray(image).astype(np.uint16)
    if image.mode in ("LA", "PA", "RGBA") or "transparency" in image.info:
        return np.asarray(image.convert("RGBA"))
    return np.asarray(image.convert("L" if image.mode in ("1", "L") else "RGB"))


def _check_length(data: bytes, columns: int, rows: int) -> None:
    """Raises ValueError unless the compressed content has the size that the header promises."""
    depth, colour, _, _, interlaced = data[24:29]
    bits = depth * _CHANNELS[colour]
    passes = _ADAM7 if interlaced else ((0, 0, 1, 1),)
    expected = 0
    for x, y, step_x, step_y in passes:
        across, down = -((x - columns) // step_x), -((y - rows) // step_y)
        if across > 0 and down > 0:
            expected += down * (1 + (across * bits + 7) // 8)
    length, stream = 0, zlib.decompressobj()
    for piece in _content(data):
        while piece and length <= expected:
            length += len(stream.decompress(piece, _PIECE))
            piece = stream.unconsumed_tail
    while length <= expected and (rest := len(stream.decompress(stream.unconsumed_tail, _PIECE))):
        length += rest
    if length != expected or not stream.eof:
        raise ValueError("its content is not of the size that its header promises")


def _content(data: bytes) -> Iterator[bytes]:
    """The compressed pieces; raises ValueError if the file does not go on to its end mark."""
    at, kind = len(SIGNATURE), b""
    while kind != b"IEND":
        size, kind = struct.unpack(">I4s", data[at : at + 8].ljust(8, b"\0"))
        at += size + 12
        if at > len(data):
            raise ValueError("it is cut off")
        if kind == b"IDAT":
            yield data[at - 4 - size : at - 4]
