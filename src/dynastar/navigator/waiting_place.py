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
    """Lengths (m) [rows, columns] of the ways to a goal by the map alone, and the first cell's index.

    They cover a square round the goal; inf where the disc does not fit, or no way leads within it.
    """

    lengths: npt.NDArray[np.float64]
    first: tuple[int, int]


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
    first = max(int(row) - reach, 0), max(int(column) - reach, 0)
    box = np.s_[first[0] : int(row) + reach + 1, first[1] : int(column) + reach + 1]
    closed = inflate(planning_map.prior[box] & ~planning_map.cleared[box], inflation)
    rows, columns = np.nonzero(~closed)
    away = np.hypot(rows + first[0] + 0.5 - row, columns + first[1] + 0.5 - column)
    if away.min(initial=np.inf) > max(tolerance / frame.resolution, 1.0):
        return None
    nearest = int(away.argmin())
    lengths = SearchGrid(closed).flood((int(rows[nearest]), int(columns[nearest])))
    return WaysToGoal(lengths * frame.resolution, first)


def waiting_place(ways: WaysToGoal, planners: Sequence[GridPlanner], start: Point) -> Point | None:
    """The place (x, y) near the goal at which to wait: for the first of ``planners`` that has one.

    Of all places about as near to the goal as any it is the one nearest to the start. None if there
    is none within ``WAIT_WITHIN``. Raises GoalObstructed if the start is about as near itself.
    """
    lengths, first = ways
    frame = planners[0].grid.frame
    start_row, start_column = np.array(frame.to_grid(*start)) - first
    here = np.inf
    if 0 <= start_row < lengths.shape[0] and 0 <= start_column < lengths.shape[1]:
        here = lengths[int(start_row), int(start_column)]
    for planner in planners:
        try:
            reached = planner.reached_from(start)
        except (StartOccupied, NoPath):
            continue
        box = reached[first[0] :, first[1] :][: lengths.shape[0], : lengths.shape[1]]
        within = np.where(box, lengths, np.inf)
        if within.min() > WAIT_WITHIN:
            continue
        if here - within.min() <= NEARER:
            raise GoalObstructed("an obstacle occupies the goal")
        rows, columns = np.nonzero(within <= within.min() + 0.5 * NEARER)
        at = np.hypot(rows + 0.5 - start_row, columns + 0.5 - start_column).argmin()
        return frame.to_world(first[0] + rows[at] + 0.5, first[1] + columns[at] + 0.5)
    return None
