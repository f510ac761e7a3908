"""Fig. 1: the grid model, its cells numbered by Eq. 1."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from dynastar.grid import OccupancyGrid
from dynastar.viewer import palette
from dynastar.viewer.cells import show_cells
from dynastar.viewer.sheet import COLUMN, TEXT, plain, room, sheet

LEFT, RIGHT, LOW, ABOVE = 0.36, 0.1, 0.36, 0.44  # inches round the grid


def draw_numbering(grid: OccupancyGrid, shown: int, width: float = COLUMN) -> Figure:
    """A grid with its cells' numbers (Eq. 1) and the centre of the cell numbered ``shown``.

    The axes are metres from the grid's own corner, as in Eq. 1.
    """
    a = grid.resolution
    across, tall = a * grid.columns, a * grid.rows
    inch = (width - LEFT - RIGHT) / across
    figure = sheet(width, LOW + tall * inch + ABOVE)
    axes = room(figure, LEFT, LOW, across * inch, tall * inch)
    axes.set(xlim=(0.0, across), ylim=(0.0, tall), xlabel="x", ylabel="y")
    axes.set_xticks(a * np.arange(grid.columns + 1), _multiples(grid.columns))
    axes.set_yticks(a * np.arange(grid.rows + 1), _multiples(grid.rows))
    plain(axes)
    axes.xaxis.labelpad = axes.yaxis.labelpad = 1.0
    axes.grid(color=palette.FAINT_INK, linewidth=0.4)
    axes.set_axisbelow(True)
    frame = grid.frame._replace(x=0.0, y=0.0, yaw=0.0)
    show_cells(axes, np.argwhere(grid.occupied), frame, facecolor=palette.OCCUPIED, zorder=2)
    cell = np.array([grid.numbered(shown)])
    show_cells(axes, cell, frame, facecolor=palette.EXPLORED, zorder=1)

    for i in range(1, grid.rows * grid.columns + 1):
        x, y = grid.centre(i)
        dark = bool(grid.occupied[grid.numbered(i)])
        high = 0.24 * a if i == shown else 0.0  # over the centre's dot
        colour = palette.FREE if dark else palette.INK
        words = axes.text(x, y + high, str(i), ha="center", va="center", fontsize=TEXT)
        words.set(color=colour, zorder=5)
        if not dark and i != shown:
            words.set_bbox({"facecolor": palette.FREE, "edgecolor": "none", "pad": 1.2})
    _show_centre(figure, grid, shown)
    x, y = grid.centre(shown)
    guide: dict[str, Any] = {
        "color": palette.FIRST_PATH,
        "linewidth": 0.8,
        "linestyle": (0, (3, 2)),
        "zorder": 3,
    }
    axes.plot([x, x, 0.0], [0.0, y, y], **guide)
    axes.plot(x, y, "o", color=palette.FIRST_PATH, markersize=3.2, zorder=4)
    return figure


def _show_centre(figure: Figure, grid: OccupancyGrid, shown: int) -> None:
    """Eq. 1 over the grid, and what it makes of the shown cell."""
    x, y = (value / grid.resolution for value in grid.centre(shown))
    lines = (
        r"$x_i = a\,[\mathrm{mod}(i-1,\,\mathrm{columns}) + 1/2]$",
        r"$y_i = a\,[\mathrm{rows} - \mathrm{ceil}(i/\mathrm{columns}) + 1/2]$",
    )
    values = (rf"$x_{{{shown}}} = {x:g}\,a$", rf"$y_{{{shown}}} = {y:g}\,a$")
    wide, high = figure.get_size_inches()
    left, right = LEFT / wide, 1.0 - RIGHT / wide
    for row, (line, value) in enumerate(zip(lines, values, strict=True)):
        at = 1.0 - (0.12 + 0.175 * row) / high
        figure.text(left, at, line, fontsize=TEXT, color=palette.INK, va="center")
        figure.text(
            right, at, value, fontsize=TEXT, color=palette.FIRST_PATH, va="center", ha="right"
        )


def _multiples(count: int) -> list[str]:
    """0, a, 2a, ..."""
    return ["0", "a", *(f"{k}a" for k in range(2, count + 1))]
