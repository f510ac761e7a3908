"""One picture that says what happened: of a map, of a plan, of a mission (as Figs. 2, 3, 6, 7)."""

import math
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure

from dynastar.episode import Episode
from dynastar.grid import OccupancyGrid
from dynastar.metrics import Metrics, measure
from dynastar.viewer import layers, palette, scene
from dynastar.viewer.sheet import literal, save
from dynastar.viewer.view import View, known_view, mission_view

if TYPE_CHECKING:
    from dynastar.planning import Plan
    from dynastar.simulation import Scenario

LEFT, RIGHT, AXIS, LINE = 0.62, 0.95, 0.42, 0.15  # inches beside and below the map, of a line
LEGEND_ROW, LEGEND_COLUMN, LETTERS = 0.19, 2.1, 15.5  # inches, inches, letters an inch
TALLEST = 0.95  # of the width, before a tall map makes the picture narrower
NARROWEST, LOWEST = 5.5, 1.3  # inches: the picture, and the room for the map


def draw_map(grid: OccupancyGrid, axes: Axes, view: View | None = None) -> list[Artist]:
    """Draws ``grid`` into ``axes`` in metres, all or what ``view`` shows; gives legend entries."""
    entries = layers.show_map(axes, grid, view or known_view(grid))
    label_axes(axes)
    return entries


def label_axes(axes: Axes) -> None:
    """Labels and ticks of axes in metres."""
    axes.set_xlabel("x, m", fontsize=8, color=palette.INK)
    axes.set_ylabel("y, m", fontsize=8, color=palette.INK)
    axes.tick_params(labelsize=8, colors=palette.INK, width=0.6, length=3)
    for spine in axes.spines.values():
        spine.set(linewidth=0.6, color=palette.INK)


def episode_view(episode: Episode) -> View:
    """What a picture of a mission shows: the map, or the part of it that the mission takes."""
    plans = [plan.points for plan in episode.plans]
    places = [episode.trajectory.poses[:, :2], episode.goals[:, :2], *plans]
    return mission_view(episode.grid, places)


def draw_mission(episode: Episode, axes: Axes, view: View) -> tuple[list[Artist], LineCollection]:
    """Draws a mission into ``axes`` in metres; gives legend entries and the line coloured by speed."""
    entries = draw_map(episode.grid, axes, view)
    if episode.plans:
        explored, frame = episode.plans[0].explored, scene.explored_frame(episode)
        entries += layers.show_explored(axes, explored, frame, "explored by the first plan")
    entries += layers.show_obstacles(axes, episode.obstacles)
    entries += layers.show_movers(axes, episode, view)
    entries += layers.show_plans(axes, episode.plans, view)
    driven, more = layers.show_driven(axes, episode)
    entries += more
    entries += layers.show_goals(axes, episode)
    entries += layers.show_contact(axes, episode)
    return entries, driven


def draw_plan(
    grid: OccupancyGrid,
    plan: "Plan",
    path: str | Path | None = None,
    width: float = 9.0,
    dpi: int = 160,
) -> Figure:
    """Draws a plan on its map: explored cells (if recorded), grid path, smoothed path, S and G.

    ``width`` is in inches; the suffix of ``path`` (.png, .svg, .pdf), if there is one, says the format.
    Raises InputError for another suffix.
    """
    points = plan.path.points
    view = mission_view(grid, [points, plan.grid_path.points])
    figure, axes = _sheet()
    entries = draw_map(grid, axes, view)
    if plan.explored is not None:
        cells = np.asarray(plan.explored)
        entries += layers.show_explored(axes, cells, grid.frame, f"explored, {plan.expanded} cells")
    entries += layers.show_plan(axes, plan)
    turns = scene.count_words(plan.path.turns, "turning point")
    detail = f"{plan.path.length:.2f} m · {turns} · {plan.expanded} cells expanded"
    words = (f"Path planned by {plan.planner}", f"{detail} · {plan.time_ms:.1f} ms")
    _lay_out(figure, axes, view, width, words, entries)
    return _saved(figure, path, dpi)


def draw_world(
    grid: OccupancyGrid,
    path: str | Path | None,
    name: str,
    scenario: "Scenario | None" = None,
    width: float = 9.0,
    dpi: int = 160,
) -> Figure:
    """Draws a map under a ``name``, and what a ``scenario`` puts into it: nothing is driven.

    ``width`` is in inches; the suffix of ``path`` (.png, .svg, .pdf), if there is one, says the format.
    Raises InputError for another suffix.
    """
    view = known_view(grid)
    figure, axes = _sheet()
    entries = draw_map(grid, axes, view)
    if scenario is not None:
        entries += layers.show_obstacles(axes, scenario.obstacles)
        entries += layers.show_tracks(axes, scenario.movers)
        ends = [scenario.start[:2], *((goal.x, goal.y) for goal in scenario.goals)]
        for number, end in enumerate(ends):
            numbered = f"G{number - 1}" if len(ends) > 2 else "G"
            layers.mark(axes, np.array(end), np.array([0.0, 1.0]), numbered if number else "S")
    size = f"{grid.columns} x {grid.rows} cells of {grid.resolution:g} m"
    _lay_out(figure, axes, view, width, (name, f"{size} · {grid.extent()}"), entries)
    return _saved(figure, path, dpi)


