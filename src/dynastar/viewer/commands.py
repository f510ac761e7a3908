"""Commands over time: a panel for v, one for omega, a line for each series."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from dynastar.viewer import palette
from dynastar.viewer.sheet import PAGE, legend_style, literal, plain, room, sheet

LEFT, LOW, HEIGHT, GAP, TOP = 0.65, 0.7, 1.6, 0.15, 0.1  # inches
STYLES: tuple[dict[str, Any], ...] = (
    {"color": palette.UNKNOWN, "linewidth": 2.5},
    {"color": palette.DRIVEN, "linewidth": 0.9},
    {"color": palette.MOVER, "linewidth": 0.9},
)


def draw_commands(
    times: npt.NDArray[np.float64], series: Mapping[str, npt.NDArray[np.float64]]
) -> Figure:
    """Commands (n, 2), m/s and rad/s, of up to three series by name, over times (n,) in seconds."""
    figure = sheet(PAGE, LOW + 2 * HEIGHT + GAP + TOP)
    labels = "v [m/s]", "omega [rad/s]"
    for row, label in enumerate(labels):
        low = LOW + (1 - row) * (HEIGHT + GAP)
        axes = room(figure, LEFT, low, PAGE - LEFT - 0.15, HEIGHT)
        for style, (name, commands) in zip(STYLES, series.items(), strict=False):
            axes.plot(times, commands[:, row], label=literal(name), **style)
        axes.set_ylabel(label)
        axes.grid(color=palette.UNKNOWN, linewidth=0.4)
        axes.set_axisbelow(True)
        if len(times) > 1:
            axes.set_xlim(times[0], times[-1])
        plain(axes)
        if row == 0:
            axes.tick_params(labelbottom=False)
    axes.set_xlabel("time [s]")
    handles, names = axes.get_legend_handles_labels()
    height = figure.get_figheight()
    figure.legend(
        handles,
        names,
        loc="lower center",
        bbox_to_anchor=(0.5, 0.04 / height),
        ncols=3,
        **legend_style(),
    )
    return figure
