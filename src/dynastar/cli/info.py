"""``dynastar info``: what a map, a scenario or an episode holds."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar import io
from dynastar.cli.arguments import add_json
from dynastar.cli.outputs import check_picture
from dynastar.cli.parsing import path
from dynastar.cli.show import as_json, as_table

if TYPE_CHECKING:
    from dynastar.episode import Episode
    from dynastar.grid import OccupancyGrid
    from dynastar.simulation import Scenario

DESCRIPTION = (
    "Says what a map, a scenario or an episode holds: extent, resolution, how much is "
    "free; robot, start and goals; the result."
)

EXAMPLES = """\
examples:
  dynastar info office.yaml
  dynastar info examples/office/office.toml --out drawing.png
  dynastar info out/office/episode.npz --json"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("file", metavar="FILE", type=path, help="a map, .toml or .npz")
    add_json(parser)
    parser.add_argument("--out", type=path, metavar="PNG", help="draw it into this picture")


def execute(arguments: argparse.Namespace) -> int:
    """Prints what the file holds, and draws it if asked."""
    file: Path = arguments.file
    picture = check_picture("--out", arguments.out, [file])
    suffix = file.suffix.lower()
    episode = io.load_episode(file) if suffix == ".npz" else None
    scenario = io.load_scenario(file) if suffix == ".toml" else None
    if episode is not None:
        grid, summary = episode.grid, of_episode(episode)
    elif scenario is not None:
        grid, summary = scenario.grid, of_scenario(scenario)
    else:
        grid, summary = io.load_map(file), {}
    summary = {**of_map(grid), **summary}
    if picture is not None:
        from dynastar.viewer.figure import draw_episode, draw_world

        if episode is not None:
            draw_episode(episode, picture)
        else:
            draw_world(grid, picture, scenario.name if scenario else file.name, scenario)
    print(as_json(summary) if arguments.json else as_table(summary))
    return 0


def of_map(grid: "OccupancyGrid") -> dict[str, Any]:
    """A map in numbers."""
    cells = grid.values.size
    summary: dict[str, Any] = {
        "extent": grid.extent(),
        "cells": f"{grid.columns} x {grid.rows}",
        "resolution": grid.resolution,
        "free": _share(int((~grid.occupied & ~grid.unknown).sum()), cells),
        "occupied": _share(int(grid.occupied.sum()), cells),
        "unknown": _share(int(grid.unknown.sum()), cells),
    }
    if grid.keepout is not None:
        summary["keep-out"] = _share(int(grid.keepout.sum()), cells)
    if grid.speed_limit is not None:
        limits = grid.speed_limit[grid.speed_limit < float("inf")]
        lowest = f", down to {limits.min():g} m/s" if len(limits) else ""
        summary["speed limits"] = _share(len(limits), cells) + lowest
    return summary


def of_scenario(scenario: "Scenario") -> dict[str, Any]:
    """A scenario in words and numbers."""
    limits, footprint = scenario.robot.limits, scenario.robot.footprint
    x, y, heading = scenario.start
    facing = "along the path" if heading is None else f"heading {heading:g} rad"
    goals = (
        f"({goal.x:g}, {goal.y:g})"
        + ("" if goal.heading is None else f" heading {goal.heading:g} rad")
        for goal in scenario.goals
    )
    return {
        "name": scenario.name,
        "robot": f"{scenario.robot.name}, up to {limits.v_max:g} m/s",
        "radius": footprint.circumscribed,
        "start": f"({x:g}, {y:g}) m, {facing}",
        "goals": f"{', '.join(goals)} m",
        "obstacles": len(scenario.obstacles),
        "movers": len(scenario.movers),
        "time limit": f"{scenario.time_limit:g} s",
        "preset": scenario.preset,
        "seed": scenario.seed,
    }


def of_episode(episode: "Episode") -> dict[str, Any]:
    """An episode's scenario and numbers."""
    from dynastar import metrics

    ticks = {"robot": episode.robot, "radius": episode.radius, "ticks": len(episode.commands)}
    return {**ticks, **metrics.measure(episode)._asdict()}


def _share(count: int, cells: int) -> str:
    return f"{100.0 * count / cells:.1f} %"
