"""What ``plot()`` of grids, plans, scans and episodes draws into Matplotlib axes."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import pyplot
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from dynastar.episode import Episode
from dynastar.geometry import Pose2D, compose
from dynastar.grid import OccupancyGrid
from dynastar.scan import LaserScan
from dynastar.viewer import layers, palette
from dynastar.viewer.figure import draw_map, draw_mission, episode_view, label_axes, label_speeds

if TYPE_CHECKING:
    from dynastar.planning import Plan

SIZE = (8.0, 5.5)  # inches, of a new figure
COLUMNS = 3  # of a legend


def plot_grid(grid: OccupancyGrid, ax: Axes | None) -> Axes:
    """Draws a map; see ``OccupancyGrid.plot``."""
    axes = ax or _new_axes()
    return _with_legend(axes, draw_map(grid, axes))


def plot_plan(plan: "Plan", ax: Axes | None) -> Axes:
    """Draws a plan's paths; see ``Plan.plot``."""
    axes = ax or _new_axes()
    axes.margins(0.08)
    axes.set_aspect("equal")
    label_axes(axes)
    return _with_legend(axes, layers.show_plan(axes, plan))


def plot_scan(scan: LaserScan, ax: Axes | None, pose: Pose2D) -> Axes:
    """Draws a scan; see ``LaserScan.plot``."""
    axes = ax or _new_axes()
    axes.set_aspect("equal")
    label_axes(axes)
    return _with_legend(axes, _show_scan(axes, scan, pose))


def plot_episode(episode: Episode, ax: Axes | None) -> Axes:
    """Draws a mission; see ``Episode.plot``."""
    axes = ax or _new_axes()
    entries, driven = draw_mission(episode, axes, episode_view(episode))
    if ax is None:
        label_speeds(pyplot.colorbar(driven, ax=axes, shrink=0.6, aspect=30))
    return _with_legend(axes, entries)


def _show_scan(axes: Axes, scan: LaserScan, pose: Pose2D) -> list[Artist]:
    """The hits of a scan taken by a robot at ``pose``, and the space that its beams found free."""
    x, y, theta = compose(pose, scan.mount)
    found, angles = scan.readings(), theta + scan.angles
    hits, free = np.isfinite(found), np.where(np.isposinf(found), scan.range_max, found)
    seen = np.isfinite(free)
    beams = np.column_stack([np.cos(angles), np.sin(angles)])
    ends = np.where(seen, free, 0.0)[:, None] * beams + (x, y)
    corners = ends if scan.full_circle else np.vstack([(x, y), ends])
    style: layers.Style = {"facecolor": palette.EXPLORED, "edgecolor": "none"}
    axes.fill(*corners.T, zorder=1, **style)
    dots: layers.Style = {
        "color": palette.DRIVEN,
        "marker": ".",
        "markersize": 3,
        "linestyle": "none",
    }
    axes.plot(*ends[hits].T, zorder=3, **dots)
    axes.plot(x, y, "o", color=palette.ROBOT, markersize=5, zorder=4)
    return [
        Line2D([], [], label=f"hits ({hits.sum()} of {len(found)} beams)", **dots),
        Patch(label="seen free", **style),
        Line2D(
            [], [], label="lidar", color=palette.ROBOT, marker="o", linestyle="none", markersize=5
        ),
    ]


def _new_axes() -> Axes:
    """Axes of a new figure, which a notebook or ``pyplot.show`` displays."""
    _, axes = pyplot.subplots(figsize=SIZE, layout="compressed")
    return axes


def _with_legend(axes: Axes, entries: Sequence[Artist]) -> Axes:
    """The axes, with a legend below them of ``entries`` and of what an earlier plot explained."""
    known: dict[str, Artist] = {}
    if legend := axes.get_legend():
        known = {str(entry.get_label()): entry for entry in legend.legend_handles if entry}
    known |= {str(entry.get_label()): entry for entry in entries}
    axes.legend(
        list(known.values()),
        list(known),
        loc="upper center",
        bbox_to_anchor=(0.5, -0.12),
        ncols=COLUMNS,
        fontsize=8,
        frameon=False,
    )
    return axes
