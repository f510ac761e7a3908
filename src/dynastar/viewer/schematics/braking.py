"""Fig. 5: dist(v, omega) along the arc itself, and the braking distance that has to fit into it."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from shapely.geometry import Point
from shapely.geometry import Polygon as Shape

from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Robot, arc
from dynastar.viewer import palette
from dynastar.viewer.sheet import COLUMN, SMALL, TEXT, room, sheet

Floats = npt.NDArray[np.float64]

POSE = Pose2D(0.0, 0.0, math.radians(8.0))
RADIUS = 5.0  # m, of the arc: omega = v / RADIUS
OBSTACLE = np.array([(2.96, 1.22), (3.68, 1.4), (3.62, 2.5), (2.72, 2.32)])
SPEEDS = (0.95, 1.25)  # m/s: one can stop in time, one cannot
VIEW = (-0.5, 4.5, -0.95, 3.6)
STEP = 1e-3  # m, along the arc


def distance_to_contact(obstacle: Floats, radius: float) -> float:
    """dist(v, omega) of Eq. 7: metres along the arc until a disc of ``radius`` touches, inf if never."""
    shape = Shape(obstacle)
    for length in np.arange(0.0, 2.0 * math.pi * RADIUS, STEP):
        x, y, _ = on_arc(length)
        if shape.distance(Point(x, y)) <= radius:
            return float(length)
    return math.inf


def braking_distance(v: float, brake: float) -> float:
    """v^2 / (2 v_b), metres."""
    return v * v / (2.0 * brake)


def on_arc(length: float) -> Pose2D:
    """The pose ``length`` metres along the arc (Eq. 4, integrated exactly)."""
    return arc(POSE, Twist(1.0, 1.0 / RADIUS), length)


def draw_braking(robot: Robot, width: float = COLUMN) -> Figure:
    """A disc on an arc towards an obstacle: how far it can go, and where it stops from two speeds."""
    x_low, x_high, y_low, y_high = VIEW
    figure = sheet(width, width * (y_high - y_low) / (x_high - x_low))
    axes = room(figure, 0.0, 0.0, *figure.get_size_inches())
    axes.set(xlim=(x_low, x_high), ylim=(y_low, y_high), aspect="equal")
    axes.set_axis_off()
    radius, brake = robot.footprint.circumscribed, robot.limits.v_brake
    dist = distance_to_contact(OBSTACLE, radius)
    slow, fast = (braking_distance(v, brake) for v in SPEEDS)
    allowed = math.sqrt(2.0 * dist * brake)

    axes.add_patch(
        Polygon(OBSTACLE, facecolor=palette.OBSTACLE, edgecolor=palette.OBSTACLE_EDGE, zorder=3)
    )
    axes.text(3.7, 2.36, "obstacle", fontsize=SMALL, color=palette.INK)
    swept = np.vstack([aside(0.0, dist, radius), aside(0.0, dist, -radius)[::-1]])
    axes.fill(*swept.T, facecolor=palette.EXPLORED, edgecolor="none", zorder=1)
    way: dict[str, Any] = {"color": palette.FAINT_INK, "linewidth": 0.6, "linestyle": (0, (4, 2))}
    axes.plot(*aside(0.0, fast + 0.35, 0.0).T, zorder=4, **way)
    _disc(axes, 0.0, radius, palette.ROBOT, "#f1edf4", "-")
    _disc(axes, slow, radius, palette.MOVER_EDGE, "#dff2ec", "-")
    _disc(axes, dist, radius, palette.INK, "none", (0, (3, 2)))
    _disc(axes, fast, radius, palette.CONTACT, "none", "-")
    axes.plot(
        *on_arc(fast)[:2], "x", color=palette.CONTACT, markersize=5, markeredgewidth=1.4, zorder=9
    )
    dist_words = rf"$dist(v,\,\omega)$ = {dist:.2f} m"
    _measure(axes, dist, 0.5, dist_words, palette.INK)
    _measure(axes, slow, -0.46, f"{slow:.2f} m", palette.MOVER_EDGE)
    _measure(axes, fast, -0.8, f"{fast:.2f} m", palette.CONTACT)
    rule = rf"Eq. 7:  $v \leq \sqrt{{2\,dist(v,\,\omega)\,\dot{{v}}_b}}$ = {allowed:.2f} m/s"
    length = r"$v^2/(2\,\dot{v}_b)$"
    lines = [(rule, palette.INK)]
    for v, at, colour in zip(
        SPEEDS, (slow, fast), (palette.MOVER_EDGE, palette.CONTACT), strict=True
    ):
        verdict = "admissible" if at <= dist else "not admissible"
        lines.append((f"v = {v:g} m/s:  {length} = {at:.2f} m,  {verdict}", colour))
    for row, (words, colour) in enumerate(lines):
        axes.text(-0.42, 3.38 - 0.31 * row, words, fontsize=TEXT, color=colour, va="center")
    return figure


def aside(begin: float, end: float, off: float) -> Floats:
    """Points (n, 2) of the arc from ``begin`` to ``end`` metres along, ``off`` metres to its left."""
    poses = [on_arc(s) for s in np.linspace(begin, end, 80)]
    return np.array([(p.x - off * math.sin(p.theta), p.y + off * math.cos(p.theta)) for p in poses])


def _disc(axes: Axes, length: float, radius: float, edge: str, face: str, line: Any) -> None:
    x, y, theta = on_arc(length)
    disc = Circle((x, y), radius, facecolor=face, edgecolor=edge, linewidth=0.9, zorder=5)
    disc.set_linestyle(line)
    axes.add_patch(disc)
    if length == 0.0:
        nose = np.array([(x, y), (x + radius * math.cos(theta), y + radius * math.sin(theta))])
        axes.plot(*nose.T, color=edge, linewidth=0.9, zorder=6)


def _measure(axes: Axes, end: float, off: float, words: str, colour: str) -> None:
    """A measuring line beside the arc, from its begin to ``end`` metres along, with words on it."""
    axes.plot(*aside(0.0, end, off).T, color=colour, linewidth=0.8, zorder=6)
    for length in (0.0, end):
        tick = np.array([aside(length, length, off + d)[0] for d in (-0.07, 0.07)])
        axes.plot(*tick.T, color=colour, linewidth=0.8, zorder=6)
    middle = on_arc(0.5 * end)
    x, y = aside(0.5 * end, 0.5 * end, off + math.copysign(0.17, off))[0]
    axes.text(
        float(x),
        float(y),
        words,
        rotation=math.degrees(middle.theta),
        rotation_mode="anchor",
        fontsize=SMALL,
        color=colour,
        ha="center",
        va="center",
    )
