"""Draws docs/media/bag.png from the messages of a recording, as the layout for Foxglove arranges them.

    python docs/bag_picture.py

Needs the packages rosbags, mcap-ros2-support and Matplotlib.
"""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle
from mcap_ros2.reader import read_ros2_messages

from dynastar import io
from dynastar.io.examples import example_scenarios
from dynastar.ros.recording import run_recorded

OUT = Path(__file__).parent / "media" / "bag.png"
SCENE, SECONDS = "office", 40.0
AT = 27.5  # s
AROUND = 4.5  # m that are shown on each side of the robot
OCCUPIED = 65  # least value of an occupied cell
LINE_LIST, CYLINDER = 5, 3  # types of a Marker


def main() -> None:
    """Records a drive, reads it with the library mcap and draws one moment and the reasons."""
    scenario = replace(io.load_scenario(example_scenarios()[SCENE]), time_limit=SECONDS)
    with tempfile.TemporaryDirectory() as folder:
        run_recorded(scenario, Path(folder, "bag"))
        found = list(read_ros2_messages(str(next(Path(folder, "bag").glob("*.mcap")))))
    times = {id(one): 1e-9 * one.log_time_ns for one in found}
    newest, said, speeds = {}, [], []
    for one in found:
        if times[id(one)] <= AT or one.channel.topic not in newest:
            newest[one.channel.topic] = one.ros_msg
        if one.channel.topic == "/diagnostics":
            said.append((times[id(one)], one.ros_msg.status[0].message))
        if one.channel.topic == "/cmd_vel":
            speeds.append((times[id(one)], one.ros_msg.linear.x, one.ros_msg.angular.z))
    figure, axes = plt.subplot_mosaic(
        [["scene", "reasons"], ["scene", "speeds"]],
        figsize=(11, 5.6),
        width_ratios=(1.15, 1),
        layout="constrained",
    )
    draw_scene(axes["scene"], newest)
    draw_reasons(axes["reasons"], said)
    draw_speeds(axes["speeds"], np.array(speeds))
    figure.savefig(OUT, dpi=110)


def draw_grid(axes: Axes, grid: Any, least: int, **looks: Any) -> None:
    """An OccupancyGrid; cells below the value ``least`` stay clear."""
    info = grid.info
    values = np.array(grid.data, np.int8).reshape(info.height, info.width)
    x, y = info.origin.position.x, info.origin.position.y
    extent = x, x + info.resolution * info.width, y, y + info.resolution * info.height
    shown = np.ma.masked_less(values, least)
    axes.imshow(shown, origin="lower", extent=extent, vmin=0, vmax=100, **looks)


def draw_scene(axes: Axes, newest: dict[str, Any]) -> None:
    """The 3D panel's topics round the robot."""
    draw_grid(axes, newest["/cost_to_go"], 0, cmap="YlGnBu_r", alpha=0.6)
    draw_grid(axes, newest["/map"], OCCUPIED, cmap="Greys")
    path = [(one.pose.position.x, one.pose.position.y) for one in newest["/plan"].poses]
    axes.plot(*np.transpose(path), color="#0a3d8f", linewidth=2, label="/plan")
    for marker in newest["/markers"].markers:
        if marker.type == LINE_LIST and marker.points:
            points = np.array([(one.x, one.y) for one in marker.points]).reshape(-1, 2, 2)
            colours = [(one.r, one.g, one.b, one.a) for one in marker.colors[::2]]
            axes.add_collection(LineCollection(list(points), colors=colours, linewidths=1.2))
        elif marker.type == CYLINDER and marker.ns:
            place, colour = marker.pose.position, marker.color
            shade = colour.r, colour.g, colour.b, colour.a
            axes.add_patch(Circle((place.x, place.y), 0.5 * marker.scale.x, color=shade))
    robot = newest["/odom"].pose.pose.position
    axes.set(
        xlim=(robot.x - AROUND, robot.x + AROUND), ylim=(robot.y - AROUND, robot.y + AROUND),
        xlabel="x, m", ylabel="y, m", title=f"/map, /cost_to_go, /plan and /markers at {AT:g} s",
    )  # fmt: skip


def draw_reasons(axes: Axes, said: list[tuple[float, str]]) -> None:
    """State and reason over time, as bars."""
    ends = [*(time for time, _ in said[1:]), SECONDS]
    rows = list(dict.fromkeys(words for _, words in said))
    for (time, words), end in zip(said, ends, strict=True):
        axes.barh(rows.index(words), end - time, left=time, height=0.7, color="#4a1460")
    axes.axvline(AT, color="#e3001b", linewidth=1)
    axes.set_yticks(range(len(rows)), rows, fontsize=8)
    axes.invert_yaxis()
    axes.set(xlim=(0, SECONDS), title="/diagnostics: state: reason")


def draw_speeds(axes: Axes, speeds: np.ndarray) -> None:
    """The commands over time."""
    for column, (colour, name) in enumerate(
        (("#c43c4e", "v, m/s"), ("#0072b2", "omega, rad/s")), 1
    ):
        axes.plot(speeds[:, 0], speeds[:, column], color=colour, linewidth=1, label=name)
    axes.axvline(AT, color="#e3001b", linewidth=1)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, fontsize=8)
    axes.set(xlim=(0, SECONDS), xlabel="time, s")
    axes.set_title("/cmd_vel", loc="left")


if __name__ == "__main__":
    main()
