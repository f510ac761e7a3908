"""``dynastar plan``: a path on a map."""

import argparse
from typing import Any

from dynastar import io, planning
from dynastar.cli.compiling import prepare
from dynastar.cli.outputs import check_file
from dynastar.cli.show import as_json, as_table
from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.grid import OccupancyGrid
from dynastar.io.movingai import file_to_world, points_to_file


def execute(arguments: argparse.Namespace) -> int:
    """Plans twice, so that ``time_ms`` is warm, and prints the second."""
    choose(arguments.planner, planning.ALGORITHMS, "planner")
    grid = io.load_map(arguments.map)
    in_file = arguments.map.suffix.lower() == ".map"
    start, goal = tuple(arguments.start), tuple(arguments.goal)
    if in_file:
        start, goal = _from_file(grid, "--start", *start), _from_file(grid, "--goal", *goal)
    settings: dict[str, Any] = {
        "planner": arguments.planner,
        "radius": arguments.radius,
        "unknown": arguments.unknown,
    }
    picture = check_file("--out", arguments.out)
    prepare()
    planning.plan(grid, start, goal, **settings)  # loads
    plan = planning.plan(grid, start, goal, **settings)
    summary = {
        "planner": arguments.planner,
        "length": plan.path.length,
        "grid_length": plan.grid_path.length,
        "expanded": plan.expanded,
        "turns": plan.path.turns,
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


def _from_file(grid: OccupancyGrid, option: str, x: float, y: float) -> tuple[float, float]:
    if x != int(x) or y != int(y):
        raise InputError(f"{option} {x:g} {y:g}: a .map file wants two integers, column and row")
    return file_to_world(grid, int(x), int(y))
