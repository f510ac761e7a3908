"""Compiling or loading the kernels of a single plan."""

import functools

import numpy as np

from dynastar.planning.search import SearchGrid
from dynastar.planning.segments import first_contact, mask_bytes
from dynastar.planning.smoothing import smooth


@functools.cache
def warm_up() -> None:
    """Compile or load the kernels, once in a process, so that it does not count as planning time."""
    blocked = np.zeros((3, 3), dtype=bool)
    SearchGrid(blocked).search((0, 0), (2, 2), "improved")
    smooth(blocked, [[0.5, 0.5], [0.5, 2.5], [2.5, 2.5]], 0.0, 1.0)
    first_contact(mask_bytes(blocked), np.ones((2, 2)), 0.5)
