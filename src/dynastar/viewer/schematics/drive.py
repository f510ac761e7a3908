"""Fig. 4: the differential drive, its pose, and the arc of Eq. 4 against a straight line."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, FancyArrowPatch, Polygon

from dynastar.geometry import Pose2D, Twist
from dynastar.robot import arc
from dynastar.viewer import palette
from dynastar.viewer.sheet import COLUMN, SMALL, TEXT, room, sheet

Floats = npt.NDArray[np.float64]

POSE, TWIST, DT = Pose2D(0.98, 0.98, math.radians(14.0)), Twist(1.0, 0.42), 2.6
TRACK, WHEEL, TYRE = 0.9, 0.42, 0.14  # m between the wheels, their diameter and width
SIDE = np.array([(0.55, 0.15), (0.42, 0.33), (-0.42, 0.33)])  # m, corners of the body, left half
BODY = np.vstack([SIDE, SIDE[::-1] * (1.0, -1.0)])
TIE = {"arrowstyle": "-", "color": palette.INK, "linewidth": 0.5, "shrinkA": 1.0}
VIEW = (-0.1, 3.98, -0.08, 3.62)


def draw_drive(width: float = COLUMN) -> Figure:
    """A robot at the begin and the end of a step, and where the straight line of Eq. 4 puts it."""
    x_low, x_high, y_low, y_high = VIEW
    figure = sheet(width, width * (y_high - y_low) / (x_high - x_low))
    axes = room(figure, 0.0, 0.0, *figure.get_size_inches())
    axes.set(xlim=(x_low, x_high), ylim=(y_low, y_high), aspect="equal")
    axes.set_axis_off()
    _show_world(axes)
    end = arc(POSE, TWIST, DT)
    way = np.array([arc(POSE, TWIST, t)[:2] for t in np.linspace(0.0, DT, 60)])
    straight = at(POSE, TWIST.v * DT, 0.0)
    radius = TWIST.v / TWIST.omega
    centre = at(POSE, 0.0, radius)

    for pose in (POSE, end):
        thin: dict[str, Any] = {
            "color": palette.FAINT_INK,
            "linewidth": 0.6,
            "linestyle": (0, (4, 2.5)),
        }
        axes.plot(*np.array([pose[:2], centre]).T, zorder=1, **thin)
    show_robot(axes, end, faint=True)
    show_robot(axes, POSE)
    axes.plot(*way.T, color=palette.DRIVEN, linewidth=1.6, zorder=5)
    line = np.array([POSE[:2], straight])
    axes.plot(
        *line.T, color=palette.LATER_PATHS[0], linewidth=1.2, linestyle=(0, (4, 1.5)), zorder=4
    )
    axes.plot(*centre, "o", color=palette.INK, markersize=3.4, zorder=6)
    axes.plot(*straight, "o", color=palette.LATER_PATHS[0], markersize=3.0, zorder=6)
    axes.plot(*end[:2], "o", color=palette.DRIVEN, markersize=3.0, zorder=7)
    _name(axes, centre, "ICR", (0.0, 6.0))
    _name(axes, 0.5 * (np.array(POSE[:2]) + centre), r"$R = v/\omega$", (-4.0, -1.0), ha="right")
    _show_speeds(axes)
    _show_heading(axes)
    mid = way[36]
    _name(axes, mid, "exact arc\n(Eq. 4, integrated)", (-7.0, 7.0), palette.DRIVEN, ha="right")
    _name(
        axes,
        straight,
        "straight line\n(Eq. 4, as printed)",
        (16.0, -14.0),
        palette.LATER_PATHS[0],
        ha="right",
    )
    _name(axes, end[:2], r"$(x,\,y,\,\theta)_{t}$", (36.0, -42.0), tied=True)
    _name(axes, POSE[:2], r"base_link $(x,\,y,\,\theta)_{t-1}$", (-13.0, -43.0), tied=True)
    for row, words in enumerate((r"$v = (v_r + v_l)/2$", r"$\omega = (v_r - v_l)/b$")):
        _name(axes, np.array([2.45, 0.42 - 0.22 * row]), words, (0.0, 0.0), ha="left")
    return figure


def at(pose: Pose2D, ahead: float, aside: float) -> Floats:
    """The point ``ahead`` and ``aside`` (to the left) of a pose, metres."""
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    return np.array([pose.x + cos * ahead - sin * aside, pose.y + sin * ahead + cos * aside])


def show_robot(axes: Axes, pose: Pose2D, faint: bool = False) -> None:
    """Body and wheels at a pose."""
    body = np.array([at(pose, *corner) for corner in BODY])
    edge = palette.FAINT_INK if faint else palette.ROBOT
    face = "none" if faint else "#f1edf4"
    line = (0, (3, 2)) if faint else "-"
    axes.add_patch(
        Polygon(body, facecolor=face, edgecolor=edge, linewidth=0.8, linestyle=line, zorder=2)
    )
    for side in (1.0, -1.0):
        corners = [(0.5, 0.5), (0.5, -0.5), (-0.5, -0.5), (-0.5, 0.5)]
        wheel = [at(pose, WHEEL * i, side * 0.5 * TRACK + TYRE * j) for i, j in corners]
        colour = palette.OBSTACLE if faint else palette.OCCUPIED
        axes.add_patch(Polygon(np.array(wheel), facecolor=colour, edgecolor="none", zorder=3))


def _show_world(axes: Axes) -> None:
    for tip, name, away in (((3.9, 0.0), "x", (-3.0, 6.0)), ((0.0, 3.5), "y", (6.0, -4.0))):
        _arrow(axes, np.zeros(2), np.array(tip), palette.INK, 0.8)
        _name(axes, np.array(tip), f"${name}$", away)


def _show_speeds(axes: Axes) -> None:
    """The wheels' speeds, v, and the sense of omega."""
    for side, name in ((1.0, "$v_l$"), (-1.0, "$v_r$")):
        speed = TWIST.v - side * 0.5 * TWIST.omega * TRACK
        begin = at(POSE, 0.5 * WHEEL, side * 0.5 * TRACK)
        tip = at(POSE, 0.5 * WHEEL + 0.55 * speed, side * 0.5 * TRACK)
        _arrow(axes, begin, tip, palette.MOVER_EDGE, 1.2)
        _name(axes, tip, name, (7.0, 2.0), palette.MOVER_EDGE)
    _arrow(axes, at(POSE, 0.0, 0.0), at(POSE, 0.95, 0.0), palette.ROBOT, 1.6)
    _name(axes, at(POSE, 0.98, 0.0), "$v$", (1.0, 6.0), palette.ROBOT)
    ring = np.array(
        [at(POSE._replace(theta=a), 0.27, 0.0) for a in POSE.theta + np.linspace(1.2, 4.2, 30)]
    )
    axes.plot(*ring.T, color=palette.ROBOT, linewidth=1.1, zorder=6)
    _arrow(axes, ring[-2], ring[-1] + (ring[-1] - ring[-2]), palette.ROBOT, 1.1)
    _name(axes, at(POSE, 0.17, 0.17), r"$\omega$", (0.0, 0.0), palette.ROBOT)
    ends = [at(POSE, -0.58, side * 0.5 * TRACK) for side in (1.0, -1.0)]
    for begin, end in (ends, ends[::-1]):
        _arrow(axes, begin, end, palette.INK, 0.6)
    _name(axes, at(POSE, -0.58, 0.0), "$b$", (-6.0, 1.0))


