"""Where the robot waits for a goal that only sensed obstacles keep it from."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import inflate
from dynastar.errors import GoalObstructed, NoPath, StartOccupied
from dynastar.perception.planning_map import PlanningMap
from dynastar.planning import GridPlanner, SearchGrid

Point = tuple[float, float]

WAIT_WITHIN = 1.5  # m to the goal, by the map alone, from which the robot waits for the goal
NEARER = 0.3  # m by which a place to wait has to be nearer to the goal


class WaysToGoal(NamedTuple):
    """Lengths (m) [rows, columns] of the ways to a goal by the map alone.

    They cover a square round the goal, whose low corner is at (``row``, ``column``) of the planning map;
    inf where the disc does not fit, or no way leads within the square.
    """

    lengths: npt.NDArray[np.float64]
    row: int
    column: int


def ways_to(
    planning_map: PlanningMap, goal: Point, radius: float, tolerance: float
) -> WaysToGoal | None:
    """The ways of a disc of ``radius`` m to a goal (x, y), as if nothing had been sensed.

    None if the map alone has no place for the disc within ``tolerance`` (m) of the goal.
    """
    frame = planning_map.grid.frame
    row, column = frame.to_grid(*goal)
    inflation, half = radius / frame.resolution, WAIT_WITHIN / frame.resolution
    reach = math.ceil(half) + math.ceil(inflation) + 1
    low, left = max(int(row) - reach, 0), max(int(column) - reach, 0)
    box = np.s_[low : int(row) + reach + 1, left : int(column) + reach + 1]
    closed = inflate(planning_map.prior[box] & ~planning_map.cleared[box], inflation)
    rows, columns = np.nonzero(~closed)
    away = np.hypot(rows + low + 0.5 - row, columns + left + 0.5 - column)
    if away.min(initial=np.inf) > max(tolerance / frame.resolution, 1.0):
        return None
    nearest = int(away.argmin())
    lengths = SearchGrid(closed).flood((int(rows[nearest]), int(columns[nearest])))
    return WaysToGoal(lengths * frame.resolution, low, left)


def waiting_place(ways: WaysToGoal, planners: Sequence[GridPlanner], start: Point) -> Point | None:
    """The place (x, y) near the goal at which to wait: for the first of ``planners`` that has one.

    Of all places about as near to the goal as any it is the one nearest to the start. None if there
    is none within ``WAIT_WITHIN``. Raises GoalObstructed if the start is about as near itself.
    """
    lengths, frame = ways.lengths, planners[0].grid.frame
    height, width = lengths.shape
    row, column = frame.to_grid(*start)
    box = np.s_[ways.row : ways.row + height, ways.column : ways.column + width]
    row, column = row - ways.row, column - ways.column
    is_within = 0 <= row < height and 0 <= column < width
    here = lengths[int(row), int(column)] if is_within else np.inf
    for planner in planners:
        try:
            reached = planner.reached_from(start, box)
        except (StartOccupied, NoPath):
            continue
        within = np.where(reached, lengths, np.inf)
        if within.min() > WAIT_WITHIN:
            continue
        if here - within.min() <= NEARER:
            raise GoalObstructed("an obstacle occupies the goal")
        rows, columns = np.nonzero(within <= within.min() + 0.5 * NEARER)
        at = np.hypot(rows + 0.5 - row, columns + 0.5 - column).argmin()
        return frame.to_world(ways.row + rows[at] + 0.5, ways.column + columns[at] + 0.5)
    return None