def draw_episode(
    episode: Episode, path: str | Path | None = None, width: float = 9.0, dpi: int = 160
) -> Figure:
    """Draws a mission: map, explored cells, global paths, obstacles, movers, and what was driven.

    ``width`` is in inches; the suffix of ``path`` (.png, .svg, .pdf), if there is one, says the format.
    A mission that takes but a small part of its map is shown close up. Raises InputError for another
    suffix.
    """
    metrics = measure(episode)
    view = episode_view(episode)
    figure, axes = _sheet()
    entries, driven = draw_mission(episode, axes, view)
    words = (f"{scene.name_of(episode)}: {scene.outcome_words(metrics)}", _detail(metrics))
    moved = bool(np.any(episode.trajectory.twists[:, 0]))
    _lay_out(figure, axes, view, width, words, entries, driven if moved else None)
    return _saved(figure, path, dpi)


def _saved(figure: Figure, path: str | Path | None, dpi: int) -> Figure:
    if path is not None:
        save(figure, path, dpi)
    return figure


def _detail(metrics: Metrics) -> str:
    gap = metrics.min_clearance
    parts = [
        f"{metrics.length:.1f} m driven",
        f"smallest clearance {gap:.2f} m" if gap is not None else "",
        scene.count_words(metrics.replans, "replan"),
        scene.count_words(metrics.recoveries, "recovery", "recoveries")
        if metrics.recoveries
        else "",
        metrics.reason if metrics.outcome != "arrived" else "",
    ]
    return " · ".join(part for part in parts if part)


def _sheet() -> tuple[Figure, Axes]:
    figure = Figure(facecolor="white")
    FigureCanvasAgg(figure)
    return figure, figure.add_axes((0.0, 0.0, 1.0, 1.0))


def _lay_out(
    figure: Figure,
    axes: Axes,
    view: View,
    width: float,
    words: tuple[str, str],
    entries: Sequence[Artist],
    speed: LineCollection | None = None,
) -> None:
    """Sizes the paper to the map's shape: words above it, speeds beside it, the legend below."""
    across = width - LEFT - RIGHT
    tall = across * view.height / view.width
    if tall > TALLEST * width:
        across, tall = across * TALLEST * width / tall, TALLEST * width
    wide = max(across + LEFT + RIGHT, min(NARROWEST, width))
    title, detail = map(literal, words)
    lines = textwrap.wrap(detail, max(30, int(LETTERS * (wide - LEFT - 0.2))))
    rows = math.ceil(len(entries) / max(1, int((wide - 0.4) / LEGEND_COLUMN)))
    low = LEGEND_ROW * rows + 0.1 + AXIS
    room = max(tall, LOWEST)
    high = low + room + 0.12 + LINE * len(lines) + 0.32
    left = LEFT + 0.5 * (wide - LEFT - RIGHT - across)

    figure.set_size_inches(wide, high)
    bottom = low + 0.5 * (room - tall)
    axes.set_position((left / wide, bottom / high, across / wide, tall / high))
    above, begin = (low + room + 0.1) / high, (left if left + 5.0 < wide else LEFT) / wide
    figure.text(begin, above, "\n".join(lines), fontsize=8.5, color=palette.FAINT_INK, va="bottom")
    above += (LINE * len(lines) + 0.04) / high
    figure.text(begin, above, title, fontsize=11, fontweight="bold", color=palette.INK, va="bottom")
    if speed is not None:
        box = ((left + across + 0.14) / wide, low / high, 0.11 / wide, min(room, 2.6) / high)
        _speed_bar(figure, speed, box)
    figure.legend(
        handles=list(entries),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.06 / high),
        ncols=math.ceil(len(entries) / rows),
        frameon=False,
        fontsize=8,
        labelcolor=palette.INK,
        columnspacing=1.6,
        handletextpad=0.6,
        labelspacing=0.35,
        borderpad=0.0,
        borderaxespad=0.0,
    )


def _speed_bar(
    figure: Figure, speed: LineCollection, box: tuple[float, float, float, float]
) -> None:
    label_speeds(figure.colorbar(speed, cax=figure.add_axes(box)))


def label_speeds(bar: Colorbar) -> None:
    """Label and ticks of a bar with the colours of the speeds."""
    bar.set_label("speed, m/s", fontsize=8, color=palette.INK)
    bar.ax.tick_params(labelsize=8, colors=palette.INK, width=0.6, length=3)
    bar.outline.set_visible(False)
