"""The paper that pictures for print are drawn on: its sizes, its letters, and how it is saved."""

from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from dynastar.errors import InputError
from dynastar.paths import local_path
from dynastar.terminal import printable
from dynastar.viewer import palette
from dynastar.writing import written_aside

FORMATS = (".png", ".svg", ".pdf")
COLUMN, PAGE = 3.3, 6.9  # inches: a column of a two-column page, and the page
FINE, SMALL, TEXT = 6.0, 6.5, 7.5  # points, of letters at the size that is printed
PRINT_DPI = 300
# The same names for the same parts each time, so that the same picture is the same file.
SAVED_WITH: Any = {"svg.hashsalt": "dynastar", "pdf.fonttype": 42}


def sheet(width: float, height: float) -> Figure:
    """A white sheet of ``width`` x ``height`` inches."""
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def literal(text: str) -> str:
    """A text from a file for Matplotlib to draw as it is: no formulas, no control characters."""
    return printable(text).replace("$", r"\$")


def room(figure: Figure, left: float, low: float, width: float, height: float) -> Axes:
    """Axes over a part of the sheet, in inches from its lower left corner."""
    wide, high = figure.get_size_inches()
    return figure.add_axes((left / wide, low / high, width / wide, height / high))


def bare(figure: Figure) -> Axes:
    """Axes without lines over the whole sheet, in inches from its lower left corner."""
    wide, high = figure.get_size_inches()
    axes = room(figure, 0.0, 0.0, wide, high)
    axes.set(xlim=(0.0, wide), ylim=(0.0, high))
    axes.set_axis_off()
    return axes


def plain(axes: Axes, size: float = SMALL) -> None:
    """Thin lines and small letters for an axes' edges."""
    axes.tick_params(labelsize=size, colors=palette.INK, width=0.5, length=2.5, pad=2)
    for spine in axes.spines.values():
        spine.set(linewidth=0.5, color=palette.INK)
    axes.xaxis.label.set(fontsize=size, color=palette.INK)
    axes.yaxis.label.set(fontsize=size, color=palette.INK)


def legend_style(size: float = SMALL) -> dict[str, Any]:
    """Keyword arguments of a legend without a frame."""
    return {
        "frameon": False,
        "fontsize": size,
        "labelcolor": palette.INK,
        "columnspacing": 1.4,
        "handletextpad": 0.6,
        "handlelength": 1.8,
        "labelspacing": 0.4,
        "borderpad": 0.0,
        "borderaxespad": 0.0,
    }


def save(figure: Figure, path: str | Path, dpi: int = PRINT_DPI) -> Path:
    """Writes a sheet whole or not at all, and returns where; the same sheet gives the same bytes.

    The suffix of ``path`` (.png, .svg, .pdf) says the format; InputError for another.
    """
    path = local_path(path)
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise InputError(f"{path}: a picture's name has to end in {', '.join(FORMATS)}")
    dates = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with matplotlib.rc_context(SAVED_WITH), written_aside(path) as aside:
        figure.savefig(aside, format=suffix[1:], dpi=dpi, metadata=dates[suffix])
    return path
