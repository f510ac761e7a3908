"""``dynastar plan``: a path on a map."""

import argparse
import math
import re
from typing import TYPE_CHECKING, Any

from dynastar import io
from dynastar.cli.arguments import add_json
from dynastar.cli.outputs import check_picture
from dynastar.cli.parsing import distance, number, path
from dynastar.cli.show import as_json, as_table
from dynastar.config import choose
from dynastar.errors import InputError, PlanningError

if TYPE_CHECKING:
    from dynastar.grid import OccupancyGrid

DESCRIPTION = "Finds a smoothed path on a map that keeps a disc clear of obstacles."

EXAMPLES = """\
examples:
  dynastar plan office.yaml --start 2 2 --goal 38 23 --radius 0.25
  dynastar plan office.yaml --start 2 2 --goal 38 23 --planner astar --out plan.png
  dynastar plan AR0011SR.map --start 239 357 --goal 194 312 --json

For ROS maps X Y are metres in the map's frame. For MovingAI .map files they are integers, the
file's column and row; a cell is 1 m, and the path has cell centres at + 0.5."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("map", metavar="MAP", type=path, help=".yaml (ROS), .map, .npy or .txt")
    parser.add_argument("--start", nargs=2, type=number, required=True, metavar=("X", "Y"))
    parser.add_argument("--goal", nargs=2, type=number, required=True, metavar=("X", "Y"))
    parser.add_argument(
        "--planner",
        default="improved",
        metavar="NAME",
        help="dijkstra, astar, jump, auto, weighted or improved (the default)",
    )
    parser.add_argument(
        "--radius", type=distance, default=0.0, metavar="R", help="of the robot, m (default 0)"
    )
    parser.add_argument(
        "--tolerance",
        type=distance,
        default=0.0,
        metavar="R",
        help="distance from the goal at which the path may end where the goal cannot be reached, "
        "m (default 0)",
    )
    parser.add_argument(
        "--unknown",
        choices=("free", "blocked"),
        default="blocked",
        help="what unknown cells are taken for (default blocked)",
    )
    add_json(parser)
    parser.add_argument("--out", type=path, metavar="PNG", help="draw the plan into this picture")


def execute(arguments: argparse.Namespace) -> int:
    """Plans twice, so that ``time_ms`` is warm, and prints the second."""
    from dynastar import planning
    from dynastar.cli.compiling import prepare
    from dynastar.io.movingai import points_to_file

    choose(arguments.planner, planning.ALGORITHMS, "planner")
    grid = io.load_map(arguments.map)
    in_file = arguments.map.suffix.lower() == ".map"
    start, goal = tuple(arguments.start), tuple(arguments.goal)
    if in_file:
        start, goal = _from_file(grid, "--start", *start), _from_file(grid, "--goal", *goal)
    settings: dict[str, Any] = {
        "planner": arguments.planner,
        "radius": arguments.radius,
        "tolerance": arguments.tolerance,
        "unknown": arguments.unknown,
    }
    picture = check_picture("--out", arguments.out, [arguments.map])
    prepare()
    try:
        planning.plan(grid, start, goal, **settings)  # loads
    except PlanningError as error:
        raise type(error)(_in_file(grid, str(error)) if in_file else str(error)) from None
    plan = planning.plan(grid, start, goal, **settings)
    summary = {
        "planner": arguments.planner,
        "length": plan.path.length,
        "grid_length": plan.grid_path.length,
        "expanded": plan.expanded,
        "turns": plan.path.turns,
        **({"clear_from": plan.clear_from} if plan.clear_from > 0.0 else {}),
        "time_ms": plan.time_ms,
    }
    points = points_to_file(grid, plan.path.points) if in_file else plan.path.points
    if picture:
        from dynastar.viewer.figure import draw_plan

        draw_plan(grid, planning.plan(grid, start, goal, explored=True, **settings), picture)
    if arguments.json:
        print(as_json({**summary, "path": points}))
    else:
        print(as_table({**summary, "path": f"{len(points)} points"}))
        print("\n".join(f"{x:12.3f} {y:12.3f}" for x, y in points))
    return 0


def _in_file(grid: "OccupancyGrid", message: str) -> str:
    """A message whose places are columns and rows of a .map file."""
    from dynastar.io.movingai import points_to_file

    def cell(found: re.Match[str]) -> str:
        column, row = points_to_file(grid, [[float(found[1]), float(found[2])]])[0]
        return f"(column {math.floor(column)}, row {math.floor(row)})"

    return re.sub(r"\((-?[\d.e+-]+), (-?[\d.e+-]+)\)", cell, message)


def _from_file(grid: "OccupancyGrid", option: str, x: float, y: float) -> tuple[float, float]:
    from dynastar.io.movingai import file_to_world

    if x != int(x) or y != int(y):
        raise InputError(f"{option} {x:g} {y:g}: a .map file wants two integers, column and row")
    return file_to_world(grid, int(x), int(y))
