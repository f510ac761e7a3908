"""Why there is no plan, and what would help, found by a slow look at the map."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.clearance import distance_to_squares
from dynastar.errors import GoalOccupied, NoPath, OutOfMap, PlanningError, StartOccupied
from dynastar.geometry import place
from dynastar.grid import OccupancyGrid, Unknown
from dynastar.planning.neighbours import components
from dynastar.planning.search import SearchGrid

Point = tuple[float, float]
Floats = npt.NDArray[np.float32]

HALVINGS = 20
UNKNOWN_HELPS = "unknown = 'free' (--unknown free) plans through unknown space"


def explained(
    error: PlanningError,
    grid: OccupancyGrid,
    start: Point,
    goal: Point,
    radius: float,
    unknown: Unknown,
) -> PlanningError:
    """An error of the same kind that says what would help, or the same if nothing more is found.

    For a point where the disc does not fit it names what blocks it and the nearest place where it
    fits; for two points that no path connects the widest disc that would pass and the narrowest
    place. ``radius`` (m) is that of the disc, unless the error has one.
    """
    words = None
    radius = radius if error.radius is None else error.radius
    if isinstance(error, StartOccupied):
        words = misfit(grid, "the start", start, radius, unknown)
    elif isinstance(error, GoalOccupied):
        words = misfit(grid, "the goal", goal, radius, unknown)
    elif isinstance(error, NoPath):
        words = parted(grid, start, goal, radius, unknown)
    return error if words is None else type(error)(words)


def misfit(
    grid: OccupancyGrid, what: str, xy: Point, radius: float, unknown: Unknown
) -> str | None:
    """Why a disc does not fit at a point, and the nearest place where it fits; None if it fits.

    Raises OutOfMap for a point off the map.
    """
    x, y = xy[0], xy[1]
    try:
        cell = grid.world_to_cell(x, y)
    except OutOfMap as error:
        raise OutOfMap(f"{what} {error}") from None
    blocked = grid.blocked(unknown)
    field = distance_to_squares(blocked) * grid.resolution
    if blocked[cell]:
        trouble = f"is in {_kind(grid, cell)}"
    else:
        gap, near = _nearest_blocked(grid, blocked, (x, y))
        if gap >= radius and field[cell] >= radius:
            return None
        what_is_near = "the map's edge" if near is None else _kind(grid, near)
        trouble = f"is {gap:.3g} m from {what_is_near}, nearer than the radius of {radius:.3g} m"
        if gap >= radius:
            trouble = f"has no cell beside it where a radius of {radius:.3g} m fits"
    words = [f"{what} {place(x, y)} {trouble}", _nearest_fit(grid, field, (x, y), radius)]
    if unknown == "blocked" and grid.unknown[cell]:
        words.append(UNKNOWN_HELPS)
    return "; ".join(words)


def parted(
    grid: OccupancyGrid, start: Point, goal: Point, radius: float, unknown: Unknown
) -> str | None:
    """Message for two points of the map that no path connects; None if a path does."""
    ends = grid.world_to_cell(start[0], start[1]), grid.world_to_cell(goal[0], goal[1])
    field = distance_to_squares(grid.blocked(unknown))
    width, where = _widest(field, ends)
    if width * grid.resolution >= radius > 0.0:
        return None
    words = f"no way leads from {place(*start)} to {place(*goal)} for a radius of {radius:.3g} m"
    if width > 0.0:
        x, y = grid.cell_to_world(*where)
        words += (
            f"; the widest that would pass has {_rounded_down(width * grid.resolution):g} m, "
            f"and {place(x, y)} is where it is narrowest"
        )
    else:
        words += ", nor for any other"
    if unknown == "blocked" and _widest(distance_to_squares(grid.blocked("free")), ends)[0] > width:
        words += f"; {UNKNOWN_HELPS}"
    if grid.keepout is not None:
        without = OccupancyGrid(grid.values, grid.frame).blocked(unknown)
        if _widest(distance_to_squares(without), ends)[0] > width:
            words += "; keep-out zones are in the way"
    return words


def _kind(grid: OccupancyGrid, cell: tuple[int, int]) -> str:
    """Name what blocks a cell."""
    if grid.occupied[cell]:
        return "an obstacle"
    if grid.keepout is not None and grid.keepout[cell]:
        return "a keep-out zone"
    return "unknown space"


def _nearest_blocked(
    grid: OccupancyGrid, blocked: npt.NDArray[np.bool_], xy: Point
) -> tuple[float, tuple[int, int] | None]:
    """Metres from a point to the nearest blocked cell's square, and the cell; None for the edge."""
    row, column = grid.frame.to_grid(*xy)
    rows, columns = np.nonzero(blocked)
    edge = min(row, column, grid.rows - row, grid.columns - column)
    if len(rows):
        away = np.hypot(
            np.maximum(np.abs(rows + 0.5 - row) - 0.5, 0.0),
            np.maximum(np.abs(columns + 0.5 - column) - 0.5, 0.0),
        )
        at = int(away.argmin())
        if away[at] <= edge:
            return float(away[at]) * grid.resolution, (int(rows[at]), int(columns[at]))
    return edge * grid.resolution, None


def _nearest_fit(grid: OccupancyGrid, field: Floats, xy: Point, radius: float) -> str:
    rows, columns = np.nonzero((field >= radius) & (field > 0.0))
    if len(rows) == 0:
        widest = _rounded_down(float(field.max()))
        return f"it fits nowhere on this map; the widest that does has {widest:g} m"
    points = grid.frame.points_to_world(np.column_stack([rows, columns]) + 0.5)
    away = np.hypot(*(points - (xy[0], xy[1])).T)
    x, y = points[away.argmin()]
    return f"the nearest place where it fits is {place(x, y, 6)}, {away.min():.3g} m away"


def _widest(
    field: Floats, ends: tuple[tuple[int, int], tuple[int, int]]
) -> tuple[float, tuple[int, int]]:
    """Radius, in cells, of the widest disc that can pass between two cells, and the narrowest cell.

    The radius is 0 if no disc can. ``field`` is the distance, in cells, from every cell's centre to
    the nearest blocked square.
    """
    low, high = 0.0, float(min(field[ends[0]], field[ends[1]]))
    if not _connected(field > 0.0, ends):
        return 0.0, ends[0]
    if _connected(field >= high, ends):
        low = high
    else:
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if _connected(field >= middle, ends) else (low, middle)
    free = (field > 0.0) & (field >= low)
    cells = SearchGrid(~free).search(*ends, "astar").cells
    gaps = field[cells[:, 0], cells[:, 1]]
    ties = np.flatnonzero(gaps <= gaps.min() + 1e-3)
    row, column = cells[ties[len(ties) // 2]]
    return low, (int(row), int(column))


def _connected(free: npt.NDArray[np.bool_], ends: tuple[tuple[int, int], tuple[int, int]]) -> bool:
    """Whether two cells are free and connected."""
    parts = components(free)
    return bool(parts[ends[0]] == parts[ends[1]] != 0)


def _rounded_down(metres: float) -> float:
    return math.floor(1e3 * metres + 0.01) / 1e3  # 0.01 mm for what was halved and rounded