def _show_heading(axes: Axes) -> None:
    x, y, theta = POSE
    axes.plot([x, x + 1.6], [y, y], color=palette.FAINT_INK, linewidth=0.6, zorder=1)
    axes.add_patch(
        Arc((x, y), 2.7, 2.7, theta2=math.degrees(theta), color=palette.INK, linewidth=0.7)
    )
    _name(axes, at(POSE._replace(theta=0.5 * theta), 1.47, 0.0), r"$\theta$", (0.0, 0.0))
    axes.plot(x, y, "o", color=palette.ROBOT, markersize=3.4, zorder=7)


def _arrow(axes: Axes, begin: Floats, end: Floats, colour: str, width: float) -> None:
    axes.add_patch(
        FancyArrowPatch(
            tuple(begin),
            tuple(end),
            arrowstyle="-|>",
            mutation_scale=6.0,
            color=colour,
            linewidth=width,
            shrinkA=0.0,
            shrinkB=0.0,
            zorder=6,
        )
    )


def _name(
    axes: Axes,
    place: npt.ArrayLike,
    words: str,
    away: tuple[float, float],
    colour: str = palette.INK,
    ha: str = "center",
    tied: bool = False,
) -> None:
    """Words ``away`` points from a place, with a thin line to it if ``tied``."""
    size = TEXT if words.endswith("$") else SMALL
    x, y = np.asarray(place, dtype=float)
    axes.annotate(
        words, (x, y), xytext=away, textcoords="offset points", ha=ha, va="center",
        fontsize=size, color=colour, zorder=8, arrowprops=TIE if tied else None,
    )  # fmt: skip
