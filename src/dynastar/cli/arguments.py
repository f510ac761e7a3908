"""What may be typed: the commands, their options, their help."""

import argparse
import math
import re

from dynastar import __version__
from dynastar.config import nearest

TYPE_CHECKING = False
if TYPE_CHECKING:  # neither is imported for --help
    from collections.abc import Iterable
    from pathlib import Path
    from typing import NoReturn

PRESETS = ("default", "paper", "printed")  # those of dynastar.navigator
# The names in dynastar.bench.runner.SUITES, which would import too much for --help.
SUITES = (
    "movingai",
    "paper",
    "barn",
    "dynabarn",
    "mrpb",
    "crowd",
    "maps",
    "office",
    "faults",
    "random",
    "people",
    "scenarios",
)

PLAN_EXAMPLES = """\
examples:
  dynastar plan office.yaml --start 2 2 --goal 38 23 --radius 0.25
  dynastar plan office.yaml --start 2 2 --goal 38 23 --planner astar --out plan.png
  dynastar plan AR0011SR.map --start 239 357 --goal 194 312 --json

For ROS maps X Y are metres in the map's frame. For MovingAI .map files they are integers, the
file's column and row; a cell is 1 m, and the path has cell centres at + 0.5."""

RUN_EXAMPLES = """\
examples:
  dynastar run examples/office/office.toml --out out/office
  dynastar run office.toml --seed 7 --preset paper --json > summary.json
  dynastar run office.toml --set dwa.horizon=2 --set reverse=false

Writes figure.png, animation.gif, summary.json, episode.npz and config.json into DIR."""

BENCH_EXAMPLES = """\
examples:
  dynastar bench movingai --data data/movingai
  dynastar bench barn --data data --workers 2 --json-out barn.json
  dynastar bench barn --replay 17               # mission 17 again, with pictures and the episode
  dynastar bench barn --set dwa.horizon=2 --save-failures out/failures --json-out b.json
  dynastar bench maps --controller pure_pursuit
  dynastar bench scenarios --data examples/features
  dynastar bench all --quick --data data --out out/bench
  dynastar bench compare barn.json b.json

A mission has the suite's own number. A run with --json-out that was cut off goes on where it ended when
it is called again; until then its rows are in FILE.rows.jsonl. `all` runs every suite whose data and
extras are there and writes all.json, all.txt and all.png into DIR. `compare` takes two results of the
same missions and says for each suite whether the second is better, worse or not clearly different."""

PAPER_EXAMPLES = """\
examples:
  dynastar paper table1
  dynastar paper table3 --maps 100 --out out/hundred --json-out -
  dynastar paper all --json-out paper.json

  presets   the settings in which the presets printed, paper and default differ
  table1    traditional against improved A*, on the own map, over maps of 40 x 40 cells (random, rooms,
            maze, office; corner to corner), and over a tenth as many of 512 x 512; 2 minutes
  table3    the improved A* alone against the hybrid, in the own world and over worlds of 20 x 20 cells
            with unknown blocks and a mover, by the presets default and paper, and a tenth of them as
            printed; 50 minutes for 1000
  ablation  each term of Eqs. 2 and 9 left out or read otherwise, and each part of the whole, on worlds
            of the suites paper and people; 2 hours for 100 of each
  figures   Figs. 1 to 8; 10 seconds

Times are for two cores. Writes tables (.md), a line for each map or world (.csv) and pictures (.png,
.svg) into DIR, and goes on from the .jsonl there where it was cut off."""

WARMUP_EXAMPLES = """\
examples:
  dynastar warmup
  dynastar warmup --clear

The kernels lie in ~/.cache/dynastar (or $XDG_CACHE_HOME/dynastar), a folder for each version of
their sources; $NUMBA_CACHE_DIR, if it is set, is where they lie instead and is not cleared."""

DEMO_EXAMPLES = """\
examples:
  dynastar demo
  dynastar demo --list
  dynastar demo --copy my-examples"""

INFO_EXAMPLES = """\
examples:
  dynastar info office.yaml
  dynastar info examples/office/office.toml --out office.png
  dynastar info out/office/episode.npz --json"""

SCHEMA_EXAMPLES = """\
examples:
  dynastar schema --out scenario.schema.json"""

