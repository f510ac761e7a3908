"""``dynastar replay``: the navigator's answers to the scans and odometry of a recording."""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar import io
from dynastar.cli.arguments import PRESETS, add_json, add_set
from dynastar.cli.outputs import make_folder
from dynastar.cli.parsing import number, path
from dynastar.cli.show import as_json, side_by_side
from dynastar.config import choose
from dynastar.errors import InputError, MissingPackage
from dynastar.extras import require
from dynastar.writing import written_aside

if TYPE_CHECKING:
    from dynastar.geometry import Goal
    from dynastar.ros.replay import Replay

DESCRIPTION = (
    "Gives a recording's scans, odometry, map and goals to the navigator and says what it "
    "commands; with other settings, too, beside the first."
)

EXAMPLES = """\
examples:
  dynastar run examples/office/office.toml --bag out/office-bag
  dynastar replay out/office-bag
  dynastar replay out/office-bag --set dwa.horizon=2 --set dwa.weights.vel=0.3
  dynastar replay robot.mcap --robot turtlebot3_burger --pose tf --topic scan=/front/scan
  dynastar replay robot.mcap --robot turtlebot3_burger --map home.yaml --goal 3.5 2 1.57

Writes commands.csv, summary.json and figure.png into DIR. Recordings by dynastar are ticked when they
were and give the recorded commands; others are ticked at each scan. Nothing is simulated: the robot
moves as it was recorded, whatever is commanded."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "bag", metavar="BAG", type=path, help="a folder of rosbag2, or an .mcap or .db3 file"
    )
    parser.add_argument(
        "--robot", metavar="NAME", help="needed unless the recording is by dynastar"
    )
    parser.add_argument(
        "--map",
        metavar="MAP",
        type=path,
        help="this map instead of the recorded: .yaml (ROS), .npy",
    )
    parser.add_argument(
        "--goal",
        action="append",
        nargs="+",
        default=[],
        type=_number,
        metavar=("X Y", "HEADING"),
        help="this goal (m, rad) instead of the recorded; repeatable, for several in order",
    )
    parser.add_argument("--preset", choices=PRESETS, help="compare with this preset")
    parser.add_argument(
        "--topic",
        action="append",
        default=[],
        metavar="NAME=TOPIC",
        help="the recording's topic for map, scan, odom, goal_pose, amcl_pose, tf; repeatable",
    )
    parser.add_argument(
        "--pose",
        choices=("odom", "amcl", "tf"),
        help="what says where the robot is in the map (default odom, or as recorded)",
    )
    parser.add_argument("--out", type=path, metavar="DIR", help="default out/replay-<bag's name>")
    add_json(parser)
    add_set(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Replays the recording, once more with other settings if there are any, and compares."""
    require("bags", "recordings need")
    from dynastar.bench.settings import parsed
    from dynastar.cli.compiling import prepare
    from dynastar.robot import ROBOTS
    from dynastar.ros.bridge import TAKES
    from dynastar.ros.replay import COMMANDS, Overrides, replay

    robot = None if arguments.robot is None else choose(arguments.robot, ROBOTS, "robot")
    grid = None if arguments.map is None else io.load_map(arguments.map)
    goals = tuple(map(_goal, arguments.goal))
    as_it_is = Overrides(robot, pose_source=arguments.pose, grid=grid, goals=goals)
    runs = {"as recorded" if robot is None else robot.name: as_it_is}
    settings = parsed(arguments.set)
    if arguments.preset is not None or settings:
        words = [arguments.preset, *arguments.set]
        name = " ".join(word for word in words if word is not None)
        runs[f"preset {name}" if name in runs else name] = as_it_is._replace(
            preset=arguments.preset, settings=settings
        )
    remap = topic_table(arguments.topic, [*(name.strip("/") for name in TAKES), COMMANDS])
    bag = Path(arguments.bag)
    folder = make_folder("--out", arguments.out or Path("out", f"replay-{bag.stem or 'bag'}"))
    prepare()
    found = {name: replay(bag, overrides, remap, progress=True) for name, overrides in runs.items()}
    summaries = {name: one.summary() for name, one in found.items()}
    write_folder(folder, found, summaries)
    print(f"results written to {folder}", file=sys.stderr)
    print(as_json(summaries) if arguments.json else side_by_side(summaries))
    return 0


def _number(text: str) -> float:
    """A number of ``--goal``, which takes all words up to the next option."""
    try:
        return number(text)
    except argparse.ArgumentTypeError as error:
        raise argparse.ArgumentTypeError(f"{error}; BAG comes before --goal") from None


def _goal(numbers: list[float]) -> "Goal":
    """The goal that the numbers of ``--goal`` stand for; InputError where they are not 2 or 3."""
    from dynastar.geometry import Goal

    if len(numbers) not in (2, 3):
        words = " ".join(f"{value:g}" for value in numbers)
        raise InputError(f"--goal {words:.80}: expected X Y, or X Y HEADING")
    return Goal(*numbers)


def topic_table(pairs: list[str], names: Sequence[str]) -> dict[str, str]:
    """The table that ``NAME=TOPIC`` pairs stand for; InputError for a name that is not in ``names``."""
    table = {}
    for pair in pairs:
        name, equals, topic = pair.partition("=")
        if not equals or not topic or name not in names:
            raise InputError(
                f"--topic {pair!r:.80}: expected NAME=TOPIC with NAME one of {', '.join(names)}"
            )
        table[name] = topic
    return table


def write_folder(folder: Path, found: "Mapping[str, Replay]", summaries: Mapping[str, Any]) -> None:
    """Writes summary.json, commands.csv and figure.png."""
    import csv

    import numpy as np

    io.write_json(folder / "summary.json", summaries)
    first = next(iter(found.values()))
    series = {name: one.commands for name, one in found.items()}
    if np.isfinite(first.recorded).any():
        series = {"recorded": first.recorded, **series}
    with (
        written_aside(folder / "commands.csv") as aside,
        aside.open("w", newline="", encoding="utf-8") as file,
    ):
        table = csv.writer(file)
        columns = [f"{name} {what}" for name in series for what in ("v [m/s]", "omega [rad/s]")]
        states = [f"{name} state" for name in found]
        table.writerow(["time [s]", *columns, *states])
        for row, time in enumerate(first.times):
            numbers = [f"{value:.6g}" for one in series.values() for value in one[row]]
            words = [one.states[row] for one in found.values()]
            table.writerow([f"{time:.6f}", *numbers, *words])
    try:
        from dynastar.viewer.commands import draw_commands
        from dynastar.viewer.sheet import save
    except MissingPackage as missing:
        print(f"without a picture: {missing}", file=sys.stderr)
        return
    save(draw_commands(first.times - first.times[:1].sum(), series), folder / "figure.png")
