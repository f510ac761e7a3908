"""Obstacles that are painted by hand: cells over a map, as the few polygons that they make up."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.grid import GridFrame, OccupancyGrid

Floats = npt.NDArray[np.float64]
Cells = npt.NDArray[np.bool_]
Box = tuple[int, int, int, int]  # rows from and below, columns from and below

CELL = 0.1  # m, the side of a painted cell
WITHIN = 0.7072  # cells from its centre, that the whole of a cell is in
MOST_CELLS = 1000  # along a side of the map; the cells of larger maps are larger
TILE = 32  # cells along a side of a tile; the rectangles of a tile are made together


class Paint:
    """Painted cells in the frame of a map, whose extent they cover.

    A stroke costs what it changes: it makes the rectangles of the tiles again that it is in.
    """

    def __init__(self, grid: OccupancyGrid) -> None:
        height, width = grid.rows * grid.resolution, grid.columns * grid.resolution
        side = max(CELL, height / MOST_CELLS, width / MOST_CELLS)
        self._frame = GridFrame(side, *grid.frame[1:])
        self._cells = np.zeros((int(np.ceil(height / side)), int(np.ceil(width / side))), np.bool_)
        self._tiles: dict[tuple[int, int], dict[Box, Floats]] = {}
        self._stale: set[tuple[int, int]] = set()

    def stroke(self, points: Sequence[Sequence[float]], radius: float, erase: bool = False) -> None:
        """Paints or erases cells within ``radius`` of a line (n, 2), metres."""
        line = self._frame.points_to_grid(np.asarray(points, np.float64))
        reach = max(radius / self._frame.resolution, WITHIN)
        for piece in _pieces(line, reach, self._cells.shape):
            low = np.maximum(np.floor(piece.min(axis=0) - reach), 0).astype(int)
            high = np.minimum(np.ceil(piece.max(axis=0) + reach), self._cells.shape).astype(int)
            if (low >= high).any():
                continue
            cells = np.indices(tuple(high - low)).reshape(2, -1).T + low
            cells = cells[_distance(cells + 0.5, *piece) <= reach]
            rows, columns = cells[self._cells[cells[:, 0], cells[:, 1]] == erase].T
            self._cells[rows, columns] = not erase
            self._stale.update(
                zip((rows // TILE).tolist(), (columns // TILE).tolist(), strict=True)
            )

    def keep_clear(self, places: Floats, radii: Floats) -> None:
        """Erases what lies within ``radii`` (m,) of places (m, 2), metres."""
        for place, radius in zip(places, radii, strict=True):
            if np.isfinite(place).all():
                self.stroke([place], float(radius), erase=True)

    def renew(self) -> list[Floats]:
        """Brings ``rings`` up to date after strokes, and returns those that are new."""
        new: list[Floats] = []
        for tile in sorted(self._stale):
            before = self._tiles.pop(tile, {})
            row, column = tile[0] * TILE, tile[1] * TILE
            boxes = _boxes(self._cells[row : row + TILE, column : column + TILE], row, column)
            now = {box: before[box] if box in before else self._ring(box) for box in boxes}
            new += [ring for box, ring in now.items() if box not in before]
            if now:
                self._tiles[tile] = now
        self._stale.clear()
        return new

    @property
    def rings(self) -> list[Floats]:
        """Rectangles (4, 2), metres, that cover the painted cells; the same arrays until they change."""
        return [ring for tile in self._tiles.values() for ring in tile.values()]

    def _ring(self, box: Box) -> Floats:
        first, after, begin, end = box
        corners = [[first, begin], [first, end], [after, end], [after, begin]]
        return self._frame.points_to_world(np.array(corners, np.float64))


def _pieces(line: Floats, reach: float, shape: tuple[int, ...]) -> Iterator[Floats]:
    """A line as its points and parts (2, 2) of at most a tile, without what is far off the cells."""
    for point in line:
        yield np.array([point, point])
    if (line == line[0]).all():
        return
    rows, columns = shape
    near = shapely.clip_by_rect(
        shapely.LineString(line), -reach, -reach, rows + reach, columns + reach
    )
    for part in shapely.get_parts(shapely.segmentize(near, TILE)):
        yield from map(np.array, pairwise(shapely.get_coordinates(part)))


def _boxes(cells: Cells, row: int, column: int) -> list[Box]:
    """Boxes that cover the true cells of a part of a table: equal runs of adjoining rows are one.

    The part begins at ``row`` and ``column``.
    """
    steps = np.diff(np.pad(cells, ((0, 1), (1, 1))).astype(np.int8), axis=1)
    begun: dict[tuple[int, int], int] = {}  # row where a box of these columns begins
    boxes = []
    for here, step in enumerate(steps, row):
        begins, ends = (np.flatnonzero(step == way) + column for way in (1, -1))
        runs = list(zip(begins.tolist(), ends.tolist(), strict=True))
        for run in begun.keys() - runs:
            boxes.append((begun.pop(run), here, *run))
        for run in runs:
            begun.setdefault(run, here)
    return boxes


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
