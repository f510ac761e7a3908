"""Findings on the map: its passages against the footprint, and the size of its cells."""

from collections.abc import Sequence
from dataclasses import dataclass

from dynastar.check.finding import Finding, at_most
from dynastar.check.passages import Passage, passages
from dynastar.grid import OccupancyGrid
from dynastar.navigator.config import CELLS, NavigatorConfig, fitted, margin_of
from dynastar.navigator.planners import radii_of
from dynastar.robot import Robot

ROUNDED_CELLS = 2.0  # by which rounding to cells and range noise close a gap
AREA, ACROSS = 2.0, 4.0  # m2 of a region at least, and as a square of so many circumscribed radii
WALL = 0.5  # times the narrowest way: narrower gaps count as walls
NAMED = 4  # passages that a sentence names
ROUNDING = 1e-6  # m


@dataclass(frozen=True)
class Ways:
    """Widths (m) of ways: the narrowest to drive through, one that is surely enough, one to turn in."""

    drive: float
    surely: float
    turn: float


def ways_of(robot: Robot, config: NavigatorConfig) -> Ways:
    """The widths of ways that a robot needs, its margins included."""
    margin = margin_of(robot, config)
    roomy, tight = radii_of(robot.footprint, margin)
    drive = 2.0 * max(robot.footprint.half_width + margin, tight)
    cell = fitted(config, robot).resolution
    return Ways(drive, drive + ROUNDED_CELLS * cell, 2.0 * roomy)


def passages_for(robot: Robot, config: NavigatorConfig, grid: OccupancyGrid) -> list[Passage]:
    """The passages of a map that matter to a robot, narrowest first."""
    area = max(AREA, (ACROSS * robot.footprint.circumscribed) ** 2)
    return passages(grid, config.unknown, area, WALL * ways_of(robot, config).drive)


def widths(robot: Robot, config: NavigatorConfig) -> Finding:
    """The narrowest ways that the robot can drive through and turn in."""
    ways, margin = ways_of(robot, config), margin_of(robot, config)
    text = (
        f"With its margin of {margin:.3f} m the robot ({robot.footprint.words()}) drives through "
        f"ways from {ways.drive:.2f} m wide, surely from {ways.surely:.2f} m, and turns on the spot "
        f"in {ways.turn:.2f} m."
    )
    values = {"drive": ways.drive, "surely": ways.surely, "turn": ways.turn, "margin": margin}
    return Finding("widths", "ok", text, "", values)


def doors(found: Sequence[Passage], ways: Ways) -> Finding:
    """Whether the robot fits through the passages of a map, given narrowest first."""
    shut = [one for one in found if one.width < ways.drive - ROUNDING]
    tight = [one for one in found[len(shut) :] if one.width < ways.surely - ROUNDING]
    values: dict[str, float] = {
        "passages": len(found),
        "too_narrow": len(shut),
        "tight": len(tight),
    }
    if not found:
        return Finding("doors", "ok", "The map has no passages between larger regions.", "", values)
    values["narrowest"] = found[0].width
    if shut:
        text = (
            f"The robot needs {ways.drive:.2f} m and does not fit through {_named(shut, found)}: "
            f"{_places(shut)}."
        )
        advice = "Measure them, and correct the map, the footprint or the margins, or set no goals there."
        return Finding("doors", "problem", text, advice, values)
    if tight:
        text = (
            f"The robot may not get through {_named(tight, found)}, as rounding to cells may leave "
            f"less than {ways.drive:.2f} m: {_places(tight)}."
        )
        advice = "Try them, or take a smaller resolution and smaller margins."
        return Finding("doors", "warning", text, advice, values)
    narrowest = f"{'the narrowest is ' if len(found) > 1 else ''}{_places(found[:1])}"
    text = f"The robot fits through {_named(found, found)}: {narrowest}"
    if found[0].width < ways.turn:
        text += ", where it cannot turn on the spot"
    return Finding("doors", "ok", f"{text}.", "", values)


def _named(some: Sequence[Passage], found: Sequence[Passage]) -> str:
    """Part of a sentence: "all 3 passages of the map", "1 of the map's 3 passages"."""
    if len(found) == 1:
        return "the map's only passage"
    if len(some) == len(found):
        return f"all {len(found)} passages of the map"
    return f"{len(some)} of the map's {len(found)} passages"


def _places(found: Sequence[Passage]) -> str:
    """Width and position of some passages in words."""
    words = [f"{one.width:.2f} m at ({one.x:.2f}, {one.y:.2f})" for one in found[:NAMED]]
    more = len(found) - NAMED
    return ", ".join(words) + (f" and {more} more" if more > 0 else "")


def cells(robot: Robot, config: NavigatorConfig, grid: OccupancyGrid | None) -> Finding:
    """Whether cells are small enough for the footprint."""
    half = robot.footprint.half_width
    planned = fitted(config, robot).resolution
    text = f"Plans are made in cells of {planned:.3g} m at most"
    values = {"resolution": planned, "half_width": half}
    if grid is not None:
        text += f", the map has cells of {grid.resolution:.3g} m"
        values["map"] = grid.resolution
    text += f"; half of the footprint's width is {half:.3g} m."
    if planned > half / CELLS + ROUNDING:
        advice = f"Declare resolution = {at_most(half / CELLS, 3)}, {CELLS} cells to that."
        return Finding("cells", "warning", text, advice, values)
    if grid is not None and grid.resolution > 0.5 * half + ROUNDING:
        advice = (
            f"Draw the map in cells of {at_most(0.5 * half)} m or less: walls are up to a cell thicker on "
            "it, and doors narrower."
        )
        return Finding("cells", "warning", text, advice, values)
    return Finding("cells", "ok", text, "", values)
