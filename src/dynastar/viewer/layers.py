"""The layers of a picture, each drawn into an Axes in metres; each returns its legend entries."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection, PolyCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D

from dynastar.episode import Episode, PlanRecord
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.viewer import palette, scene
from dynastar.viewer.sheet import literal
from dynastar.viewer.view import LARGEST_IMAGE, View, averaged_down, map_image, view_of

if TYPE_CHECKING:
    from dynastar.planning import Plan
    from dynastar.simulation.scenario import Mover

Floats = npt.NDArray[np.float64]
Style = dict[str, Any]  # what matplotlib's artists take by name

FOOTPRINTS = 30  # about how many are drawn along the way
NICE_SECONDS = (0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600)
HALO = [withStroke(linewidth=2.2, foreground="white")]


def _place_image(axes: Axes, image: npt.NDArray[np.uint8], frame: GridFrame, box: Floats) -> None:
    """Shows ``image`` over the cells ``box`` (row, column, row end, column end) of ``frame``."""
    row, column, row_end, column_end = box
    shown = axes.imshow(image, origin="lower", extent=(column, column_end, row, row_end), zorder=0)
    to_metres = Affine2D().scale(frame.resolution).rotate(frame.yaw).translate(frame.x, frame.y)
    shown.set_transform(to_metres + axes.transData)


def show_map(axes: Axes, grid: OccupancyGrid, view: View) -> list[Artist]:
    """The map; what lies outside of it looks as unknown as it is."""
    axes.set_facecolor(palette.UNKNOWN)
    window = map_image(grid, view)
    if window.rgb.size:
        _place_image(axes, window.rgb, grid.frame, np.array(window[1:], dtype=float))
    axes.set(xlim=(view.x_low, view.x_high), ylim=(view.y_low, view.y_high), aspect="equal")
    entries: list[Artist] = [Patch(facecolor=palette.OCCUPIED, label="mapped obstacle")]
    if grid.unknown.any():
        entries.append(_patch(palette.UNKNOWN, "unknown"))
    if grid.keepout is not None:
        entries.append(_patch(palette.KEEPOUT, "keep out"))
    if grid.speed_limit is not None:
        entries.append(_patch(palette.SLOW, "speed limit"))
    return entries


def show_explored(
    axes: Axes, cells: npt.NDArray[np.integer], frame: GridFrame, label: str
) -> list[Artist]:
    """A tint over explored ``cells`` (m, 2), (row, column) in ``frame``."""
    if len(cells) == 0:
        return []
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    image = np.zeros((*(high - low), 4), dtype=np.uint8)
    rows, columns = (cells - low).T
    image[:, :, :3] = [round(255 * part) for part in to_rgb(palette.EXPLORED)]
    image[rows, columns, 3] = 255
    image = averaged_down(image, LARGEST_IMAGE)
    _place_image(axes, image, frame, np.array([*low, *high], dtype=float))
    return [_patch(palette.EXPLORED, label)]


def show_obstacles(axes: Axes, obstacles: Sequence[Floats]) -> list[Artist]:
    """The polygons that the map does not have."""
    if len(obstacles) == 0:
        return []
    style: Style = {
        "facecolor": palette.OBSTACLE,
        "edgecolor": palette.OBSTACLE_EDGE,
        "linewidth": 0.8,
    }
    axes.add_collection(PolyCollection(list(obstacles), zorder=2, **style))
    return [Patch(label="unmapped obstacle", **style)]


def show_plans(
    axes: Axes, plans: Sequence[PlanRecord], view: View, numbered: bool = True
) -> list[Artist]:
    """The global paths: the first dotted, later ones dashed where they differ, all numbered."""
    if not plans:
        return []
    first: Style = {"color": palette.FIRST_PATH, "linestyle": (0, (1, 1.2)), "linewidth": 1.6}
    later: Style = {"color": palette.LATER_PATHS[0], "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
    axes.plot(*plans[0].points.T, zorder=4.5, **first)
    entries: list[Artist] = [Line2D([], [], label="global path", **first)]
    changes = scene.changes([plan.points for plan in plans], 0.005 * view.diagonal)
    for index, stretches in enumerate(changes[1:]):
        later["color"] = palette.later_path(index, len(plans) - 1)
        for stretch in stretches:
            axes.plot(*stretch.T, zorder=4, **later)
    if len(plans) > 1:
        later["color"] = palette.LATER_PATHS[0]
        entries.append(Line2D([], [], label="replanned, where it differs", **later))
        labels = scene.plan_labels(plans, 0.02 * view.diagonal) if numbered else []
        for place, way, number in labels:
            _number(axes, place, way, number)
    return entries


def show_plan(axes: Axes, plan: "Plan") -> list[Artist]:
    """A plan's grid path and smoothed path, with S and G at its ends."""
    points = plan.path.points
    grid_style: Style = {"color": palette.LATER_PATHS[1], "linewidth": 1.6}
    path_style: Style = {"color": palette.FIRST_PATH, "linewidth": 2.0}
    axes.plot(*plan.grid_path.points.T, zorder=4, **grid_style)
    axes.plot(*points.T, zorder=5, **path_style)
    reach = 0.03 * view_of(points).diagonal
    mark(axes, points[0], -scene.setting_out(points, reach), "S")
    mark(axes, points[-1], -scene.setting_out(points[::-1], reach), "G")
    return [
        Line2D([], [], label=f"grid path, {plan.grid_path.length:.2f} m", **grid_style),
        Line2D([], [], label=f"smoothed path, {plan.path.length:.2f} m", **path_style),
    ]


