"""Obstacles that are painted by hand: cells over a map, as the few polygons that they make up."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dynastar.grid import GridFrame, OccupancyGrid

Floats = npt.NDArray[np.float64]

CELL = 0.1  # m, the side of a painted cell
WITHIN = 0.7072  # cells from its centre, that the whole of a cell is in
MOST_CELLS = 1000  # along a side of the map; the cells of larger maps are larger


class Paint:
    """Painted cells in the frame of a map, whose extent they cover."""

    def __init__(self, grid: OccupancyGrid) -> None:
        height, width = grid.rows * grid.resolution, grid.columns * grid.resolution
        side = max(CELL, height / MOST_CELLS, width / MOST_CELLS)
        self._frame = GridFrame(side, *grid.frame[1:])
        self._cells = np.zeros((int(np.ceil(height / side)), int(np.ceil(width / side))), np.bool_)

    def stroke(
        self, points: Sequence[Sequence[float]], radius: float, erase: bool = False
    ) -> Floats:
        """Paints or erases cells within ``radius`` of a line (n, 2), metres; their centres (m, 2)."""
        side = self._frame.resolution
        line = self._frame.points_to_grid(np.asarray(points, np.float64))
        reach = max(radius / side, WITHIN)
        low = np.maximum(np.floor(line.min(axis=0) - reach), 0).astype(int)
        high = np.minimum(np.ceil(line.max(axis=0) + reach), self._cells.shape).astype(int)
        if (low >= high).any():
            return np.empty((0, 2))
        centres = np.indices(tuple(high - low)).reshape(2, -1).T + low + 0.5
        near = np.zeros(len(centres), np.bool_)
        for a, b in zip(line, line[1:] if len(line) > 1 else line, strict=False):
            near |= _distance(centres, a, b) <= reach
        rows, columns = centres[near].astype(int).T
        self._cells[rows, columns] = not erase
        return self._frame.points_to_world(centres[near])

    def keep_clear(self, places: Floats, radii: Floats) -> None:
        """Erases what lies within ``radii`` (m,) of places (m, 2), metres."""
        for place, radius in zip(places, radii, strict=True):
            if np.isfinite(place).all():
                self.stroke([place], float(radius), erase=True)

    def rings(self) -> list[Floats]:
        """Rectangles (4, 2), metres, that cover the painted cells: equal runs of adjoining rows are one."""
        steps = np.diff(np.pad(self._cells, ((0, 1), (1, 1))).astype(np.int8), axis=1)
        any_steps = steps.any(axis=1)
        begun: dict[tuple[int, int], int] = {}  # row where a rectangle of these columns begins
        rectangles = []
        for row in np.flatnonzero(any_steps | np.roll(any_steps, 1)).tolist():
            begins, ends = (np.flatnonzero(steps[row] == step).tolist() for step in (1, -1))
            here = set(zip(begins, ends, strict=True))
            for run in begun.keys() - here:
                rectangles.append((begun.pop(run), row, *run))
            for run in here:
                begun.setdefault(run, row)
        corners = [
            [[first, begin], [first, end], [after, end], [after, begin]]
            for first, after, begin, end in rectangles
        ]
        return [self._frame.points_to_world(np.array(ring, np.float64)) for ring in corners]


def _distance(points: Floats, a: Floats, b: Floats) -> Floats:
    """Of points (n, 2) to the line from ``a`` to ``b``."""
    along = b - a
    length = float(along @ along)
    share = (
        np.clip((points - a) @ along / length, 0.0, 1.0)
        if length > 1e-12
        else np.zeros(len(points))
    )
    return np.hypot(*(points - a - share[:, None] * along).T)
