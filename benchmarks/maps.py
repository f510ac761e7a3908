"""Families of grids to search, seeded, and queries on them: the same for everybody who is timed."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench.families import corridors
from dynastar.io.movingai import load_movingai_map

Mask = npt.NDArray[np.bool_]
Cell = tuple[int, int]


class Case(NamedTuple):
    """A map and what is asked of it: pairs of free cells with a way between them."""

    kind: str
    name: str
    occupied: Mask
    queries: list[tuple[Cell, Cell]]


def random_cells(n: int, density: float, seed: int) -> Mask:
    """Every cell for itself."""
    rng = np.random.default_rng([1, n, round(100 * density), seed])
    occupied = np.empty((n, n), bool)
    for row in range(0, n, 256):  # in strips, for the numbers take eight times the room
        occupied[row : row + 256] = rng.random(occupied[row : row + 256].shape) < density
    return occupied


def rooms(n: int, size: int, seed: int) -> Mask:
    """Square rooms with walls a cell thick; most neighbours share a door two cells wide."""
    rng = np.random.default_rng([2, n, size, seed])
    occupied = np.zeros((n, n), bool)
    occupied[::size] = occupied[:, ::size] = True
    occupied[-1] = occupied[:, -1] = True
    for top in range(0, n - size, size):
        for left in range(0, n - size, size):
            for down, right in ((1, 0), (0, 1)):
                if rng.random() < 0.8:
                    at = int(rng.integers(2, size - 2))
                    wall = (top + size, left + at) if down else (top + at, left + size)
                    if max(wall) < n - 2:
                        occupied[wall] = occupied[wall[0] + right, wall[1] + down] = False
    return occupied


def maze(n: int, corridor: int, seed: int) -> Mask:
    """A maze with one way between any two places (depth first), corridors so many cells wide."""
    return corridors(np.random.default_rng([3, n, corridor, seed]), n, corridor)


def office(n: int, seed: int) -> Mask:
    """Rooms with desks in them: blocks of 3 x 8 cells, and a few cells of clutter."""
    rng = np.random.default_rng([4, n, seed])
    occupied = rooms(n, 48, seed)
    for _ in range(n * n // 700):
        tall, wide = (3, 8) if rng.random() < 0.5 else (8, 3)
        top, left = rng.integers(1, n - 9, 2)
        occupied[top : top + tall, left : left + wide] = True
    return occupied


def queries(occupied: Mask, count: int, seed: int) -> list[tuple[Cell, Cell]]:
    """Pairs of cells of the largest connected piece, far apart more often than near."""
    import cv2

    free = (~occupied).view(np.uint8)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(free, connectivity=4)
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    cells = np.flatnonzero(labels == largest)
    rng = np.random.default_rng([5, seed])
    found = []
    for _ in range(count):
        chosen = np.unravel_index(cells[rng.integers(0, len(cells), (3, 2))], occupied.shape)
        pairs = np.stack(chosen, axis=-1)
        far = np.abs(pairs[:, 0] - pairs[:, 1]).sum(axis=1).argmax()
        start, goal = pairs[far]
        found.append(((int(start[0]), int(start[1])), (int(goal[0]), int(goal[1]))))
    return found


def cases(data: Path | None, seed: int = 0, count: int = 5) -> Iterator[Case]:
    """All maps of the tables; the MovingAI ones only where the data lies."""
    drawn: list[tuple[str, str, Mask]] = []
    for n in (256, 512, 1024):
        for density in (0.1, 0.2, 0.3, 0.4):
            drawn.append(("random", f"{n}, {density:.0%}", random_cells(n, density, seed)))
    for n in (256, 512, 1024):
        for size in (9, 17, 33, 65):
            drawn.append(("rooms", f"{n}, {size}", rooms(n, size, seed)))
        for corridor in (1, 2, 4, 8, 16):
            drawn.append(("maze", f"{n}, {corridor}", maze(n, corridor, seed)))
    for n in (2048, 4096):
        drawn.append(("large", f"{n}, random 20%", random_cells(n, 0.2, seed)))
        drawn.append(("large", f"{n}, rooms 65", rooms(n, 65, seed)))
        drawn.append(("large", f"{n}, maze 8", maze(n, 8, seed)))
        drawn.append(("large", f"{n}, office", office(n, seed)))
    if data is not None:
        for path in sorted(data.glob("**/*.map")):
            drawn.append(("movingai", path.stem, load_movingai_map(path).occupied))
    for kind, name, occupied in drawn:
        yield Case(kind, name, occupied, queries(occupied, count, seed))
