"""Pictures of a check: the map with its passages, the stop from v_max, and the recorded gaps."""

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon, Rectangle, Wedge

from dynastar.check.checking import Check
from dynastar.check.doors import Ways, ways_of
from dynastar.check.passages import Passage
from dynastar.check.recording import Recording
from dynastar.check.stopping import front_of, room_ahead, sight_of, stop_from
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.config import margin_of
from dynastar.robot import Robot
from dynastar.viewer import palette
from dynastar.viewer.figure import draw_map
from dynastar.viewer.sheet import PAGE, SMALL, legend_style, plain, room, sheet
from dynastar.viewer.view import known_view

LEFT, LOW, RIGHT, TOP = 0.55, 0.75, 0.12, 0.1  # inches round the axes
TALLEST = 8.0  # inches
LABELLED = 30  # passages with their widths beside them
SPEEDS = 60  # of the curve
COLOURS = {"too narrow": palette.CONTACT, "tight": "#e69f00", "wide enough": palette.MOVER}


def draw_passages(check: Check) -> Figure:
    """The map, its passages as discs of their width, and the robot for comparison."""
    assert check.grid is not None
    view, ways = known_view(check.grid), ways_of(check.robot, check.config)
    width = PAGE
    across = width - LEFT - RIGHT
    tall = across * view.height / view.width
    if tall > TALLEST:
        across, tall = across * TALLEST / tall, TALLEST
    figure = sheet(width, LOW + tall + TOP)
    axes = room(figure, LEFT + 0.5 * (width - LEFT - RIGHT - across), LOW, across, tall)
    entries = draw_map(check.grid, axes, view)
    for number, one in enumerate(check.passages):
        colour = COLOURS[_kind(one, ways)]
        disc = Circle((one.x, one.y), 0.5 * one.width, facecolor="none", edgecolor=colour)
        axes.add_patch(disc)
        axes.plot(one.x, one.y, ".", color=colour, markersize=4)
        if number < LABELLED:
            box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}
            axes.annotate(
                f"{one.width:.2f}", (one.x, one.y), xytext=(4, 4), textcoords="offset points",
                fontsize=SMALL, color=colour, bbox=box,
            )  # fmt: skip
    limits = {
        "too narrow": f"narrower than {ways.drive:.2f} m",
        "tight": f"up to {ways.surely:.2f} m: may be too narrow",
        "wide enough": "wide enough",
    }
    entries += [
        Line2D([], [], color=COLOURS[kind], marker="o", fillstyle="none", linestyle="", label=words)
        for kind, words in limits.items()
    ]
    figure.legend(handles=entries, loc="lower center", ncols=3, **legend_style())
    return figure


def _kind(one: Passage, ways: Ways) -> str:
    if one.width < ways.drive - 1e-6:
        return "too narrow"
    return "tight" if one.width < ways.surely - 1e-6 else "wide enough"


def draw_stop(robot: Robot, config: NavigatorConfig) -> Figure:
    """The stop from v_max from above, in what the lidar shows free; and the stop over the speed."""
    stop, sight = stop_from(robot.limits.v_max, robot.limits, config), sight_of(robot, config)
    aside = 2.5 * robot.footprint.circumscribed
    far = 1.05 * max(sight.ahead, stop.distance + 2.0 * front_of(robot.footprint))
    across = PAGE - LEFT - RIGHT
    tall = min(max(across * 2.0 * aside / (far + aside), 0.9), 2.5)
    figure = sheet(PAGE, tall + 3.0)
    axes = room(figure, LEFT, 2.75, across, tall)
    _draw_from_above(axes, robot, config)
    axes.set(xlim=(-aside, far), ylim=(-aside, aside), aspect="equal", xlabel="x, m", ylabel="y, m")
    plain(axes)
    curve = room(figure, LEFT, 0.75, across, 1.55)
    speeds = np.linspace(0.0, robot.limits.v_max, SPEEDS)
    ways = [stop_from(float(v), robot.limits, config) for v in speeds]
    curve.plot(speeds, [way.distance for way in ways], color=palette.DRIVEN, label="stop, m")
    curve.plot(
        speeds, [way.reaction for way in ways], color=palette.DRIVEN, linestyle=":",
        label="until it brakes, m",
    )  # fmt: skip
    curve.axhline(
        room_ahead(robot, config), color=palette.FIRST_PATH, linewidth=0.8, label="seen ahead, m"
    )
    curve.set(xlim=(0.0, robot.limits.v_max), ylim=(0.0, None), xlabel="speed, m/s", ylabel="m")
    plain(curve)
    handles = [*_stop_entries(), *curve.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="lower center", ncols=4, **legend_style())
    return figure