def _number(axes: Axes, place: Floats, way: Floats, number: str) -> None:
    """A small number to the left of a line that sets out from ``place`` along ``way``."""
    axes.annotate(
        number,
        tuple(place),
        xytext=(-10.0 * way[1], 10.0 * way[0]),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=7,
        color=palette.FIRST_PATH,
        fontweight="bold",
        path_effects=HALO,
        zorder=9,
        annotation_clip=True,
    )


def show_tracks(axes: Axes, movers: "Sequence[Mover]") -> list[Artist]:
    """Where moving obstacles begin, as discs, and the ways they take."""
    if not movers:
        return []
    style: Style = {"color": palette.MOVER, "linewidth": 1.0, "linestyle": (0, (4, 2))}
    for mover in movers:
        axes.plot(*mover.points.T, zorder=4, **style)
        axes.add_patch(Circle(tuple(mover.points[0]), mover.radius, color=palette.MOVER, zorder=5))
    return [Line2D([], [], label=f"way of a moving obstacle ({len(movers)})", **style)]


def show_movers(axes: Axes, episode: Episode, view: View) -> list[Artist]:
    """Moving obstacles: a disc where each was nearest to the robot, and its track as dots."""
    driven = episode.trajectory
    spacing = view.diagonal / 130.0
    discs, dots = [], []
    for mover, radius in enumerate(episode.mover_radii):
        track = episode.movers[:, mover]
        dots.append(scene.track_dots(track, driven.times, spacing))
        tick = scene.closest_tick(track, driven.poses[:, :2])
        if tick is not None:
            discs.append(Circle(track[tick], radius))
    if not discs:
        return []
    x, y = np.concatenate(dots).T
    axes.plot(x, y, ".", color=palette.MOVER, markersize=2.6, markeredgewidth=0, zorder=3)
    style: Style = {"facecolor": palette.MOVER, "edgecolor": palette.MOVER_EDGE, "linewidth": 0.7}
    axes.add_collection(PatchCollection(discs, zorder=7, **style))
    disc = Line2D([], [], linestyle="none", marker="o", markersize=6)
    disc.set(markerfacecolor=palette.MOVER, markeredgecolor=palette.MOVER_EDGE)
    disc.set_label("moving obstacle where it came nearest")
    track_entry = Line2D([], [], linestyle=(0, (1, 1.6)), color=palette.MOVER, linewidth=1.6)
    track_entry.set_label("way of a moving obstacle")
    return [disc, track_entry]


