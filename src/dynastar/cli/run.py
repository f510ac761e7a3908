"""``dynastar run``: a scenario driven in simulation, drawn and measured."""

import argparse
import re
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar import io
from dynastar.cli.arguments import PRESETS, add_json, add_no_gif, add_set
from dynastar.cli.outputs import check_new, make_folder
from dynastar.cli.parsing import path, seed
from dynastar.cli.show import as_json, as_table
from dynastar.errors import InputError, MissingPackage
from dynastar.extras import require

if TYPE_CHECKING:
    from dynastar.episode import Episode
    from dynastar.simulation import Scenario

REPORT = "report.html"
FILES = (REPORT, "figure.png", "animation.gif", "summary.json", "episode.npz", "config.json")

DESCRIPTION = (
    "Drives a scenario in simulation; draws it and measures it. "
    "Exit status 0 only for an arrival without contact."
)

EXAMPLES = """\
examples:
  dynastar run examples/office/office.toml --out out/office
  dynastar run office.toml --seed 7 --preset paper --json > summary.json
  dynastar run office.toml --set dwa.horizon=2 --set reverse=false
  dynastar run office.toml --bag out/office-bag     # opens in Foxglove and RViz, see dynastar replay

Writes report.html, figure.png, animation.gif, summary.json, episode.npz and config.json into DIR."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("scenario", metavar="SCENARIO.toml", type=path)
    parser.add_argument("--out", type=path, metavar="DIR", help="default out/<scenario's name>")
    parser.add_argument("--seed", type=seed, metavar="N", help="instead of the scenario's")
    parser.add_argument("--preset", choices=PRESETS, help="instead of the scenario's")
    add_json(parser)
    add_no_gif(parser)
    parser.add_argument(
        "--bag",
        type=path,
        metavar="DIR",
        help="record the messages of a ROS 2 robot to this new folder; the navigator is given their "
        "rounded numbers, so the drive can differ from one without --bag",
    )
    add_set(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Runs the scenario, writes its folder and prints its summary."""
    from dynastar import metrics
    from dynastar.bench.settings import merged, read_settings
    from dynastar.cli.compiling import prepare

    scenario = io.load_scenario(arguments.scenario)
    if arguments.seed is not None:
        scenario = replace(scenario, seed=arguments.seed)
    if arguments.preset is not None:
        scenario = replace(scenario, preset=arguments.preset)
    settings = read_settings(arguments.set, scenario.preset, scenario.navigator)
    scenario = replace(scenario, navigator=merged(scenario.navigator, settings))
    if arguments.bag is not None:
        require("bags", "recordings need")
        check_new("--bag", arguments.bag)
    folder = make_folder("--out", arguments.out or Path("out", safe_name(scenario)))
    prepare()
    if arguments.bag is None:
        episode = io.run(scenario, progress=True, trace=True)
    else:
        from dynastar.ros.recording import run_recorded

        episode = run_recorded(scenario, arguments.bag, progress=True)
        print(
            f"the recording is {arguments.bag}; the navigator was given its rounded numbers, so the "
            "drive can differ from one without --bag",
            file=sys.stderr,
        )
    summary = metrics.measure(episode)._asdict()
    write_folder(folder, episode, summary, gif=not arguments.no_gif)
    print(f"results written to {folder}", file=sys.stderr)
    print(f"replay: {replay_address(folder)}", file=sys.stderr)
    print(as_json(summary) if arguments.json else as_table(summary))
    arrived = summary["outcome"] == "arrived" and not episode.contact
    return 0 if arrived else 1


def safe_name(scenario: "Scenario") -> str:
    """The scenario's name as the name of a folder."""
    return re.sub(r"[^\w-]+", "_", scenario.name).strip("_") or "scenario"


def replay_address(folder: Path) -> str:
    """The address under which a browser opens the replay in a folder of results."""
    return (folder / REPORT).absolute().as_uri()


def write_folder(folder: Path, episode: "Episode", summary: dict[str, Any], gif: bool) -> None:
    """Writes the summary, the configuration, the episode, its report and its pictures.

    They are written aside first, so that the folder never holds files of two runs.
    """
    for name in FILES:
        if (folder / name).is_dir():
            raise InputError(
                f"{folder / name}: that is a folder; name another folder for the results"
            )
    with tempfile.TemporaryDirectory(prefix=".results.", suffix=".aside", dir=folder) as made:
        aside = Path(made)
        try:
            _write_files(aside, episode, summary, gif)
        except InputError as error:  # the folder that was asked for, not the one aside
            raise InputError(str(error).replace(made, str(folder))) from None
        for name in FILES:
            (folder / name).unlink(missing_ok=True)
        for file in aside.iterdir():
            file.replace(folder / file.name)


def _write_files(folder: Path, episode: "Episode", summary: dict[str, Any], gif: bool) -> None:
    from dynastar.page import write_report

    io.write_json(folder / "summary.json", summary)
    io.write_json(folder / "config.json", {"scenario": episode.scenario, "config": episode.config})
    io.save_episode(episode, folder / "episode.npz")
    write_report([episode], folder / REPORT)
    try:
        from dynastar.viewer.figure import draw_episode
    except MissingPackage as missing:
        print(f"without pictures: {missing}", file=sys.stderr)
        return
    print("drawing the mission", file=sys.stderr)
    draw_episode(episode, folder / "figure.png")
    if gif:
        from dynastar.viewer.animation import animate_episode

        animate_episode(episode, folder / "animation.gif", progress=True)
