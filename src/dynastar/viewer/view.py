"""Which part of the world a picture shows, and the map's colours there."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb

from dynastar.grid import OccupancyGrid
from dynastar.viewer import palette

Floats = npt.NDArray[np.float64]
Picture = npt.NDArray[np.uint8]

LARGEST_IMAGE = 3000  # pixels a side of a map's picture; larger ones are averaged down
CLOSE_UP_BELOW = 0.35  # share of the map's area under which only the mission's part is shown


class View(NamedTuple):
    """The stretch of the world that a picture shows, in metres."""

    x_low: float
    y_low: float
    x_high: float
    y_high: float

    @property
    def width(self) -> float:
        """Along x, in metres."""
        return self.x_high - self.x_low

    @property
    def height(self) -> float:
        """Along y, in metres."""
        return self.y_high - self.y_low

    @property
    def diagonal(self) -> float:
        """Corner to corner, in metres."""
        return math.hypot(self.width, self.height)

    def grown(self, margin: float) -> "View":
        """The view with ``margin`` metres more on every side."""
        return View(
            self.x_low - margin, self.y_low - margin, self.x_high + margin, self.y_high + margin
        )

    def within(self, other: "View") -> "View":
        """The part of the view that lies in ``other``."""
        return View(
            max(self.x_low, other.x_low),
            max(self.y_low, other.y_low),
            min(self.x_high, other.x_high),
            min(self.y_high, other.y_high),
        )


def view_of(points: Floats) -> View:
    """The smallest view of points (n >= 1, 2)."""
    return View(*points.min(axis=0).tolist(), *points.max(axis=0).tolist())


def known_view(grid: OccupancyGrid) -> View:
    """The view of all that the map knows, with a little of the unknown round it."""
    known = ~grid.unknown
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if len(rows) == 0:
        rows, columns = np.arange(grid.rows), np.arange(grid.columns)
    top, right = rows[-1] + 1, columns[-1] + 1
    corners = [(rows[0], columns[0]), (rows[0], right), (top, columns[0]), (top, right)]
    whole = [(0, 0), (0, grid.columns), (grid.rows, 0), (grid.rows, grid.columns)]
    known_part = view_of(grid.frame.points_to_world(np.array(corners)))
    margin = 0.02 * known_part.diagonal
    return known_part.grown(margin).within(view_of(grid.frame.points_to_world(np.array(whole))))


def mission_view(grid: OccupancyGrid, places: Sequence[Floats]) -> View:
    """The whole map, or a close-up of ``places`` (each (n, 2)) where they take but little of it."""
    everything = known_view(grid)
    points = np.concatenate([np.asarray(place, dtype=float).reshape(-1, 2) for place in places])
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        return everything
    places_view = view_of(points)
    close_up = places_view.grown(max(2.0, 0.12 * places_view.diagonal)).within(everything)
    small = close_up.width * close_up.height < CLOSE_UP_BELOW * everything.width * everything.height
    return close_up if small and min(close_up.width, close_up.height) > 0 else everything


class MapImage(NamedTuple):
    """Colours of a map's window: ``rgb`` (n, m, 3) spans cells [row, row_end) x [column, ...)."""

    rgb: Picture
    row: int
    column: int
    row_end: int
    column_end: int


def map_image(grid: OccupancyGrid, view: View, largest: int = LARGEST_IMAGE) -> MapImage:
    """The map's colours where ``view`` shows it, averaged down to ``largest`` pixels a side."""
    x0, y0, x1, y1 = view
    corners = grid.frame.points_to_grid(np.array([(x0, y0), (x1, y0), (x0, y1), (x1, y1)]))
    row, column = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
    row_end, column_end = np.minimum(
        np.ceil(corners.max(axis=0)).astype(int), (grid.rows, grid.columns)
    )
    window = (slice(row, row_end), slice(column, column_end))
    part = OccupancyGrid(grid.values[window], grid.frame)
    kinds = part.unknown.astype(np.uint8)
    if grid.speed_limit is not None:
        kinds[np.isfinite(grid.speed_limit[window]) & (kinds == 0)] = 2
    if grid.keepout is not None:
        kinds[grid.keepout[window]] = 3
    kinds[part.occupied] = 4
    names = (palette.FREE, palette.UNKNOWN, palette.SLOW, palette.KEEPOUT, palette.OCCUPIED)
    colours = np.array([[round(255 * c) for c in to_rgb(name)] for name in names], dtype=np.uint8)
    rgb = averaged_down(colours[kinds], largest)
    return MapImage(rgb, int(row), int(column), int(row_end), int(column_end))


def averaged_down(image: Picture, largest: int) -> Picture:
    """The image, or its averages where a side has more than ``largest`` pixels."""
    factor = largest / max(image.shape[:2])
    if factor >= 1.0:
        return image
    height, width = (max(1, round(factor * side)) for side in image.shape[:2])
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
