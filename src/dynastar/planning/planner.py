"""Planning on a map in metres: way out of the inflation, search and smoothing."""

import math
import time

import numpy as np
import numpy.typing as npt

from dynastar.config import choose, summary
from dynastar.errors import (
    ConfigError,
    GoalOccupied,
    InputError,
    NoPath,
    OutOfMap,
    PlanningError,
    StartOccupied,
)
from dynastar.geometry import as_point, place
from dynastar.grid import OccupancyGrid, Unknown
from dynastar.masks import zone_around
from dynastar.path import Path
from dynastar.planning.any_angle import straighten
from dynastar.planning.escape import NO_WAY, WayOut, reach_of_escape, smoothed, way_out
from dynastar.planning.explain import explained
from dynastar.planning.inflated import InflatedGrid, Window
from dynastar.planning.plan_type import Plan, PlannerConfig, as_radius
from dynastar.planning.search import ALGORITHMS, Cell, Cells, SearchResult
from dynastar.planning.segments import first_contact
from dynastar.planning.smoothing import smooth, without_repeats
from dynastar.planning.warming import warm_up

Mask = npt.NDArray[np.bool_]
Point = tuple[float, float]


class GridPlanner:
    """A map prepared once for many plans for a disc of ``radius`` metres.

    ``unknown`` says whether unknown cells are "free" or "blocked"; cells outside the map are
    blocked. Where ``grid`` is a refined map, a cell of the map is ``cell`` of its cells wide, and
    Eq. 2 counts in cells of the map. Raises ConfigError for a radius below 0 or a planner that does
    not exist, InputError for a ``grid`` of another type.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        radius: float,
        unknown: Unknown = "blocked",
        config: PlannerConfig = PlannerConfig(),
        cell: int = 1,
    ) -> None:
        if not isinstance(grid, OccupancyGrid):
            raise InputError(
                f"a map is of type {type(grid).__name__}: expected an OccupancyGrid, as "
                "OccupancyGrid(array, 0.05) makes of an array with cells of 5 cm"
            )
        self.radius = as_radius(radius)
        choose(config.planner, ALGORITHMS, "planner")
        self.grid = grid
        self.config = config
        self._inflated_grid = InflatedGrid(
            grid.blocked(unknown), self.radius / grid.resolution, cell
        )
        self._failed = False  # the last search found no way

    def __repr__(self) -> str:
        disc = f"for a disc of radius {self.radius:g} m"
        return summary(self, self.config.planner, disc, self.grid.size(), self.grid.extent())

    @property
    def blocked(self) -> Mask:
        """True where a cell is blocked, [rows, columns]; read-only."""
        return self._inflated_grid.blocked

    @property
    def free(self) -> npt.NDArray[np.uint8]:
        """Not 0 where the disc fits, [rows, columns]; a view, not to be written to."""
        return self._inflated_grid.search.free

    @property
    def inflated(self) -> Mask:
        """True where the disc's centre may not be, [rows, columns]; a copy."""
        return self._inflated_grid.search.occupied

    @property
    def explored(self) -> Cells:
        """The cells (n, 2) that the last search expanded, row by row."""
        return self._inflated_grid.search.expanded_cells()

    def mark(self, row0: int, col0: int, patch_blocked: npt.ArrayLike) -> None:
        """Replace the window of the map at (row0, col0), true where a cell is blocked now.

        The next plan takes it into account. Raises OutOfMap if the window leaves the map.
        """
        self._inflated_grid.mark(row0, col0, patch_blocked)

    def plan(
        self,
        start_xy: Point,
        goal_xy: Point,
        explored: bool = False,
        planner: str = "",
        tolerance: float = 0.0,
    ) -> Plan:
        """The path from start to goal, both (x, y) in metres, by the configured planner or another.

        From a start inside the inflation the path first takes the shortest way out that leads on to
        the goal (see ``way_out``). Where the disc does not fit at the goal, or no way leads there,
        the path ends at the nearest place that can be reached within ``tolerance`` metres. Raises
        OutOfMap, StartOccupied, GoalOccupied or NoPath, and ConfigError for a tolerance that is not valid.
        """
        start_xy, goal_xy = as_point(start_xy, "the start"), as_point(goal_xy, "the goal")
        planner = planner or self.config.planner
        if not tolerance >= 0.0:
            raise ConfigError(f"a goal's tolerance is {tolerance} m: expected 0 m or more")
        diagonal = math.hypot(self.grid.rows, self.grid.columns)
        reach = min(tolerance / self.grid.resolution, diagonal)  # cells
        try:
            goal = self._point(goal_xy, "goal")
            self._point(start_xy, "start")
            cell = self._inflated_grid.fitting_cell(goal)
            if cell is not None:
                only = np.array([cell], np.int32)
                try:
                    return self._plan(start_xy, goal_xy, only, explored, planner)
                except NoPath:
                    if tolerance <= 0.0:
                        raise
            places = self._inflated_grid.places_near(goal, reach)
            if len(places) == 0:
                raise GoalOccupied(self._misfit("goal", goal))
            return self._plan(start_xy, goal_xy, places, explored, planner)
        except PlanningError as error:
            error.radius = self.radius
            raise

    def reached_from(self, start_xy: Point, window: Window = np.s_[:, :]) -> Mask:
        """True where the disc can go from a start, or from any place where it leaves the inflation there.

        [rows, columns] of the ``window`` of the map; raises OutOfMap or StartOccupied.
        """
        cell, way = self._way_out(self._point(start_xy, "start"), None)
        inflated = self._inflated_grid
        from_here = way.parts if len(way.cells) else inflated.parts.at(*np.array(cell))
        return np.isin(inflated.parts_in(window), from_here)

    def _plan(
        self, start_xy: Point, goal_xy: Point, places: Cells, explored: bool, planner: str
    ) -> Plan:
        """A plan to the first of ``places`` (n, 2) that can be reached, and on towards the goal."""
        warm_up()
        began = time.perf_counter()
        inflated = self._inflated_grid
        start, goal = self._point(start_xy, "start"), self._point(goal_xy, "goal")
        way, found = self._search_from(start, goal, places, explored, planner)
        row, column = map(int, found.cells[-1])
        end = inflated.as_near_as_fits((row, column), goal)
        end_xy = goal_xy if end == goal else self.grid.frame.to_world(*end)
        lead = without_repeats(np.vstack([[start], way.cells + 0.5]))
        centres = found.cells + 0.5
        if tuple(start_xy) == tuple(end_xy):
            centres = centres[:0]
        main = without_repeats(np.vstack([lead[-1:], centres, [end]]))
        grid_line = np.vstack([lead, main[1:]])
        line = grid_line
        if self.config.smoothing != "none":
            rounding = self.config.rounding / self.grid.resolution
            lead = smoothed(inflated, lead, way)
            if self.config.smoothing == "any-angle":
                taut = smooth(inflated.bytes, main, inflated.radius)
                main = straighten(inflated.bytes, main, inflated.radius, taut)
            main = smooth(inflated.bytes, main, inflated.radius, rounding)
            line = np.vstack([lead, main[1:]])
        time_ms = 1e3 * (time.perf_counter() - began)
        lead_steps = np.diff(lead, axis=0)
        return Plan(
            planner=planner,
            path=self._path(line, start_xy, end_xy),
            grid_path=self._path(grid_line, start_xy, end_xy),
            cells=np.vstack([way.cells[:-1], found.cells]),
            cost=found.cost + float(np.hypot(*np.diff(way.cells, axis=0).T).sum()),
            expanded=found.expanded,
            explored=found.explored,
            time_ms=time_ms,
            radius=self.radius,
            clear_from=float(np.hypot(*lead_steps.T).sum()) * self.grid.resolution,
        )

    def path_blocked_at(self, points: npt.ArrayLike, radius: float | None = None) -> float | None:
        """Metres along a polyline (n, 2), in metres, up to where the disc first touches something.

        None if the disc can follow the polyline to its end. ``radius`` (m) replaces the planner's.
        Raises InputError for points that are not finite or of another shape, ConfigError for the radius.
        """
        radius = self.radius if radius is None else as_radius(radius)
        path = Path(points)  # type: ignore[arg-type]
        cells = self.grid.frame.points_to_grid(path.points)
        if len(cells) == 1:
            cells = np.repeat(cells, 2, axis=0)
        at = first_contact(self._inflated_grid.bytes, cells, radius / self.grid.resolution)
        return None if at < 0.0 else at * self.grid.resolution

    def _search_from(
        self, start: Point, goal: Point, places: Cells, explored: bool, planner: str
    ) -> tuple[WayOut, SearchResult]:
        """The way out of the inflation, and the way on to the first of ``places`` within reach."""
        search = self._inflated_grid.search
        try:
            cell, way = self._way_out(start, places)
            last = self._first_reached(cell, places)
            found = search.search(cell, last, planner, self.config.heuristic, explored)
        except NoPath:
            self._failed = True
            ends = self.grid.frame.to_world(*start), self.grid.frame.to_world(*goal)
            words = " to ".join(place(x, y) for x, y in ends)
            raise NoPath(f"no way leads from {words}") from None
        self._failed = False
        return way, found

    def _way_out(self, start: Point, places: Cells | None) -> tuple[Cell, WayOut]:
        """The cell from which a search begins, and the way out of the inflation that leads there."""
        inflated = self._inflated_grid
        cell = inflated.fitting_cell(start)
        if cell is not None:
            return cell, NO_WAY
        here = int(start[0]), int(start[1])
        try:
            way = way_out(inflated, here, places, zone_around(self.grid, here))
        except StartOccupied:
            looked = reach_of_escape(inflated.radius) * self.grid.resolution
            raise StartOccupied(
                f"{self._misfit('start', start)}, and no way out was found within {looked:.3g} m"
            ) from None
        return (int(way.cells[-1, 0]), int(way.cells[-1, 1])), way

    def _first_reached(self, cell: Cell, places: Cells) -> Cell:
        """The first of ``places`` that is connected with a cell. Raises NoPath if none is.

        On the map as given a single place is left to the search, unless the last search failed: one
        for a place that cannot be reached expands all that the disc can reach.
        """
        row, column = map(int, places[0])
        if len(places) > 1 or self._failed or self._inflated_grid.is_marked:
            parts = self._inflated_grid.parts
            reached = places[parts.at(*places.T) == parts.at(*np.array(cell))]
            if len(reached) == 0:
                raise NoPath(f"no place can be reached from cell {cell}")
            row, column = map(int, reached[0])
        return row, column

    def _point(self, xy: Point, name: str) -> Point:
        """(row, column) of a world point in fractions of cells."""
        row, column = self.grid.frame.to_grid(*xy)
        if not (0 <= row < self.grid.rows and 0 <= column < self.grid.columns):
            raise OutOfMap(
                f"the {name} {place(*xy, 6)} is off the map, which spans {self.grid.extent()}"
            )
        return row, column

    def _misfit(self, name: str, point: Point) -> str:
        """Message for a point where the disc does not fit; ``explained`` says why."""
        x, y = self.grid.frame.to_world(*point)
        return f"the {name} {place(x, y)} has no room for a radius of {self.radius:.3g} m"

    def _path(self, line: npt.NDArray[np.float64], start_xy: Point, goal_xy: Point) -> Path:
        points = self.grid.frame.points_to_world(line)
        points[0], points[-1] = start_xy[:2], goal_xy[:2]
        if len(points) == 1 and tuple(start_xy) != tuple(goal_xy):
            points = np.array([start_xy, goal_xy])
        return Path(points)


def plan(
    grid: OccupancyGrid,
    start: Point,
    goal: Point,
    planner: str = "improved",
    radius: float = 0.0,
    unknown: Unknown = "blocked",
    explored: bool = False,
    tolerance: float = 0.0,
) -> Plan:
    """Plan once from ``start`` to ``goal``, (x, y) in metres, for a disc of ``radius`` metres.

    A pose or a Goal may be given for a point. Where the goal cannot be reached, the path ends at the
    nearest place within ``tolerance`` metres that can. Raises OutOfMap, StartOccupied, GoalOccupied or
    NoPath, ConfigError for an unknown planner, InputError for a map or point of another type.
    """
    config = PlannerConfig(planner=planner)
    try:
        prepared = GridPlanner(grid, radius, unknown, config)
        return prepared.plan(start, goal, explored, tolerance=tolerance)
    except PlanningError as error:
        raise explained(error, grid, start, goal, radius, unknown) from None
