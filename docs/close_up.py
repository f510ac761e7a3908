"""Draws the README's moving picture: a robot among walkers, close up, with its candidates by score."""

import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon
from PIL import Image

from dynastar import Episode, Goal, load_scenario, run
from dynastar.io.examples import examples_folder
from dynastar.viewer import layers, palette, scene
from dynastar.viewer.view import View

Floats = npt.NDArray[np.float64]

START, GOAL = (1.2, 10.8, -0.615), Goal(14.8, 1.2)  # across the hall of the scene crowd
BEGIN, END = 8.5, 19.5  # s of the mission
SPEEDUP = 2
WIDTH, HEIGHT = 7.2, 4.0  # m that are shown
SIZE, DPI = (7.4, 4.75), 100  # inches, pixels an inch
COLOURS = 96
ARC_TIME = 2.0  # s for which each candidate is drawn
SCORES = matplotlib.colormaps["plasma_r"]  # worst yellow, best violet


def draw(path: Path) -> None:
    """Drives the mission and writes its close-up as an animated WebP."""
    scenario = load_scenario(examples_folder() / "play" / "crowd.toml")
    episode = run(replace(scenario, start=START, goals=(GOAL,)), trace=True)
    times = episode.trajectory.times
    ticks = np.flatnonzero((times >= BEGIN) & (times <= END))
    camera = _smoothed(episode.trajectory.poses[:, :2])
    frames = [_frame(episode, tick, camera[tick]) for tick in ticks.tolist()]
    colours = frames[len(frames) // 2].quantize(COLOURS)
    flat = [frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
    first, *others = (frame.convert("RGB") for frame in flat)
    frame_ms = round(1000.0 * float(times[1] - times[0]) / SPEEDUP)
    first.save(
        path,
        save_all=True,
        append_images=others,
        duration=frame_ms,
        loop=0,
        lossless=True,
        method=4,
    )


def _smoothed(positions: Floats, ticks: int = 31) -> Floats:
    """The positions (n, 2) averaged over ``ticks``, so that the picture does not shake."""
    padded = np.pad(positions, ((ticks // 2, ticks // 2), (0, 0)), "edge")
    kernel = np.full(ticks, 1.0 / ticks)
    return np.column_stack([np.convolve(column, kernel, "valid") for column in padded.T])


def _frame(episode: Episode, tick: int, centre: Floats) -> Image.Image:
    figure = Figure(figsize=SIZE, dpi=DPI)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.01, 0.105, 0.98, 0.835))
    x, y = centre.tolist()
    view = View(x - WIDTH / 2, y - HEIGHT / 2, x + WIDTH / 2, y + HEIGHT / 2)
    layers.show_map(axes, episode.grid, view)
    _draw_people(axes, episode, tick)
    _draw_robot(axes, episode, tick)
    axes.set(xlim=(view.x_low, view.x_high), ylim=(view.y_low, view.y_high), aspect="equal")
    axes.set(xticks=[], yticks=[])
    clock = f"{episode.trajectory.times[tick]:.1f} s, {SPEEDUP} times real time"
    figure.text(
        0.012,
        0.968,
        "A robot among ten walkers who do not notice it",
        weight="bold",
        size=10,
        va="center",
    )
    figure.text(0.988, 0.968, clock, size=9, va="center", ha="right", color=palette.FAINT_INK)
    figure.legend(handles=_legend(), loc="lower center", ncols=7, frameon=False, fontsize=8,
                  handlelength=1.4, handletextpad=0.5, columnspacing=1.1)  # fmt: skip
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return Image.open(buffer).convert("RGB")


def _draw_people(axes: Axes, episode: Episode, tick: int) -> None:
    """Where the walkers are, and where the robot expects those that it tracks in 1 s."""
    for centre, radius in zip(episode.movers[tick], episode.mover_radii, strict=True):
        axes.add_patch(Circle(tuple(centre), radius, color=palette.MOVER, alpha=0.75, zorder=5))
    for x, y, vx, vy, _ in _tracks(episode, tick).tolist():
        axes.plot((x, x + vx), (y, y + vy), color=palette.MOVER_EDGE, linewidth=1.8, zorder=6)


def _draw_robot(axes: Axes, episode: Episode, tick: int) -> None:
    """The robot, its global path, the line that it has driven and the manoeuvres that it compares."""
    pose = episode.trajectory.poses[tick]
    now = episode.trajectory.times[tick] + 1e-9
    plan = [plan for plan in episode.plans if plan.stamp <= now][-1]
    axes.plot(*plan.points.T, color=palette.FIRST_PATH, linestyle=(0, (1, 1.4)), linewidth=1.4)
    axes.plot(*episode.trajectory.poses[: tick + 1, :2].T, color=palette.DRIVEN, linewidth=1.6)
    assert episode.trace is not None
    end = int(episode.trace.candidate_rows[: tick + 1].sum())
    rows = slice(end - int(episode.trace.candidate_rows[tick]), end)
    candidates = episode.trace.candidates[rows]
    good = np.isfinite(candidates[:, 2]) & (episode.trace.refused[rows] == 0)
    ranks = candidates[good, 2].argsort().argsort() / max(1, good.sum() - 1)
    refused = [_arc(pose, *sample) for sample in candidates[~good, :2]]
    scored = [_arc(pose, *sample) for sample in candidates[good, :2]]
    axes.add_collection(LineCollection(refused, colors="#b9bdc4", linewidths=0.7, zorder=3))
    order = ranks.argsort()
    lines = LineCollection(
        [scored[i] for i in order], colors=SCORES(_shade(ranks[order])), linewidths=1.3, zorder=4
    )
    axes.add_collection(lines)
    chosen = episode.trace.chosen[tick]
    if np.isfinite(chosen).all():
        axes.plot(*_arc(pose, *chosen[:2]).T, color=palette.INK, linewidth=2.6, zorder=6)
    outline = scene.outline(episode, pose)
    axes.add_patch(Polygon(outline, facecolor=palette.DRIVEN, edgecolor=palette.ROBOT, zorder=7))
    axes.plot(*scene.nose(episode, pose).T, color="white", linewidth=1.8, zorder=8)


def _arc(pose: Floats, v: float, omega: float) -> Floats:
    """Points (k, 2) of the arc that is driven from ``pose`` at constant speeds."""
    seconds = np.linspace(0.0, ARC_TIME, 13)
    turned = 0.5 * omega * seconds
    chords = v * seconds * np.sinc(turned / np.pi)
    headings = pose[2] + turned
    return np.asarray(
        pose[:2] + chords[:, None] * np.column_stack([np.cos(headings), np.sin(headings)])
    )


def _shade(rank: Any) -> Any:
    """Where in the colours a rank (0 worst, 1 best) lies: their ends are too light and too dark."""
    return 0.1 + 0.8 * rank


def _tracks(episode: Episode, tick: int) -> npt.NDArray[np.float32]:
    assert episode.trace is not None
    end = int(episode.trace.track_rows[: tick + 1].sum())
    return episode.trace.tracks[end - int(episode.trace.track_rows[tick]) : end]


def _legend() -> list[Patch | Line2D]:
    line = {"linewidth": 2.2}
    return [
        Patch(facecolor=palette.DRIVEN, edgecolor=palette.ROBOT, label="robot"),
        *(
            Line2D([], [], color=SCORES(_shade(rank)), label=label, **line)
            for rank, label in ((0.0, "candidate: worst"), (0.5, "medium"), (1.0, "best"))
        ),
        Line2D([], [], color=palette.INK, label="chosen", **line),
        Patch(facecolor=palette.MOVER, label="walker, line: 1 s ahead"),
        Line2D([], [], color=palette.FIRST_PATH, linestyle=":", label="global path"),
    ]