ROS_EXAMPLES = """\
examples:
  dynastar ros-sim examples/office/office.toml
  dynastar ros --scenario examples/office/office.toml
  dynastar ros --ros-args -p robot:=jackal -p pose_source:=amcl -r cmd_vel:=/base/cmd_vel
  ros2 topic pub --once /goal_pose geometry_msgs/msg/PoseStamped \\
      '{header: {frame_id: map}, pose: {position: {x: 7.2, y: 10.0}, orientation: {w: 1.0}}}'"""

EXAMPLES = """\
examples:
  dynastar demo
  dynastar info office.yaml --out office.png
  dynastar plan office.yaml --start 2 2 --goal 38 23 --radius 0.25
  dynastar run examples/office/office.toml --out out/office
  dynastar bench paper --missions 20
  dynastar bench all --quick --data data
  dynastar paper table1 --maps 100
  dynastar warmup"""


class OneLineParser(argparse.ArgumentParser):
    """A parser that says what is wrong in one line, and takes -1e3 and -inf as numbers."""

    def __init__(self, **settings: object) -> None:
        settings.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        settings.setdefault("allow_abbrev", False)
        super().__init__(**settings)  # type: ignore[arg-type]
        self._negative_number_matcher = re.compile(r"^-(\d|\.\d|inf|nan)", re.IGNORECASE)

    def error(self, message: str) -> "NoReturn":
        """Exits with status 2 and ``message``."""
        self.exit(2, f"{self.prog}: {' '.join(message.split())} (see {self.prog} --help)\n")

    def parse_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]
        """As the original, but names the option that is nearest to an unknown one."""
        known, others = self.parse_known_args(args, namespace)
        if others:
            command = self._commands().get(getattr(known, "command", ""), self)
            command.error(_unknown(others[0], command._option_string_actions))
        return known

    def _commands(self) -> "dict[str, OneLineParser]":
        return next(
            (
                dict(action.choices)
                for action in self._actions
                if isinstance(action, argparse._SubParsersAction)
            ),
            {},
        )

    def _check_value(self, action: argparse.Action, value: object) -> None:
        if action.choices is not None and value not in action.choices:
            what = (action.metavar or action.dest) if not action.option_strings else "value"
            words = (
                f"unknown {str(what).lower()} '{value!s:.80}'{nearest(str(value), action.choices)}"
            )
            raise argparse.ArgumentError(action if action.option_strings else None, words)


def _unknown(word: str, options: "Iterable[str]") -> str:
    """Describe an argument that no option takes."""
    if word.startswith("-"):
        option = word.partition("=")[0]
        return f"unknown option '{option:.80}'{nearest(option, options)}"
    return f"one argument too many: '{word:.80}'"


def path(text: str) -> "Path":
    """A file or folder."""
    from pathlib import Path

    return Path(text)


def number(text: str) -> float:
    """A finite number."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def distance(text: str) -> float:
    """A finite number of metres, 0 or more."""
    value = number(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} is negative: expected 0 m or more")
    return value


def count(text: str) -> int:
    """A whole number, 1 or more."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is too small: expected 1 or more")
    return value


def seed(text: str) -> int:
    """A whole number, 0 or more."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text!r} is negative: expected 0 or more")
    return value


def replayed(text: str) -> tuple[int, int]:
    """A mission's number N, or N:R with its repeat."""
    number, _, repeat = text.partition(":")
    return seed(number), seed(repeat or "0")


