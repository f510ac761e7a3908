"""What may be typed: the commands, their options, their help."""

import argparse

from dynastar import __version__
from dynastar.bench.suites import SUITES
from dynastar.cli import examples
from dynastar.cli.parsing import (
    OneLineParser,
    count,
    distance,
    number,
    path,
    port,
    replayed,
    seed,
)

PRESETS = ("default", "paper")  # those of dynastar.navigator


def build_parser() -> argparse.ArgumentParser:
    """The parser of all commands; the result's ``command`` names a module of this room."""
    parser = OneLineParser(
        prog="dynastar",
        description="Navigation for differential-drive robots: an improved A* plans, "
        "a dynamic window drives.",
        epilog=examples.EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"dynastar {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    _add_plan(commands)
    _add_run(commands)
    _add_demo(commands)
    _add_info(commands)
    _add_view(commands)
    _add_schema(commands)
    _add_bench(commands)
    _add_paper(commands)
    _add_ros(commands)
    _add_replay(commands)
    _add_play(commands)
    warmup = commands.add_parser(
        "warmup",
        help="compile everything now, so that the first mission does not wait",
        description="Compiles the kernels of planning, sensing and driving into the cache.",
        epilog=examples.WARMUP_EXAMPLES,
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
        epilog=examples.PLAN_EXAMPLES,
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
        epilog=examples.RUN_EXAMPLES,
    )
    run.add_argument("scenario", metavar="SCENARIO.toml", type=path)
    run.add_argument("--out", type=path, metavar="DIR", help="default out/<scenario's name>")
    run.add_argument("--seed", type=seed, metavar="N", help="instead of the scenario's")
    run.add_argument("--preset", choices=PRESETS, help="instead of the scenario's")
    run.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    run.add_argument("--no-gif", action="store_true", help="leave out the animation")
    run.add_argument(
        "--bag",
        type=path,
        metavar="DIR",
        help="record the messages of a ROS 2 robot to this new folder",
    )
    _add_set(run)


def _add_demo(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    demo = commands.add_parser(
        "demo",
        help="drive an example that comes with dynastar",
        description="Drives a robot across an office, or through another of the examples that come with "
        "dynastar; draws it and measures it, as `dynastar run` does.",
        epilog=examples.DEMO_EXAMPLES,
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
        epilog=examples.INFO_EXAMPLES,
    )
    info.add_argument("file", metavar="FILE", type=path, help="a map, .toml or .npz")
    info.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    info.add_argument("--out", type=path, metavar="PNG", help="draw it into this picture")


def _add_view(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    view = commands.add_parser(
        "view",
        help="replay an episode in the browser",
        description="Writes one HTML file that replays an episode, or two side by side on one clock: map, "
        "paths, candidates with their scores, terms of Eq. 9 and tracked obstacles over time. It needs no "
        "network.",
        epilog=examples.VIEW_EXAMPLES,
    )
    view.add_argument(
        "episodes", nargs="+", metavar="EPISODE", type=path, help="an .npz, or a folder of `run`"
    )
    view.add_argument(
        "--out", type=path, metavar="HTML", help="default report.html beside the first episode"
    )
    view.add_argument("--open", action="store_true", help="open it in the browser")


def _add_schema(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    schema = commands.add_parser(
        "schema",
        help="the JSON Schema of scenario files, for editors",
        description="Prints the JSON Schema of scenario files. Editors complete and check a TOML file by "
        "it where its first line is `#:schema scenario.schema.json`.",
        epilog=examples.SCHEMA_EXAMPLES,
    )
    schema.add_argument("--out", type=path, metavar="FILE", help="into this file instead")


def _add_bench(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    bench = commands.add_parser(
        "bench",
        help="run suites of missions, compare results",
        description="Runs a suite of missions, or all of them, and counts every failure; runs a mission "
        "again; compares two results.",
        epilog=examples.BENCH_EXAMPLES,
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
        help="navigator (the default), pure_pursuit, printed, kompass_dwa, or MODULE:CLASS",
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
        epilog=examples.ROS_EXAMPLES,
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
        epilog=examples.ROS_EXAMPLES,
    )
    sim.add_argument("scenario", metavar="SCENARIO.toml", type=path)


def _add_replay(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    replay = commands.add_parser(
        "replay",
        help="drive by the scans and odometry of a recording",
        description="Gives a recording's scans, odometry, map and goals to the navigator and says what it "
        "commands; with other settings, too, beside the first.",
        epilog=examples.REPLAY_EXAMPLES,
    )
    replay.add_argument(
        "bag", metavar="BAG", type=path, help="a folder of rosbag2, or an .mcap file"
    )
    replay.add_argument(
        "--robot", metavar="NAME", help="needed unless the recording is by dynastar"
    )
    replay.add_argument("--preset", choices=PRESETS, help="compare with this preset")
    replay.add_argument(
        "--topic",
        action="append",
        default=[],
        metavar="NAME=TOPIC",
        help="the recording's topic for map, scan, odom, goal_pose, amcl_pose, tf; repeatable",
    )
    replay.add_argument(
        "--pose",
        choices=("odom", "amcl", "tf"),
        help="what says where the robot is in the map (default odom, or as recorded)",
    )
    replay.add_argument("--out", type=path, metavar="DIR", help="default out/replay-<bag's name>")
    replay.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")
    _add_set(replay)


def _add_play(commands: "argparse._SubParsersAction[OneLineParser]") -> None:
    play = commands.add_parser(
        "play",
        help="drive live in the browser: send the robot, paint obstacles, drop walkers",
        description="Serves a page that drives a scene live: send the robot by clicks, paint obstacles, "
        "put walkers in its way, change weights, and see what it considers.",
        epilog=examples.PLAY_EXAMPLES,
    )
    play.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        type=path,
        default="office",
        help="office, twenty, field, crowd, u_trap, or a scenario file (default office)",
    )
    play.add_argument(
        "--host", default="127.0.0.1", metavar="H", help="address to serve at (default 127.0.0.1)"
    )
    play.add_argument(
        "--port", type=port, default=8642, metavar="N", help="0: any free one (default 8642)"
    )
    play.add_argument("--open", action="store_true", help="open it in the browser")


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
        epilog=examples.PAPER_EXAMPLES,
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
