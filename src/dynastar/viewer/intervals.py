"""Figures with their intervals, side by side: a column for each measure, a row for each group."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from dynastar.viewer import palette
from dynastar.viewer.sheet import PAGE, SMALL, legend_style, literal, plain, room, sheet

LINE, LETTER, GAP, LOW, TOP = 0.24, 0.055, 0.25, 0.5, 0.1  # inches
LEGEND_COLUMNS, LEGEND_LINE = 2, 0.15  # inches
COLOURS = (palette.FIRST_PATH, palette.DRIVEN, palette.MOVER, palette.FAINT_INK)
APART = 0.22  # of a row between two series

Estimate = tuple[float, float | None, float | None]


class Measure(NamedTuple):
    """A measure: ``label`` with its unit, and by series and group an estimate and its interval's ends."""

    label: str
    series: Mapping[str, Mapping[str, Estimate]]
    limits: tuple[float | None, float | None] = (0.0, None)


def draw_intervals(measures: Sequence[Measure], groups: Sequence[str]) -> Figure:
    """The measures side by side, the groups down the side, the first on top."""
    left = 0.2 + LETTER * max(map(len, groups), default=0)
    height = LINE * max(len(groups), 1)
    most = max((len(measure.series) for measure in measures), default=0)
    low = LOW + LEGEND_LINE * max(math.ceil(most / LEGEND_COLUMNS) - 1, 0)
    figure = sheet(PAGE, low + height + TOP)
    width = (PAGE - left - 0.1 - GAP * (len(measures) - 1)) / len(measures)
    for place, measure in enumerate(measures):
        axes = room(figure, left + place * (width + GAP), low, width, height)
        for number, values in enumerate(measure.series.values()):
            offset = APART * (number - 0.5 * (len(measure.series) - 1))
            for row, group in enumerate(groups):
                if group in values:
                    _show(axes, row + offset, values[group], COLOURS[number])
        axes.set(ylim=(max(len(groups), 1) - 0.5, -0.5), xlabel=measure.label)
        axes.set_xlim(*measure.limits)
        axes.set_yticks(
            range(len(groups)), [*map(literal, groups)] if place == 0 else [""] * len(groups)
        )
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.grid(axis="x", color=palette.UNKNOWN, linewidth=0.5)
        axes.set_axisbelow(True)
        plain(axes, SMALL)
        if len(measure.series) > 1:
            entries = [
                Line2D(
                    [],
                    [],
                    color=colour,
                    marker="o",
                    markersize=3,
                    linewidth=0.8,
                    label=literal(name),
                )
                for name, colour in zip(measure.series, COLOURS, strict=False)
            ]
            middle = left + place * (width + GAP) + 0.5 * width
            figure.legend(
                handles=entries,
                loc="lower center",
                bbox_to_anchor=(middle / PAGE, 0.04 / figure.get_figheight()),
                ncols=LEGEND_COLUMNS,
                **legend_style(),
            )
    return figure


def _show(axes: Any, row: float, estimate: Estimate, colour: str) -> None:
    value, low, high = estimate
    if low is not None and high is not None:
        axes.plot([low, high], [row, row], color=colour, linewidth=0.9, solid_capstyle="butt")
    axes.plot(
        [value], [row], color=colour, marker="o", markersize=3.2, linestyle="none", clip_on=False
    )