def _draw_from_above(axes: Axes, robot: Robot, config: NavigatorConfig) -> None:
    """Footprints at the begin and the end of the stop, the swept area, and the space that is seen."""
    lidar, shape = robot.lidar, robot.footprint
    stop, sight = stop_from(robot.limits.v_max, robot.limits, config), sight_of(robot, config)
    margin = margin_of(robot, config)
    half, middle = math.degrees(0.5 * lidar.fov), math.degrees(lidar.theta)
    reach = max(0.0, sight.ahead - lidar.x)
    free = Wedge((lidar.x, lidar.y), reach, middle - half, middle + half)
    free.set(facecolor=palette.EXPLORED, edgecolor="none")
    axes.add_patch(free)
    wide, front = shape.half_width + margin, front_of(shape) + margin
    brakes_at = front + stop.reaction
    for begin, length, colour in (
        (front, stop.reaction, palette.SLOW),
        (brakes_at, stop.braking, palette.KEEPOUT),
    ):
        swept = Rectangle((begin, -wide), length, 2.0 * wide)
        swept.set(facecolor=colour, edgecolor="none")
        axes.add_patch(swept)
    for at, line in ((0.0, "-"), (stop.distance, "--")):
        style: dict[str, Any] = {"facecolor": "none", "edgecolor": palette.ROBOT, "linestyle": line}
        if shape.is_disc:
            axes.add_patch(Circle((at, 0.0), shape.circumscribed, **style))
        else:
            axes.add_patch(Polygon(shape.vertices + (at, 0.0), **style))
    axes.plot(lidar.x, lidar.y, ".", color=palette.FIRST_PATH, markersize=4)
    axes.axvline(sight.ahead, color=palette.FIRST_PATH, linewidth=0.8)


def _stop_entries() -> list[Artist]:
    """Legend entries of the stop from above."""
    colours = {
        "seen free": palette.EXPLORED,
        "driven until it brakes": palette.SLOW,
        "driven while it brakes": palette.KEEPOUT,
    }
    return [
        *(Patch(facecolor=colour, label=words) for words, colour in colours.items()),
        Line2D([], [], color=palette.ROBOT, label="robot"),
        Line2D([], [], color=palette.ROBOT, linestyle="--", label="at rest"),
    ]


def draw_gaps(recording: Recording, config: NavigatorConfig) -> Figure:
    """Seconds between scans and between odometry messages over time, with period and scan_age."""
    figure = sheet(PAGE, 2.4)
    axes = room(figure, LEFT, LOW, PAGE - LEFT - RIGHT, 2.4 - LOW - TOP)
    began = recording.scans.stamps.min()
    for stream, colour, label in (
        (recording.odometry, palette.EXPLORED_EDGE, "odometry"),
        (recording.scans, palette.DRIVEN, "scans"),
    ):
        axes.plot(
            stream.stamps[1:] - began, stream.gaps, ".", color=colour, markersize=3, label=label
        )
    axes.axhline(config.period, color=palette.FAINT_INK, linewidth=0.6, label="period")
    axes.axhline(config.scan_age, color=palette.CONTACT, linewidth=0.6, label="scan_age")
    axes.set(xlabel="time, s", ylabel="gap, s", ylim=(0.0, None))
    plain(axes)
    figure.legend(loc="lower center", ncols=4, **legend_style())
    return figure
