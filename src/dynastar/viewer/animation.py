"""A mission as a moving picture: the background is drawn once, each frame only what changes."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image
from PIL.ImageColor import getrgb

from dynastar.episode import Episode
from dynastar.errors import InputError
from dynastar.metrics import measure
from dynastar.paths import local_path
from dynastar.terminal import progress_bar
from dynastar.viewer import palette, scene
from dynastar.viewer.canvas import FINE, Canvas, letters_font
from dynastar.viewer.view import mission_view
from dynastar.writing import written_aside

Floats = npt.NDArray[np.float64]

WIDTH, HEIGHT, STRIP = 760, 620, 26  # final pixels, at most, of the world and of each strip
HOLD = 2.0  # s that the last frame stays
GROUNDS = 3  # of the colours named first, that others lie on
NAMED = (
    *(palette.FREE, palette.UNKNOWN, palette.OCCUPIED, palette.OBSTACLE, palette.OBSTACLE_EDGE),
    *(palette.KEEPOUT, palette.SLOW, palette.MOVER, palette.MOVER_EDGE, palette.DRIVEN),
    *(palette.ROBOT, palette.FIRST_PATH, palette.CONTACT, palette.INK, palette.FAINT_INK),
)
SMALLEST_ROBOT = 4.0  # final pixels of radius, below which a ring shows where it is


class Pace(NamedTuple):
    """Which ticks are shown, how many times faster than life, and how long each stays (ms)."""

    ticks: npt.NDArray[np.intp]
    speedup: int
    frame_ms: int


def pace(times: Floats, fps: float, max_seconds: float) -> Pace:
    """The frames that show ``times`` (n,) within ``max_seconds``, the last tick among them."""
    frame_ms = max(20, 10 * round(100.0 / fps))  # GIF counts in 10 ms, viewers slow down under 20
    seconds = times - times[0]
    frames = max(1, int(max_seconds * 1000.0 / frame_ms) - 1)
    speedup = max(1, math.ceil(seconds[-1] / (frames * frame_ms / 1000.0)))
    shown = np.arange(0.0, seconds[-1], speedup * frame_ms / 1000.0)
    ticks = np.searchsorted(seconds, shown + 1e-9, side="right") - 1
    return Pace(np.append(ticks, len(times) - 1), speedup, frame_ms)


def animate_episode(
    episode: Episode,
    path: str | Path,
    fps: float = 12.0,
    max_seconds: float = 20.0,
    progress: bool = False,
) -> None:
    """Writes the mission as a GIF of at most ``max_seconds``, faster than life where it has to be.

    ``fps`` is rounded to what a GIF can hold; the last frame stays 2 s more. With ``progress`` a
    bar on stderr. Raises InputError for a suffix other than .gif and for an
    episode without a tick.
    """
    path = local_path(path)
    if path.suffix.lower() != ".gif":
        raise InputError(f"{path}: an animation's name has to end in .gif")
    if len(episode.trajectory.times) == 0:
        raise InputError(f"{path}: the episode has no tick, so nothing moves in it")
    if not (fps > 0.0 and max_seconds > 0.0):
        raise InputError(f"{path}: expected fps and max_seconds > 0, got {fps}, {max_seconds}")
    shown = pace(episode.trajectory.times, fps, max_seconds)
    frames = _frames(episode, shown)
    first = next(frames)
    colours = _colours()
    rest = progress_bar(
        frames, "animation", total=len(shown.ticks) - 1, disable=not progress, unit="frame"
    )
    durations = [shown.frame_ms] * (len(shown.ticks) - 1) + [round(1000 * HOLD)]
    with written_aside(path) as aside:
        first.quantize(palette=colours, dither=Image.Dither.NONE).save(
            aside,
            format="GIF",
            save_all=True,
            append_images=(f.quantize(palette=colours, dither=Image.Dither.NONE) for f in rest),
            duration=durations,
            loop=0,
            disposal=1,
        )


def _frames(episode: Episode, shown: Pace) -> Iterator[Image.Image]:
    """The frames in order; the driven line grows on one picture that is copied for each."""
    driven = background(episode)
    plan, dashes = -1, []
    stamps = np.array([record.stamp for record in episode.plans])
    times, positions = episode.trajectory.times, episode.trajectory.poses[:, :2]
    previous = 0
    for tick in shown.ticks.tolist():
        driven.line(positions[previous : tick + 1], palette.DRIVEN, 2.5)
        previous = tick
        latest = int(np.searchsorted(stamps, times[tick] + 1e-9, side="right")) - 1
        if latest != plan:
            plan = latest
            points = episode.plans[plan].points
            dashes = driven.dashes(points) if len(points) else []
        frame = driven.duplicate()
        frame.draw_dashes(dashes, palette.FIRST_PATH, 1.5)
        _draw_movers(frame, episode, tick)
        _draw_robot(frame, episode, tick)
        _draw_words(frame, episode, tick, shown.speedup)
        yield frame.reduced()


def background(episode: Episode) -> Canvas:
    """All that stands still: map, unmapped obstacles, start, goals, and what the colours mean."""
    plans = [plan.points for plan in episode.plans]
    places = [episode.trajectory.poses[:, :2], episode.goals[:, :2], *plans]
    view = mission_view(episode.grid, places)
    canvas = Canvas(view, WIDTH, HEIGHT, STRIP)
    canvas.show_map(episode.grid)
    for polygon in episode.obstacles:
        canvas.polygon(polygon, palette.OBSTACLE, palette.OBSTACLE_EDGE)
    canvas.disc(episode.trajectory.poses[0, :2], 3 * FINE / canvas.scale, None, palette.INK)
    for goal in episode.goals[:, :2]:
        canvas.disc(goal, episode.goal_tolerance, None, palette.INK)
    for place, away, letters in scene.marks(episode):
        canvas.badge(place, away, letters)
    canvas.band()
    canvas.band(bottom=True)
    _draw_key(canvas, episode)
    return canvas


def _draw_key(canvas: Canvas, episode: Episode) -> None:
    """The legend, in the lower strip, as far as it fits."""
    entries = [("robot and path driven", palette.DRIVEN), ("planned path", palette.FIRST_PATH)]
    if len(episode.mover_radii):
        entries.append(("moving obstacle", palette.MOVER))
    if episode.obstacles:
        entries.append(("unmapped obstacle", palette.OBSTACLE))
    entries.append(("mapped obstacle", palette.OCCUPIED))
    font = letters_font(10)
    column, middle = 8.0 * FINE, canvas.image.size[1] - 0.5 * FINE * canvas.strip
    for text, colour in entries:
        end = column + 14 * FINE + font.getlength(text)
        if end > canvas.image.size[0]:
            return
        reach = 4 * FINE
        box = (column, middle - reach, column + 2 * reach, middle + reach)
        canvas.pen.rectangle(box, fill=colour)
        place = (column + 12 * FINE, middle)
        canvas.pen.text(place, text, fill=palette.INK, font=font, anchor="lm")
        column = end + 14 * FINE


def _draw_movers(frame: Canvas, episode: Episode, tick: int) -> None:
    for centre, radius in zip(episode.movers[tick], episode.mover_radii, strict=True):
        if np.isfinite(centre).all():
            frame.disc(centre, float(radius), palette.MOVER, palette.MOVER_EDGE)


def _draw_robot(frame: Canvas, episode: Episode, tick: int) -> None:
    pose = episode.trajectory.poses[tick]
    centre, small = pose[:2], SMALLEST_ROBOT * FINE / frame.scale
    if episode.radius < small:
        frame.disc(centre, 2.0 * small, None, palette.DRIVEN)
    frame.polygon(scene.outline(episode, pose), palette.DRIVEN, palette.ROBOT)
    frame.line(scene.nose(episode, pose), palette.FREE, 2)
    if episode.contact and tick == len(episode.trajectory.times) - 1:
        frame.cross(centre, 9, palette.CONTACT, 4)


def _draw_words(frame: Canvas, episode: Episode, tick: int, speedup: int) -> None:
    times = episode.trajectory.times
    end = tick == len(times) - 1
    frame.band()
    doing = scene.outcome_words(measure(episode)) if end else str(episode.states[tick])
    frame.words(f"{scene.name_of(episode)}: {doing}", palette.INK, bold=True)
    clock = f"{times[tick] - times[0]:.1f} s"
    frame.words(f"{clock}   ×{speedup}" if speedup > 1 else clock, palette.FAINT_INK, right=True)


def _colours() -> Image.Image:
    """A picture that holds the colours of all frames: the named ones, and what their edges mix."""
    named = [np.array(getrgb(name)) for name in NAMED]
    table = list(named)
    for under in named[:GROUNDS]:
        for over in named:
            table += [under + (over - under) * part // 4 for part in (1, 2, 3)]
    image = Image.new("P", (1, 1))
    image.putpalette(np.unique(np.array(table, dtype=np.uint8), axis=0).tobytes())
    return image