def show_driven(axes: Axes, episode: Episode) -> tuple[LineCollection, list[Artist]]:
    """The driven trajectory coloured by speed, with the footprint every few seconds."""
    driven = episode.trajectory
    points, speed = driven.poses[:, :2], np.abs(driven.twists[:, 0])
    fastest = float(speed.max()) if len(speed) else 0.0
    line = LineCollection(
        list(np.stack([points[:-1], points[1:]], axis=1)),
        cmap=palette.speed_colours(),
        norm=Normalize(0.0, max(fastest, 0.1)),
        linewidths=2.4,
        capstyle="round",
        zorder=5,
    )
    line.set_array(0.5 * (speed[:-1] + speed[1:]))
    axes.add_collection(line)
    if fastest == 0.0:
        for pose in driven.poses[:1]:
            show_robot(axes, episode, pose)
        return line, []
    seconds = driven.times - driven.times[0]
    step = next((s for s in NICE_SECONDS if seconds[-1] / s <= FOOTPRINTS), NICE_SECONDS[-1])
    ticks = np.searchsorted(seconds, np.arange(step, seconds[-1], step))
    shapes = [scene.outline(episode, driven.poses[tick]) for tick in ticks]
    style: Style = {"facecolor": "none", "edgecolor": palette.FAINT_INK, "linewidth": 0.5}
    axes.add_collection(PolyCollection(shapes, zorder=6, **style))
    for tick in (0, -1):
        show_robot(axes, episode, driven.poses[tick])
    entries: list[Artist] = [
        Line2D([], [], color=palette.speed_colours()(0.7), linewidth=2.4, label="driven"),
        _footprint(scene.outline(episode, np.zeros(3)), f"robot every {step:g} s"),
    ]
    return line, entries


def show_robot(axes: Axes, episode: Episode, pose: Floats) -> None:
    """The footprint at ``pose``, with a line from its centre to its front."""
    shape = scene.outline(episode, pose)
    axes.fill(*shape.T, facecolor="#ffffffd0", edgecolor=palette.ROBOT, linewidth=1.0, zorder=7)
    axes.plot(*scene.nose(episode, pose).T, color=palette.ROBOT, linewidth=1.0, zorder=7)


def show_goals(axes: Axes, episode: Episode) -> list[Artist]:
    """S where the robot started, and G (G1, G2, ... if several) with the tolerance round it."""
    goals = episode.goals[:, :2]
    ring: Style = {"facecolor": "none", "edgecolor": palette.INK, "linewidth": 0.9}
    for goal in goals:
        axes.add_patch(Circle(tuple(goal), episode.goal_tolerance, zorder=8, **ring))
        axes.plot(*goal, "+", color=palette.INK, markersize=4, markeredgewidth=0.9, zorder=8)
    for place, away, letters in scene.marks(episode):
        mark(axes, place, away, letters)
    return [_ring("none", palette.INK, "goal and its tolerance")]


def show_contact(axes: Axes, episode: Episode) -> list[Artist]:
    """A red cross where the robot was when it touched something."""
    if not episode.contact or len(episode.trajectory.poses) == 0:
        return []
    how = "while moving" if episode.contact == "moving" else "while standing still"
    cross = Line2D([], [], linestyle="none", marker="x", color=palette.CONTACT)
    x, y = episode.trajectory.poses[-1, :2]
    axes.plot(x, y, "x", color="white", markersize=12, markeredgewidth=4.5, zorder=10)
    axes.plot(x, y, "x", color=palette.CONTACT, markersize=10, markeredgewidth=2.6, zorder=10)
    cross.set(markersize=7, markeredgewidth=2.2, label=literal(f"contact {how}"))
    return [cross]


def mark(
    axes: Axes,
    place: Floats,
    away: Floats,
    letters: str,
    size: float = 8.0,
    reach: float = 17.0,
) -> None:
    """Letters in a dark disc, tied to a place by a line that leads the way ``away`` from it.

    ``size`` of the letters and ``reach`` of the line are in points.
    """
    axes.annotate(
        letters,
        tuple(place),
        xytext=(reach * away[0], reach * away[1]),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=size,
        fontweight="bold",
        color="white",
        bbox={"boxstyle": "circle,pad=0.22", "facecolor": palette.INK, "edgecolor": "white"},
        arrowprops={"arrowstyle": "-", "color": palette.INK, "linewidth": 0.9, "shrinkB": 1},
        zorder=11,
    )


def _patch(colour: str, label: str) -> Patch:
    return Patch(facecolor=colour, edgecolor=palette.FAINT_INK, linewidth=0.4, label=label)


def _footprint(outline: Floats, label: str) -> Line2D:
    """A legend's entry in the shape of a footprint: ``outline`` (k, 2) headed along x."""
    shape = Line2D([], [], linestyle="none", marker=outline.tolist(), markersize=9, label=label)
    shape.set(markerfacecolor="none", markeredgecolor=palette.FAINT_INK, markeredgewidth=0.9)
    return shape


def _ring(face: str, edge: str, label: str) -> Line2D:
    ring = Line2D([], [], linestyle="none", marker="o", markersize=6.5, label=label)
    ring.set(markerfacecolor=face, markeredgecolor=edge, markeredgewidth=0.9)
    return ring
