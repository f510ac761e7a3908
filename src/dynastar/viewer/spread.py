"""Tables as pictures: spreads over kinds of maps, arms side by side in dots, outcomes in bars."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from dynastar.viewer import palette
from dynastar.viewer.sheet import COLUMN, PAGE, SMALL, legend_style, literal, plain, room, sheet

LINE, LETTER, GAP = 0.24, 0.052, 0.2  # inches: a row, a letter's width, between two columns
LOW = 0.33  # inches under the rows, the legend not counted, for labels of one line
TICK = 0.27  # inches from one number of an axis to the next, at least
FEW = 40  # values, up to which each is a dot
BOX: dict[str, Any] = {"facecolor": palette.EXPLORED, "edgecolor": palette.FIRST_PATH}
MEDIAN: dict[str, Any] = {"color": palette.FIRST_PATH, "linewidth": 1.8}
WORST: dict[str, Any] = {"linestyle": "none", "marker": "x", "color": palette.FAINT_INK}
PRINTED: dict[str, Any] = {"linestyle": "none", "marker": "D", "color": palette.DRIVEN}

PARTS = (palette.FIRST_PATH, palette.CONTACT, palette.KEEPOUT, palette.OBSTACLE)


class Spread(NamedTuple):
    """A measure's values by group, one row each; ``label`` names its axis, in one line or more.

    ``printed`` is what the paper prints, one number for all groups or one by group; a line stands
    at ``reference`` (1 for a ratio); ``format`` is of the medians. The worst value is the largest,
    or the smallest where ``high_is_worst`` is false.
    """

    label: str
    values: Mapping[str, Sequence[float]]
    printed: float | Mapping[str, float] | None = None
    log: bool = False
    reference: float | None = None
    high_is_worst: bool = True
    format: str = ".2f"


class Column(NamedTuple):
    """A measure with one number an arm, None where it has none; ``format`` is of the numbers.

    Its axis has the ``range`` that is given, else that of the numbers. ``intervals`` are (low, high)
    by arm, drawn as lines.
    """

    label: str
    values: Mapping[str, float | None]
    format: str = ".1f"
    log: bool = False
    range: tuple[float, float] | None = None
    intervals: Mapping[str, tuple[float, float] | None] = {}


def draw_spreads(spreads: Sequence[Spread], width: float | None = None) -> Figure:
    """Measures side by side, their groups down the side, as boxes (see ``show_spread``)."""
    groups = list(spreads[0].values)
    width = width or (COLUMN if len(spreads) == 1 else PAGE)
    figure, rooms = _columns(groups, [spread.label for spread in spreads], width, legend=True)
    for axes, spread in zip(rooms, spreads, strict=True):
        show_spread(axes, spread, groups)
    entries: list[Artist] = [
        Line2D([], [], label="median", **MEDIAN),
        Patch(label="quartiles", linewidth=0.6, **BOX),
        Line2D([], [], color=palette.FIRST_PATH, linewidth=0.8, label="5 to 95 %"),
        Line2D([], [], markersize=4, label="worst", **WORST),
    ]
    if any(spread.printed is not None for spread in spreads):
        entries.append(Line2D([], [], markersize=3.6, label="printed in the paper", **PRINTED))
    style = legend_style()
    style |= {"columnspacing": 0.9, "handlelength": 1.4, "handletextpad": 0.4}
    low = (0.5, 0.05 / figure.get_figheight())
    rows = 1 if width > 4.5 else 2
    ncols = -(-len(entries) // rows)
    figure.legend(handles=entries, loc="lower center", bbox_to_anchor=low, ncols=ncols, **style)
    return figure


def show_spread(axes: Axes, spread: Spread, groups: Sequence[str]) -> None:
    """A row a group, the first on top: median, quartiles, 5 to 95 %, worst, and what is printed.

    Up to ``FEW`` values are drawn as dots, too. The median stands in figures at the right.
    """
    for row, group in enumerate(groups):
        values = np.asarray(spread.values[group], dtype=float)
        values = values[np.isfinite(values)]
        if len(values):
            low, begin, median, end, high = np.quantile(values, (0.05, 0.25, 0.5, 0.75, 0.95))
            axes.plot([low, high], [row, row], color=palette.FIRST_PATH, linewidth=0.8, zorder=2)
            box = Rectangle((begin, row - 0.28), end - begin, 0.56, linewidth=0.6, zorder=3, **BOX)
            axes.add_patch(box)
            if len(values) <= FEW:
                dot: dict[str, Any] = {"markersize": 2.2, "color": palette.LATER_PATHS[0]}
                axes.plot(values, np.full(len(values), row), ".", alpha=0.6, zorder=4, **dot)
            axes.plot([median, median], [row - 0.28, row + 0.28], zorder=5, gid="median", **MEDIAN)
            worst = values.max() if spread.high_is_worst else values.min()
            axes.plot(worst, row, markersize=4, zorder=4, **WORST)
            _figure_beside(axes, row, format(median, spread.format))
        else:
            _figure_beside(axes, row, "–")
        printed = spread.printed
        at = printed.get(group) if isinstance(printed, Mapping) else printed
        if at is not None:
            axes.plot(at, row, markersize=3.6, zorder=6, **PRINTED)
    _finish(axes, spread.label, spread.log, len(groups))
    if spread.reference is not None:
        axes.axvline(spread.reference, color=palette.INK, linewidth=0.6, zorder=1)


def draw_columns(columns: Sequence[Column], width: float = PAGE, best: str | None = None) -> Figure:
    """Arms down the side, a measure a column, a dot and its figure for each (an ablation).

    A line through a dot is its interval.
    The arm ``best`` stands out, and a line through its value goes down each column.
    """
    arms = list(columns[0].values)
    figure, rooms = _columns(arms, [column.label for column in columns], width, legend=False)
    for axes, column in zip(rooms, columns, strict=True):
        for row, arm in enumerate(arms):
            value = column.values[arm]
            if value is None or not np.isfinite(value):
                _figure_beside(axes, row, "–")
                continue
            colour = palette.DRIVEN if arm == best else palette.FIRST_PATH
            between = column.intervals.get(arm)
            if between is not None:
                axes.plot(between, (row, row), color=colour, linewidth=1.5, alpha=0.6, zorder=3)
            axes.plot(value, row, "o", color=colour, markersize=2.8, zorder=4, clip_on=False)
            _figure_beside(axes, row, format(value, column.format), colour)
        own = column.values.get(best) if best is not None else None
        if own is not None:
            axes.axvline(own, color=palette.DRIVEN, linewidth=0.6, linestyle=(0, (3, 2)), zorder=1)
        _finish(axes, column.label, column.log, len(arms))
        if column.range is not None:
            axes.set_xlim(column.range)
    return figure


def draw_parts(label: str, parts: Mapping[str, Mapping[str, float]], width: float = PAGE) -> Figure:
    """Arms down the side, a bar for each of its parts one after another (outcomes in per cent).

    ``parts`` has the value of every arm by the name of the part; ``PARTS`` are drawn in that order.
    """
    arms = list(next(iter(parts.values())))
    figure, (axes,) = _columns(arms, [label], width, legend=True)
    begin = np.zeros(len(arms))
    for colour, (name, values) in zip(PARTS, parts.items(), strict=False):
        long = np.array([values[arm] for arm in arms])
        axes.barh(range(len(arms)), long, 0.62, begin, color=colour, label=name, zorder=3)
        begin += long
    for row, arm in enumerate(arms):
        _figure_beside(axes, row, f"{next(iter(parts.values()))[arm]:.0f}")
    _finish(axes, label, False, len(arms))
    axes.set_xlim(0.0, begin.max())
    low = (0.5, 0.05 / figure.get_figheight())
    figure.legend(loc="lower center", bbox_to_anchor=low, ncols=len(parts), **legend_style())
    return figure


def _columns(
    names: Sequence[str], labels: Sequence[str], width: float, legend: bool
) -> tuple[Figure, list[Axes]]:
    """A sheet with an axis for each label side by side over rows of one height, the first with names."""
    count, more_lines = len(labels), max(label.count("\n") for label in labels)
    left = 0.12 + LETTER * max(len(name) for name in names)
    beside = 0.3  # inches for the figures at the right of a column
    across = (width - left - GAP * (count - 1) - 0.05) / count - beside
    low = LOW + 0.13 * more_lines + (0.17 * (1 if width > 4.5 else 2) + 0.05 if legend else 0.05)
    tall = LINE * len(names)
    figure = sheet(width, low + tall + 0.1)
    rooms = []
    for number in range(count):
        axes = room(figure, left + number * (across + beside + GAP), low, across, tall)
        axes.set_ylim(len(names) - 0.5, -0.5)
        plain(axes)
        axes.set_yticks(range(len(names)), [*map(literal, names)] if number == 0 else [])
        axes.tick_params(axis="y", length=0, pad=4)
        for row in range(0, len(names), 2):
            axes.axhspan(row - 0.5, row + 0.5, color="#f4f5f6", linewidth=0, zorder=0)
        for side in ("top", "right", "left"):
            axes.spines[side].set_visible(False)
        rooms.append(axes)
    return figure, rooms


def _finish(axes: Axes, label: str, log: bool, rows: int) -> None:
    axes.set_xlabel(label, labelpad=2)
    inches = axes.get_window_extent().width / axes.figure.dpi
    bins = min(4, max(1, int(inches / TICK)))
    few = MaxNLocator(bins, steps=[1, 2, 2.5, 5, 10], min_n_ticks=min(bins, 2))
    if log:
        axes.set_xscale("log")
        low, high = axes.get_xlim()
        subs = (1.0, 2.0, 5.0) if high < 60.0 * low else (1.0,)
        axes.xaxis.set_major_locator(few if high < 4.0 * low else LogLocator(subs=subs))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    else:
        axes.xaxis.set_major_locator(few)
    axes.grid(axis="x", color=palette.UNKNOWN, linewidth=0.5, zorder=0.5)
    axes.set_axisbelow(True)
    axes.set_ylim(rows - 0.5, -0.5)


def _figure_beside(axes: Axes, row: int, words: str, colour: str = palette.INK) -> None:
    """A number at the right of a row."""
    axes.annotate(
        words, (1.0, row), xycoords=("axes fraction", "data"), xytext=(5.0, 0.0),
        textcoords="offset points", va="center", fontsize=SMALL, color=colour,
        annotation_clip=False,
    )  # fmt: skip
