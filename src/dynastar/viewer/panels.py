"""Maps for print, with what was searched, planned and driven on them: Figs. 2, 3, 6 and 7."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from dynastar.episode import Episode
from dynastar.grid import OccupancyGrid
from dynastar.metrics import measure
from dynastar.path import bends
from dynastar.viewer import layers, palette, scene
from dynastar.viewer.cells import show_cells
from dynastar.viewer.panel import (
    ABOVE,
    LEFT,
    LOW,
    RIGHT,
    ROW,
    legend,
    map_sheet,
    say,
    show_end,
    show_map,
)
from dynastar.viewer.sheet import COLUMN, PAGE, room, sheet
from dynastar.viewer.view import known_view

Floats = npt.NDArray[np.float64]

GAP = 0.3  # inches between two maps
GRID_PATH: layers.Style = {"color": palette.LATER_PATHS[0], "linewidth": 1.3}
SMOOTHED: layers.Style = {"color": palette.DRIVEN, "linewidth": 1.5}


class Searched(NamedTuple):
    """A search to show: a title, what came of it in words, its cells and its lines in metres.

    ``explored`` (m, 2) are (row, column), ``way`` (n, 2) the grid path, ``smoothed`` (k, 2) or None.
    """

    title: str
    words: str
    explored: npt.NDArray[np.integer]
    way: Floats
    smoothed: Floats | None = None


def draw_searches(grid: OccupancyGrid, found: Sequence[Searched], width: float = PAGE) -> Figure:
    """Searches on one map side by side (Figs. 2 and 3)."""
    across = (width - LEFT - RIGHT + GAP) / len(found) - GAP
    tall = across * grid.rows / grid.columns
    low = LOW + ROW + 0.1
    figure = sheet(width, low + tall + ABOVE)
    for number, search in enumerate(found):
        axes = room(figure, LEFT + number * (across + GAP), low, across, tall)
        show_map(axes, grid, labelled=number == 0, unit="cells" if grid.resolution == 1.0 else "m")
        tint: layers.Style = {"facecolor": palette.EXPLORED, "edgecolor": palette.EXPLORED_EDGE}
        show_cells(axes, search.explored, grid.frame, zorder=1, **tint, linewidth=0.4)
        axes.plot(*search.way.T, zorder=4, **GRID_PATH)
        if search.smoothed is not None:
            axes.plot(*search.smoothed.T, zorder=5, **SMOOTHED)
        show_both_ends(axes, search.way, 3.0 * grid.resolution)
        say(figure, axes, search.words, search.title)
    entries: list[Artist] = [
        Patch(facecolor=palette.OCCUPIED, label="occupied"),
        Patch(label="expanded", linewidth=0.4, **tint),
        Line2D([], [], label="grid path", **GRID_PATH),
    ]
    if any(search.smoothed is not None for search in found):
        entries.append(Line2D([], [], label="smoothed at any angle", **SMOOTHED))
    legend(figure, entries, len(entries))
    return figure


def draw_unaware(
    grid: OccupancyGrid,
    way: Floats,
    unknown: Sequence[Floats],
    touches: Floats,
    movers: Sequence[tuple[Floats, float]],
    width: float = COLUMN,
) -> Figure:
    """A path (n, 2) planned without the obstacles that no map shows (Fig. 6).

    ``unknown`` are their polygons, ``touches`` (k, 2) where the path runs into them, ``movers`` the
    lane (m, 2) and the radius of each, all in metres.
    """
    turns = bends(way)
    length = float(np.hypot(*np.diff(way, axis=0).T).sum())
    figure, axes = map_sheet(grid, width, 3)
    layers.show_obstacles(axes, unknown)
    for lane, radius in movers:
        axes.plot(*lane.T, ":", color=palette.MOVER, linewidth=1.4, zorder=3)
        disc = Circle(tuple(lane[0]), radius, facecolor=palette.MOVER, linewidth=0.6, zorder=6)
        disc.set_edgecolor(palette.MOVER_EDGE)
        axes.add_patch(disc)
    path: layers.Style = {"color": palette.FIRST_PATH, "linewidth": 1.3}
    axes.plot(*way.T, zorder=4, **path)
    dot: layers.Style = {"linestyle": "none", "marker": "o", "markersize": 3.2}
    dot |= {"markerfacecolor": "white", "markeredgecolor": palette.FIRST_PATH}
    dot["markeredgewidth"] = 0.8
    axes.plot(*turns.T, zorder=5, **dot)
    cross: layers.Style = {"linestyle": "none", "marker": "x", "color": palette.CONTACT}
    axes.plot(*touches.T, zorder=7, markersize=6.5, markeredgewidth=1.8, **cross)
    show_both_ends(axes, way, 2.0)
    met = f"meets {len(touches)} of {len(unknown)} unknown obstacles"
    say(figure, axes, f"{length:.1f} m, {scene.count_words(len(turns), 'turning point')}, {met}")
    entries: list[Artist] = [
        Line2D([], [], label="improved A*", **path),
        Line2D([], [], label="turning point", **dot),
        Patch(
            facecolor=palette.OBSTACLE, edgecolor=palette.OBSTACLE_EDGE, label="unknown obstacle"
        ),
        _mover_entry("moving obstacle"),
        Line2D([], [], linestyle=":", color=palette.MOVER, linewidth=1.4, label="its lane"),
    ]
    if len(touches):
        met_entry = Line2D([], [], label="runs into it", markersize=5, markeredgewidth=1.5, **cross)
        entries.insert(2, met_entry)
    legend(figure, entries, 2)
    return figure


def draw_driven(episode: Episode, width: float = COLUMN) -> Figure:
    """The run of the hybrid (Fig. 7): first plan, plans after it, movers' tracks, the driven line."""
    figure, axes = map_sheet(episode.grid, width, 4)
    view = known_view(episode.grid)
    layers.show_obstacles(axes, episode.obstacles)
    layers.show_movers(axes, episode, view)
    plans = layers.show_plans(axes, episode.plans, view, numbered=False)
    driven, robot = layers.show_driven(axes, episode)
    driven.set_array(None)
    driven.set(color=palette.DRIVEN, linewidth=1.6)
    goals = episode.goals[:, :2]
    for goal in goals:
        ring = Circle(
            tuple(goal), episode.goal_tolerance, facecolor="none", linewidth=0.7, zorder=8
        )
        ring.set_edgecolor(palette.INK)
        axes.add_patch(ring)
    layers.show_contact(axes, episode)
    for place, away, letters in scene.marks(episode):
        show_end(axes, place, away, letters)
    metrics = measure(episode)
    turns = scene.count_words(metrics.turning_points, "turning point")
    replans = scene.count_words(metrics.replans, "replan")
    say(figure, axes, f"{scene.outcome_words(metrics)}: {metrics.length:.1f} m, {turns}, {replans}")
    track: layers.Style = {"linestyle": ":", "color": palette.MOVER, "linewidth": 1.4}
    entries = [
        Line2D([], [], label="driven", color=palette.DRIVEN, linewidth=1.6),
        *robot[1:],
        *plans,
        Patch(
            facecolor=palette.OBSTACLE, edgecolor=palette.OBSTACLE_EDGE, label="unknown obstacle"
        ),
        _mover_entry("moving obstacle, when nearest"),
        Line2D([], [], label="its track", **track),
    ]
    legend(figure, entries, 2)
    return figure


def show_both_ends(axes: Axes, way: Floats, reach: float) -> None:
    """S and G with a dot at each end of a way, named off what it does within ``reach`` metres."""
    axes.plot(*way[[0, -1]].T, "o", color=palette.INK, markersize=3.0, zorder=9)
    show_end(axes, way[0], -scene.setting_out(way, reach), "S")
    show_end(axes, way[-1], -scene.setting_out(way[::-1], reach), "G")


def _mover_entry(label: str) -> Line2D:
    disc = Line2D([], [], linestyle="none", marker="o", markersize=5, label=label)
    disc.set(markerfacecolor=palette.MOVER, markeredgecolor=palette.MOVER_EDGE)
    return disc