def build_parser() -> argparse.ArgumentParser:
    """The parser of all commands; the result's ``command`` names a module of this room."""
    parser = OneLineParser(
        prog="dynastar",
        description="Navigation for differential-drive robots: an improved A* plans, "
        "a dynamic window drives.",
        epilog=EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"dynastar {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    _add_plan(commands)
    _add_run(commands)
    _add_demo(commands)
    _add_info(commands)
    _add_schema(commands)
    _add_bench(commands)
    _add_paper(commands)
    _add_ros(commands)
    warmup = commands.add_parser(
        "warmup",
        help="compile everything now, so that the first mission does not wait",
        description="Compiles the kernels of planning, sensing and driving into the cache.",
        epilog=WARMUP_EXAMPLES,
    )
    warmup.add_argument(
        "--clear", action="store_true", help="delete the compiled kernels of all versions instead"
    )
    return parser


def _add_plan(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    plan = commands.add_parser(
        "plan",
        help="find a path on a map",
        description="Finds a smoothed path on a map that keeps a disc clear of obstacles.",
        epilog=PLAN_EXAMPLES,
    )
    plan.add_argument("map", metavar="MAP", type=path, help=".yaml (ROS), .map, .npy or .txt")
    plan.add_argument("--start", nargs=2, type=number, required=True, metavar=("X", "Y"))
    plan.add_argument("--goal", nargs=2, type=number, required=True, metavar=("X", "Y"))
    plan.add_argument(
        "--planner",
        default="improved",
        metavar="NAME",
        help="dijkstra, astar, jump, auto, weighted or improved (the default)",
    )
    plan.add_argument(
        "--radius", type=distance, default=0.0, metavar="R", help="of the robot, m (default 0)"
    )
    plan.add_argument(
        "--unknown",
        choices=("free", "blocked"),
        default="blocked",
        help="what unknown cells are taken for (default blocked)",
    )
    plan.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    plan.add_argument("--out", type=path, metavar="PNG", help="draw the plan into this picture")


def _add_run(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    run = commands.add_parser(
        "run",
        help="drive a scenario in simulation",
        description="Drives a scenario in simulation; draws it and measures it. "
        "Exit status 0 only for an arrival without contact.",
        epilog=RUN_EXAMPLES,
    )
    run.add_argument("scenario", metavar="SCENARIO.toml", type=path)
    run.add_argument("--out", type=path, metavar="DIR", help="default out/<scenario's name>")
    run.add_argument("--seed", type=seed, metavar="N", help="instead of the scenario's")
    run.add_argument("--preset", choices=PRESETS, help="instead of the scenario's")
    run.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    run.add_argument("--no-gif", action="store_true", help="leave out the animation")
    _add_set(run)


def _add_demo(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    demo = commands.add_parser(
        "demo",
        help="drive an example that comes with dynastar",
        description="Drives a robot across an office, or through another of the examples that come with "
        "dynastar; draws it and measures it, as `dynastar run` does.",
        epilog=DEMO_EXAMPLES,
    )
    demo.add_argument(
        "name", nargs="?", default="office", metavar="NAME", help="of --list (default office)"
    )
    demo.add_argument("--out", type=path, metavar="DIR", help="default out/<scenario's name>")
    demo.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    demo.add_argument("--no-gif", action="store_true", help="leave out the animation")
    demo.add_argument("--list", action="store_true", help="list the examples instead")
    demo.add_argument(
        "--copy", type=path, metavar="DIR", help="copy all of them into a folder instead, to change"
    )


def _add_info(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    info = commands.add_parser(
        "info",
        help="what a map, a scenario or an episode holds",
        description="Says what a map, a scenario or an episode holds: extent, resolution, how much is "
        "free; robot, start and goals; the result.",
        epilog=INFO_EXAMPLES,
    )
    info.add_argument("file", metavar="FILE", type=path, help="a map, .toml or .npz")
    info.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    info.add_argument("--out", type=path, metavar="PNG", help="draw it into this picture")


def _add_schema(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    schema = commands.add_parser(
        "schema",
        help="the JSON Schema of scenario files, for editors",
        description="Prints the JSON Schema of scenario files. Editors complete and check a TOML file by "
        "it where its first line is `#:schema scenario.schema.json`.",
        epilog=SCHEMA_EXAMPLES,
    )
    schema.add_argument("--out", type=path, metavar="FILE", help="into this file instead")


def _add_bench(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    bench = commands.add_parser(
        "bench",
        help="run suites of missions, compare results",
        description="Runs a suite of missions, or all of them, and counts every failure; runs a mission "
        "again; compares two results.",
        epilog=BENCH_EXAMPLES,
    )
    bench.add_argument(
        "suite",
        metavar="SUITE",
        help=f"{', '.join(SUITES)}; `all` for all of them, `compare` for two results",
    )
    bench.add_argument("files", nargs="*", metavar="FILE", help="two results, for `compare`")
    bench.add_argument(
        "--data",
        type=path,
        metavar="DIR",
        help="the suite's folder or the one above it (default $DYNASTAR_DATA)",
    )
    bench.add_argument(
        "--missions", type=count, metavar="N", help="run N missions, those left out not counted"
    )
    bench.add_argument("--repeat", type=count, default=1, metavar="N", help="each mission N times")
    bench.add_argument(
        "--select", metavar="A:B:C", help="a slice over the suite's own numbers, or one of them"
    )
    bench.add_argument("--seed", type=seed, default=0, metavar="N")
    bench.add_argument("--preset", choices=PRESETS, default="default")
    bench.add_argument(
        "--ideal", action="store_true", help="without range noise and without latency"
    )
    bench.add_argument(
        "--controller",
        default="navigator",
        metavar="NAME",
        help="navigator (the default), pure_pursuit, kompass_dwa, or a class as MODULE:CLASS",
    )
    _add_set(bench)
    bench.add_argument(
        "--quick", action="store_true", help="a few missions of the suite, or of each"
    )
    bench.add_argument("--workers", type=count, metavar="N", help="processes (default: all cores)")
    bench.add_argument(
        "--dask", metavar="ADDRESS", help="run on this Dask cluster instead, as tcp://host:8786"
    )
    bench.add_argument(
        "--json-out", metavar="FILE", help="the result with a row for every mission; - is stdout"
    )
    bench.add_argument(
        "--save-failures",
        type=path,
        metavar="DIR",
        help="write the episode (.npz) and a picture (.png) of each mission that failed into DIR",
    )
    bench.add_argument(
        "--replay",
        type=replayed,
        metavar="N",
        help="run mission N again (its repeat R: N:R) and write what `run` writes",
    )
    bench.add_argument(
        "--out",
        type=path,
        metavar="DIR",
        help="of --replay (default out/SUITE-N) and `all` (out/bench)",
    )
    bench.add_argument("--no-gif", action="store_true", help="leave out the animation of --replay")


def _add_ros(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    ros = commands.add_parser(
        "ros",
        help="the navigator as a ROS 2 node",
        description="Runs the navigator as a ROS 2 node: it takes map, scan, odom and goal_pose and "
        "publishes cmd_vel. What follows --ros-args goes to ROS.",
        epilog=ROS_EXAMPLES,
    )
    ros.add_argument(
        "--scenario",
        type=path,
        metavar="FILE",
        help="take robot and errors from this scenario file",
    )
    sim = commands.add_parser(
        "ros-sim",
        help="the simulator as a ROS 2 node",
        description="Runs a scenario as a ROS 2 node: it publishes map, scan and odom and takes cmd_vel. "
        "What follows --ros-args goes to ROS.",
        epilog=ROS_EXAMPLES,
    )
    sim.add_argument("scenario", metavar="SCENARIO.toml", type=path)


def _add_set(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="a setting of the navigator, as dwa.horizon=2; repeatable",
    )


def _add_paper(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    paper = commands.add_parser(
        "paper",
        help="remake the paper's tables and figures",
        description="Remakes the paper's tables and figures, over as many maps as you like.",
        epilog=PAPER_EXAMPLES,
    )
    paper.add_argument(
        "what",
        nargs="?",
        choices=("presets", "table1", "table3", "ablation", "figures", "all"),
        default="all",
        help="default all",
    )
    paper.add_argument(
        "--maps",
        type=count,
        default=1000,
        metavar="N",
        help="maps of table1, in fours, and worlds of table3 (default 1000)",
    )
    paper.add_argument(
        "--worlds",
        type=count,
        default=100,
        metavar="N",
        help="worlds of each suite in the ablation, no more than --maps (default 100)",
    )
    paper.add_argument("--seed", type=seed, default=0, metavar="N")
    paper.add_argument("--out", type=path, metavar="DIR", help="default out/paper")
    paper.add_argument("--workers", type=count, metavar="N", help="processes (default: all cores)")
    paper.add_argument("--json-out", metavar="FILE", help="all figures; - is stdout")
    _add_set(paper)
    paper.add_argument(
        "--docs", type=path, metavar="FILE", help="a page whose tables are to be these"
    )
