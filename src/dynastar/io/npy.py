"""NumPy's ``.npy`` files, decoded only after header and size agree."""

import io
import math
from typing import Any

import numpy as np
import numpy.typing as npt

NUMBERS, TEXT_TOO = "biuf", "biufU"  # kinds of dtypes
_WORDS = {NUMBERS: "numbers", TEXT_TOO: "numbers or text"}


def read_npy(data: bytes, kinds: str = NUMBERS) -> npt.NDArray[Any]:
    """The array in a file's bytes, of a dtype of these kinds; ValueError with what is wrong."""
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        read = {(1, 0): np.lib.format.read_array_header_1_0}.get(
            version, np.lib.format.read_array_header_2_0
        )
        shape, _, dtype = read(stream)
    except Exception as error:  # numpy's reader raises many kinds for damage
        raise ValueError(f"this is no NumPy array ({error!s:.80})") from None
    if dtype.kind not in kinds or not all(type(size) is int and size >= 0 for size in shape):
        raise ValueError(
            f"this is no array of {_WORDS[kinds]}: its shape is {shape!s:.60}, of {dtype!s:.40}"
        )
    size = math.prod(shape) * dtype.itemsize
    if len(data) - stream.tell() != size:
        raise ValueError(f"{len(data) - stream.tell()} bytes follow the header, expected {size}")
    return np.asarray(np.load(io.BytesIO(data), allow_pickle=False))
