"""What is made of each obstacle, kept while the obstacle stays."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Made = TypeVar("Made")


def made_of(
    rings: Sequence[Floats],
    before: dict[int, tuple[Floats, Made]],
    make: Callable[[int, Floats], Made],
) -> dict[int, tuple[Floats, Made]]:
    """Each array of ``rings`` with what ``make(number, ring)`` gives, by the array's id.

    What was made ``before`` of the same array is kept: arrays must not be written to.
    """
    return {
        id(ring): before[id(ring)] if id(ring) in before else (ring, make(number, ring))
        for number, ring in enumerate(rings)
    }
