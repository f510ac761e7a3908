"""Whether a way exists in a true static world: checked on fine cells, with a band left undecided.

``careful`` asks whether the robot gets to the goal and keeps ``CAREFUL`` metres on each side, which is
what the errors that a navigator declares and half a diagonal of a map's cell take. ``possible`` asks
whether a disc of the inscribed radius less ``BAND`` gets within reach of the goal. A world in which the
first holds has a way, one in which the second fails has none, and one between the two is decided by
a few centimetres.

A disc's way is a connected part of the free cells. For a polygon it is a connected part of positions
and 16 headings: it drives straight along its heading, forwards or backwards, and turns on the spot. A
robot that drives arcs may need less room.
"""

import math

import cv2
import numpy as np
import numpy.typing as npt
import shapely

from dynastar.bench.suites.random_layout import CAREFUL, Point, StaticWorld
from dynastar.clearance import distance_field
from dynastar.compiled import njit
from dynastar.footprint import Footprint

Mask = npt.NDArray[np.bool_]

FINER = 2  # fine cells along a cell of the map
BAND = 0.03  # m by which the inscribed disc is shrunk where no way should be left

# Steps (columns, rows) of the 16 headings, counter-clockwise from +x.
STEPS = np.array(
    [
        (1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1),
        (-1, 0), (-2, -1), (-1, -1), (-1, -2), (0, -1), (1, -2), (1, -1), (2, -1),
    ]
)  # fmt: skip


class TrueSpace:
    """A true world on fine cells: ``gaps`` are metres from a cell's centre to anything solid."""

    def __init__(self, world: StaticWorld) -> None:
        fine = world.grid.refined(FINER)
        self.cell = fine.resolution
        solid = np.array(fine.occupied)
        for ring in world.obstacles:
            _fill(solid, ring / self.cell)
        self.gaps = np.maximum(distance_field(solid, self.cell) - 0.5 * self.cell, 0.0)

    def careful(self, footprint: Footprint, start: tuple[float, float, float], goal: Point) -> bool:
        """Whether the robot gets from ``start`` to the goal and keeps ``CAREFUL`` m on each side."""
        if footprint.is_disc:
            free = self.gaps > footprint.circumscribed + CAREFUL
            return self._joins(free, (start[0], start[1]), goal)
        layers = turned_free(self.gaps > CAREFUL, footprint, self.cell)
        heading = round(start[2] / (math.tau / 16)) % 16
        (row, column), (there, beside) = self._cell(start), self._cell(goal)
        found = reached(layers, STEPS, row, column, heading)
        return bool(found[:, there, beside].any())

    def possible(self, footprint: Footprint, start: Point, goal: Point, reach: float) -> bool:
        """Whether a disc, smaller than the robot by ``BAND``, gets within ``reach`` m of the goal."""
        free = (self.gaps > footprint.inscribed - BAND).astype(np.uint8)
        _, parts = cv2.connectedComponents(free, connectivity=8)
        rows, columns = np.indices(free.shape)
        y, x = (rows + 0.5) * self.cell, (columns + 0.5) * self.cell
        near = np.hypot(x - goal[0], y - goal[1]) <= reach
        return bool((parts[near & (free > 0)] == parts[self._cell(start)]).any())

    def _cell(self, point: tuple[float, ...]) -> tuple[int, int]:
        return int(point[1] / self.cell), int(point[0] / self.cell)

    def _joins(self, free: Mask, start: Point, goal: Point) -> bool:
        _, parts = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
        part = parts[self._cell(start)]
        return bool(part != 0 and part == parts[self._cell(goal)])


def turned_free(free: Mask, footprint: Footprint, cell: float) -> Mask:
    """Where a polygon fits, [32, rows, columns]: 16 headings, each followed by one half-way on."""
    reach = math.ceil(footprint.circumscribed / cell) + 1
    angles = np.arctan2(STEPS[:, 1], STEPS[:, 0])
    between = angles + 0.5 * np.mod(np.roll(angles, -1) - angles, math.tau)
    y, x = np.meshgrid(*[np.arange(-reach, reach + 1) * cell] * 2, indexing="ij")
    layers = np.empty((32, *free.shape), np.bool_)
    solid = (~free).astype(np.uint8)
    for number, angle in enumerate(np.column_stack([angles, between]).ravel()):
        cos, sin = math.cos(angle), math.sin(angle)
        ring = footprint.vertices @ np.array([[cos, sin], [-sin, cos]])
        inside = shapely.contains_xy(shapely.Polygon(ring), x, y)
        # A kernel's cell counts where the solid cell lies relative to the robot, hence the flip.
        kernel = np.ascontiguousarray(inside, np.uint8)
        layers[number] = (
            cv2.dilate(solid, kernel, borderType=cv2.BORDER_CONSTANT, borderValue=1) == 0
        )
    return layers


@njit(cache=True)
def reached(
    layers: Mask, steps: npt.NDArray[np.int64], row: int, column: int, heading: int
) -> Mask:
    """Which (heading, row, column) [16, rows, columns] a polygon gets to from one of them."""
    rows, columns = layers.shape[1:]
    found = np.zeros((16, rows, columns), np.bool_)
    stack = [(heading, row, column)]
    if layers[2 * heading, row, column]:
        found[heading, row, column] = True
    else:
        stack.pop()
    while len(stack) > 0:
        k, r, c = stack.pop()
        for sign in (-1, 1):
            rr, cc = r + sign * steps[k, 1], c + sign * steps[k, 0]
            if (
                0 <= rr < rows
                and 0 <= cc < columns
                and layers[2 * k, rr, cc]
                and not found[k, rr, cc]
            ):
                found[k, rr, cc] = True
                stack.append((k, rr, cc))
            kk = (k + sign) % 16
            half = 2 * k + 1 if sign > 0 else 2 * kk + 1
            if layers[half, r, c] and layers[2 * kk, r, c] and not found[kk, r, c]:
                found[kk, r, c] = True
                stack.append((kk, r, c))
    return found


def _fill(solid: Mask, ring: npt.NDArray[np.float64]) -> None:
    """Marks the cells whose centres lie in a polygon (k, 2) of column and row."""
    low = np.maximum(np.floor(ring.min(axis=0)).astype(int), 0)
    high = np.ceil(ring.max(axis=0)).astype(int) + 1
    part = solid[low[1] : high[1], low[0] : high[0]]
    rows, columns = (np.asarray(i) for i in np.indices(part.shape))
    x, y = columns + low[0] + 0.5, rows + low[1] + 0.5
    part |= shapely.contains_xy(shapely.Polygon(ring), x, y)
