"""The time bound of a mission: its shortest path, driven at full speed from rest.

It is a reference figure that a run's time is divided by, not a proven optimum. It is lenient: the
path is the shortest that a disc of the inscribed radius can take through the true static world, known
and unknown obstacles alike; moving obstacles, turning, braking and the latency are left out; a goal
counts as reached at the goal tolerance, and cells are taken as free where half a cell is missing. On
the other hand the path is the shortest over the centres of cells near the shortest grid path, or on
long ways that one pulled taut, which may be a few per cent too long.
"""

import hashlib
import math
from collections import OrderedDict

import cv2
import numpy as np
import numpy.typing as npt
import shapely

from dynastar.clearance import distance_field
from dynastar.errors import PlanningError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.planning import GridPlanner, PlannerConfig
from dynastar.robot import Limits
from dynastar.simulation import Scenario

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
Point = tuple[float, float]

FINEST = 0.05  # m, side of a cell, unless the map is finer or too large
MOST_CELLS = 4_000_000
ANY_ANGLE_CELLS = 500  # length of a path up to which the shortest any-angle path is looked for
KEPT = 64  # lengths kept for repeats of a mission

_lengths: OrderedDict[str, float | None] = OrderedDict()


def time_bound(scenario: Scenario) -> float | None:
    """Seconds that the shortest path takes at full speed from rest; None if there is no path."""
    length = shortest_length(scenario)
    return None if length is None else least_time(length, scenario.robot.limits)


def least_time(length: float, limits: Limits) -> float:
    """Seconds for ``length`` m from rest with the largest acceleration, without braking at the end."""
    ramp = 0.5 * limits.v_max**2 / limits.v_accel
    if length <= ramp:
        return math.sqrt(2.0 * length / limits.v_accel)
    return length / limits.v_max + 0.5 * limits.v_max / limits.v_accel


def shortest_length(scenario: Scenario) -> float | None:
    """Metres from the start to within the goal tolerance of each goal in turn; None without a path.

    Missions of the same geometry are computed once in a process.
    """
    key = _digest(scenario)
    if key not in _lengths:
        _lengths[key] = _shortest_length(scenario)
        while len(_lengths) > KEPT:
            _lengths.popitem(last=False)
    return _lengths[key]


def true_space(scenario: Scenario) -> OccupancyGrid:
    """The true static world as cells that are occupied where the centre of the robot cannot be."""
    grid = scenario.grid if scenario.world is None else scenario.world
    factor = max(1, math.ceil(grid.resolution / FINEST - 1e-6))
    while factor > 1 and grid.rows * grid.columns * factor**2 > MOST_CELLS:
        factor -= 1
    fine = grid.refined(factor)
    solid = np.array(fine.occupied)
    for ring in scenario.obstacles:
        _fill(solid, fine.frame.points_to_grid(ring))
    radius = scenario.robot.footprint.inscribed
    # The border of the map is solid: a robot touches it.
    walled = np.pad(solid, 1, constant_values=True)
    closed = distance_field(walled, fine.resolution)[1:-1, 1:-1] < radius
    return OccupancyGrid((closed | solid).astype(np.int8) * 100, fine.frame)


def _shortest_length(scenario: Scenario) -> float | None:
    space = true_space(scenario)
    free = (~space.occupied).astype(np.uint8)
    _, parts = cv2.connectedComponents(free, connectivity=8)
    # The robot does stand at its start: a start that is not free is moved to the nearest free cell.
    here = _nearest(space, parts > 0, scenario.start[:2], math.inf)
    if here is None:
        return None
    reachable = parts == parts[space.world_to_cell(*here)]
    total, tolerance = 0.0, scenario.goal_tolerance
    for number, goal in enumerate(scenario.goals):
        there = _nearest(space, reachable, (goal.x, goal.y), tolerance + space.resolution)
        if there is None:
            return None
        try:
            total += _straightened(space, here, there)
        except PlanningError:
            return None
        last = number == len(scenario.goals) - 1
        total -= max(0.0, (1 if last else 2) * tolerance - math.dist(there, (goal.x, goal.y)))
        here = there
    return max(total, 0.0)


def _straightened(space: OccupancyGrid, here: Point, there: Point) -> float:
    """Metres of the shortest path over straight lines; of one pulled taut where that would take long."""
    plan = GridPlanner(space, 0.0, config=PlannerConfig("auto")).plan(here, there)
    if plan.cost > ANY_ANGLE_CELLS:
        return plan.path.length
    config = PlannerConfig("auto", smoothing="any-angle")
    straight = GridPlanner(space, 0.0, config=config).plan(here, there)
    return min(plan.path.length, straight.path.length)


def _nearest(space: OccupancyGrid, allowed: Mask, point: Point, within: float) -> Point | None:
    """``point`` if its cell is allowed, else the nearest centre of one that is; None if too far."""
    x, y = point
    if space.contains(x, y) and allowed[space.world_to_cell(x, y)]:
        return x, y
    rows, columns = np.nonzero(allowed)
    if len(rows) == 0:
        return None
    row, column = space.frame.to_grid(x, y)
    gaps = np.hypot(rows + 0.5 - row, columns + 0.5 - column)
    best = int(np.argmin(gaps))
    if gaps[best] * space.resolution > within:
        return None
    return space.cell_to_world(int(rows[best]), int(columns[best]))


def _fill(solid: Mask, cells: Floats) -> None:
    """Marks the cells whose centres lie in a polygon (k, 2) of row and column."""
    low = np.maximum(np.floor(cells.min(axis=0)).astype(int), 0)
    high = np.maximum(np.ceil(cells.max(axis=0)).astype(int) + 1, low)
    part = solid[low[0] : high[0], low[1] : high[1]]
    rows, columns = np.indices(part.shape)
    part |= shapely.contains_xy(shapely.Polygon(cells), rows + low[0] + 0.5, columns + low[1] + 0.5)


def _digest(scenario: Scenario) -> str:
    """Digest of everything that the shortest path depends on."""
    grid = scenario.grid if scenario.world is None else scenario.world
    footprint = scenario.robot.footprint
    digest = hashlib.sha256(np.ascontiguousarray(grid.values).tobytes())
    for ring in scenario.obstacles:
        digest.update(np.ascontiguousarray(ring, dtype=np.float64).tobytes())
    goals = [(goal.x, goal.y) for goal in scenario.goals]
    frame: GridFrame = grid.frame
    ends = (scenario.start[:2], goals, scenario.goal_tolerance)
    digest.update(repr((grid.values.shape, tuple(frame), footprint.inscribed, ends)).encode())
    return digest.hexdigest()
