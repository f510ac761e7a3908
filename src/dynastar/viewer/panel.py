"""A map for print, and what stands round it: its axes, words, letters and legend."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynastar.grid import OccupancyGrid
from dynastar.viewer import layers, palette
from dynastar.viewer.cells import show_cells
from dynastar.viewer.sheet import SMALL, TEXT, legend_style, literal, plain, room, sheet
from dynastar.viewer.view import View

Floats = npt.NDArray[np.float64]

LEFT, RIGHT, LOW, ABOVE, ROW = 0.36, 0.16, 0.34, 0.38, 0.145  # inches round a map, and of a line


def show_map(axes: Axes, grid: OccupancyGrid, labelled: bool = True, unit: str = "m") -> None:
    """The map's occupied cells as one shape, the whole of it, on white."""
    view = whole(grid)
    axes.set(xlim=(view.x_low, view.x_high), ylim=(view.y_low, view.y_high), aspect="equal")
    axes.set_xlabel(f"x, {unit}")
    if labelled:
        axes.set_ylabel(f"y, {unit}")
    else:
        axes.tick_params(labelleft=False)
    step = 5.0 * math.ceil(view.width / 25.0)
    for axis, low, high in ((axes.xaxis, *view[::2]), (axes.yaxis, *view[1::2])):
        axis.set_ticks(np.arange(step * math.floor(low / step + 1.0), high + 1e-9, step))
    plain(axes)
    axes.xaxis.labelpad = axes.yaxis.labelpad = 1.0
    show_cells(axes, np.argwhere(grid.occupied), grid.frame, facecolor=palette.OCCUPIED, zorder=2)


def whole(grid: OccupancyGrid) -> View:
    """All of a map that is not turned."""
    frame = grid.frame
    x, y = frame.to_world(grid.rows, grid.columns)
    return View(frame.x, frame.y, x, y)


def show_end(axes: Axes, place: Floats, away: Floats, letters: str) -> None:
    """The letter of a place where a path begins or ends."""
    layers.mark(axes, place, away, letters, size=SMALL, reach=11.0)


def map_sheet(grid: OccupancyGrid, width: float, rows: int) -> tuple[Figure, Axes]:
    """A sheet with one map, and ``rows`` lines for a legend below."""
    view = whole(grid)
    across = width - LEFT - RIGHT
    tall = across * view.height / view.width
    low = LOW + ROW * rows + 0.06
    figure = sheet(width, low + tall + 0.24)
    axes = room(figure, LEFT, low, across, tall)
    show_map(axes, grid)
    return figure, axes


def say(figure: Figure, axes: Axes, words: str, title: str = "") -> None:
    """A line of words over a map, and a title over that."""
    box = axes.get_position()
    high = box.y1 + 0.06 / figure.get_figheight()
    figure.text(box.x0, high, literal(words), fontsize=SMALL, color=palette.INK, va="bottom")
    high += 0.14 / figure.get_figheight()
    style: dict[str, Any] = {"fontsize": TEXT, "fontweight": "bold", "va": "bottom"}
    figure.text(box.x0, high, literal(title), color=palette.INK, **style)


def legend(figure: Figure, entries: Sequence[Artist], columns: int) -> None:
    """The legend, along the lower edge of the sheet."""
    place = (0.5, 0.05 / figure.get_figheight())
    style = legend_style()
    figure.legend(
        handles=list(entries), loc="lower center", bbox_to_anchor=place, ncols=columns, **style
    )
