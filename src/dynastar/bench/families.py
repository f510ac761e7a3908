"""Maps of four kinds in the paper's manner, seeded: each is drawn once and kept, whatever comes of it."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.errors import NoPath
from dynastar.planning import SearchGrid

Mask = npt.NDArray[np.bool_]
Cell = tuple[int, int]

KINDS = ("random", "rooms", "maze", "office")


class Map(NamedTuple):
    """A map [rows, columns], true where occupied, and the way that is asked for: corner to corner."""

    kind: str
    number: int
    occupied: Mask
    start: Cell
    goal: Cell


def draw(kind: str, number: int, seed: int = 0, size: int = 40) -> Map | None:
    """The map of a number; None if no way leads from corner to corner, or there is no free cell there.

    ``size`` is the side in cells. Start and goal are the free cells nearest to the first and to the
    last corner, at most a sixth of the side away.
    """
    rng = np.random.default_rng([seed, KINDS.index(kind), size, number])
    occupied = {"random": scattered, "rooms": rooms, "maze": maze, "office": office}[kind](
        rng, size
    )
    ends = [_nearest_free(occupied, corner) for corner in (0, size - 1)]
    if ends[0] is None or ends[1] is None:
        return None
    try:
        SearchGrid(occupied).search(ends[0], ends[1], "auto")
    except NoPath:
        return None
    return Map(kind, number, occupied, ends[0], ends[1])


def scattered(rng: np.random.Generator, size: int) -> Mask:
    """Every cell for itself, 10 to 35 % of them occupied."""
    return rng.random((size, size)) < rng.uniform(0.10, 0.35)


def rooms(rng: np.random.Generator, size: int) -> Mask:
    """Square rooms, 6 to 12 cells wide, walls a cell thick, doors two cells wide in most walls."""
    width = int(rng.integers(6, 13))
    occupied = _walls(size, width)
    for top in range(0, size - 1, width):
        for left in range(0, size - 1, width):
            for down in (True, False):
                if rng.random() < 0.85:
                    at = int(rng.integers(1, width - 2))
                    _door(occupied, top, left, width, at, down)
    return _framed(occupied)


def maze(rng: np.random.Generator, size: int) -> Mask:
    """Corridors one to three cells wide, and a tenth of the walls left out again."""
    corridor = int(rng.integers(1, 4))
    occupied = corridors(rng, size, corridor)
    k = (size - 1) // (corridor + 1)
    for _ in range(k * k // 10):
        here = (int(rng.integers(k)), int(rng.integers(k)))
        near = _beside(here, k)
        if near:
            _clear(occupied, here, near[int(rng.integers(len(near)))], corridor + 1)
    return occupied


def corridors(rng: np.random.Generator, size: int, corridor: int) -> Mask:
    """A maze with one way between any two places (depth first), corridors so many cells wide."""
    pitch = corridor + 1
    k = (size - 1) // pitch
    occupied = np.ones((size, size), np.bool_)
    seen = np.zeros((k, k), np.bool_)
    seen[0, 0] = True
    stack = [(0, 0)]
    _clear(occupied, (0, 0), (0, 0), pitch)
    while stack:
        here = stack[-1]
        ways = [cell for cell in _beside(here, k) if not seen[cell]]
        if not ways:
            stack.pop()
            continue
        there = ways[int(rng.integers(len(ways)))]
        seen[there] = True
        _clear(occupied, here, there, pitch)
        stack.append(there)
    return occupied


def office(rng: np.random.Generator, size: int) -> Mask:
    """Rooms either side of corridors three cells wide, with desks of 1 x 3 cells and some clutter."""
    width = int(rng.integers(8, 12))
    occupied = np.zeros((size, size), np.bool_)
    top = 0
    while top < size:
        bottom = min(top + width, size - 1)
        occupied[top, :] = occupied[bottom, :] = True
        for left in range(0, size, width):
            occupied[top : bottom + 1, left] = True
            for wall in (top, bottom):
                at = left + int(rng.integers(1, width - 2))
                occupied[wall, at : at + 2] = False
            for _ in range(2):
                tall, wide = (1, 3) if rng.random() < 0.5 else (3, 1)
                row = top + 2 + int(rng.integers(0, max(width - 5, 1)))
                column = left + 2 + int(rng.integers(0, max(width - 5, 1)))
                occupied[row : min(row + tall, bottom - 1), column : column + wide] = True
        top = bottom + 4  # the corridor
    return _framed(occupied | (rng.random((size, size)) < 0.01))


def _walls(size: int, width: int) -> Mask:
    occupied = np.zeros((size, size), np.bool_)
    occupied[::width] = occupied[:, ::width] = True
    return occupied


def _door(occupied: Mask, top: int, left: int, width: int, at: int, down: bool) -> None:
    """Opens two cells of the wall below a room, or of that beside it."""
    if down:
        occupied[top + width : top + width + 1, left + at : left + at + 2] = False
    else:
        occupied[top + at : top + at + 2, left + width : left + width + 1] = False


def _framed(occupied: Mask) -> Mask:
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    return occupied


def _beside(cell: Cell, k: int) -> list[Cell]:
    row, column = cell
    near = ((row, column + 1), (row + 1, column), (row, column - 1), (row - 1, column))
    return [(r, c) for r, c in near if 0 <= r < k and 0 <= c < k]


def _clear(occupied: Mask, a: Cell, b: Cell, pitch: int) -> None:
    """Clears the corridor that two cells of the maze's lattice span."""
    (top, bottom), (left, right) = sorted((a[0], b[0])), sorted((a[1], b[1]))
    occupied[1 + top * pitch : (bottom + 1) * pitch, 1 + left * pitch : (right + 1) * pitch] = False


def _nearest_free(occupied: Mask, corner: int) -> Cell | None:
    free = np.argwhere(~occupied)
    away = np.abs(free - corner).max(axis=1, initial=0)
    if len(free) == 0 or away.min() > len(occupied) / 6:
        return None
    row, column = free[int(np.argmin(np.abs(free - corner).sum(axis=1) + 1e-3 * away))]
    return int(row), int(column)
