"""The paper's figures remade, from the code as it is and the project's own maps."""

from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from shapely.geometry import LineString, Point, Polygon

from dynastar.bench import paper
from dynastar.bench.own_maps import drawn, own_forty
from dynastar.bench.table1 import SEARCHES
from dynastar.episode import Episode
from dynastar.grid import OccupancyGrid
from dynastar.planning import SearchGrid, plan, smooth, straighten
from dynastar.robot import ROBOTS
from dynastar.simulation import run
from dynastar.terminal import progress_bar
from dynastar.viewer import schematics
from dynastar.viewer.commands import draw_commands
from dynastar.viewer.panels import Searched, draw_driven, draw_searches, draw_unaware
from dynastar.viewer.sheet import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]

SUFFIXES = (".png", ".svg")
SMALL = """
........
.###....
......#.
......#.
.#......
"""
SHOWN = 21  # the cell of Fig. 1 whose centre is written out


def draw_all(folder: Path, progress: bool = False) -> list[Path]:
    """Draws every figure into ``folder``, as .png and as .svg; which files those are.

    Fig. 7 drives one mission. With ``progress`` a bar on stderr.
    """
    written = []
    for name, draw in progress_bar(FIGURES.items(), "figures", disable=not progress):
        figure = draw()
        written += [save(figure, folder / f"{name}{suffix}") for suffix in SUFFIXES]
    return written


def numbering() -> "Figure":
    """Fig. 1: a small grid's cells by Eq. 1."""
    return schematics.draw_numbering(OccupancyGrid.from_occupied(drawn(SMALL)), SHOWN)


def searches() -> "Figure":
    """Figs. 2 and 3: the cells that the traditional and the improved A* expand, and their paths."""
    own = own_forty()
    grid = SearchGrid(own.occupied)
    found = []
    for name in ("traditional", "improved"):
        result = grid.search(own.start, own.goal, *SEARCHES[name], explored=True)
        assert result.explored is not None
        way = np.asarray(result.cells + 0.5, np.float64)
        words = f"{result.expanded} cells expanded, length {result.cost:.1f}"
        line: Floats | None = None
        if name == "improved":
            straight = straighten(own.occupied, way, 0.0, smooth(own.occupied, way, 0.0))
            words += f", smoothed {np.hypot(*np.diff(straight, axis=0).T).sum():.1f}"
            line = np.asarray(straight[:, ::-1], np.float64)
        found.append(
            Searched(f"{name.capitalize()} A*", words, result.explored, way[:, ::-1], line)
        )
    return draw_searches(OccupancyGrid.from_occupied(own.occupied), found)


def unaware() -> "Figure":
    """Fig. 6: the improved A* on the map alone, and where that runs into what the map lacks."""
    world = paper.own_world()
    way = plan(world.grid, paper.START, paper.GOAL, "improved").grid_path.points
    movers = [(mover.points, mover.radius) for mover in world.movers]
    return draw_unaware(world.grid, way, world.obstacles, touches(way, world.obstacles), movers)


def touches(way: Floats, obstacles: tuple[Floats, ...]) -> Floats:
    """Where (k, 2) a line (n, 2) first enters each of the polygons that it enters, metres."""
    line = LineString(way)
    found = []
    for obstacle in obstacles:
        inside = line.intersection(Polygon(obstacle).buffer(-1e-6))  # along its edge is not inside
        if inside.length > 0.0:
            ends = [Point(*part.coords[0]) for part in getattr(inside, "geoms", [inside])]
            first = min(line.project(end) for end in ends)
            found.append(line.interpolate(first).coords[0])
    return np.array(found).reshape(-1, 2)


def driven() -> "Figure":
    """Fig. 7: what the hybrid drives in that world."""
    return draw_driven(own_mission())


def speeds() -> "Figure":
    """The speeds of that mission over time, beside those that it was told."""
    mission = own_mission()
    told, true = mission.commands, mission.trajectory.twists
    return draw_commands(mission.trajectory.times, {"commanded": told, "driven": true})


@cache
def own_mission() -> Episode:
    """The mission of Fig. 7, driven once in a process."""
    return run(paper.own_world())


FIGURES: "dict[str, Callable[[], Figure]]" = {
    "fig1": numbering,
    "fig2_3": searches,
    "fig4": schematics.draw_drive,
    "fig5": partial(schematics.draw_braking, ROBOTS["paper"]),
    "fig6": unaware,
    "fig7": driven,
    "fig8": schematics.draw_system,
    "speeds": speeds,
}
