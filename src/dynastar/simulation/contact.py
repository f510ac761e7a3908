"""The exact contact check: solid shapes in shapely, nothing that the navigator computes with."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.simulation.rings import made_of

Floats = npt.NDArray[np.float64]

RESTING = 0.02  # m/s and rad/s under which a contact happens at rest


class Solids:
    """All that stands: a map's occupied cells, its border, and polygons (k, 2) in metres.

    Raises ScenarioError for an obstacle that is not a simple polygon.
    """

    def __init__(self, grid: OccupancyGrid, obstacles: Sequence[Floats] = ()) -> None:
        border = _box_corners(np.array([[0, 0, grid.rows, grid.columns]]))
        self._grid = grid
        self._mapped = [
            *shapely.polygons(_placed(_box_corners(occupied_runs(grid)), grid)),
            shapely.linearrings(_placed(border, grid)[0]),
        ]
        self._polygons: dict[int, tuple[Floats, shapely.Polygon]] = {}  # by the array's id
        self.change(obstacles)

    def change(self, obstacles: Sequence[Floats]) -> None:
        """Takes polygons (k, 2), metres, in place of the present ones; ScenarioError changes nothing."""
        self._polygons = made_of(obstacles, self._polygons, _polygon)
        polygons = [polygon for _, polygon in self._polygons.values()]
        self._tree = shapely.STRtree([*self._mapped, *polygons])

    def gap(self, pose: Pose2D, footprint: Footprint) -> float:
        """Metres from the footprint at ``pose`` to anything solid; <= 0 touching or off the map."""
        if not self._grid.contains(pose.x, pose.y):
            return 0.0
        shape = placed_footprint(pose, footprint)
        _, distance = self._tree.query_nearest(shape, return_distance=True, all_matches=False)
        return float(distance[0]) - (footprint.circumscribed if footprint.is_disc else 0.0)

    def gaps(self, points: Floats) -> Floats:
        """Metres (n,) from points (n, 2) to anything solid; 0 inside, or off the map."""
        found = np.zeros(len(points))
        inside = np.array([self._grid.contains(x, y) for x, y in points], np.bool_)
        if inside.any():
            places = shapely.points(points[inside])
            _, distance = self._tree.query_nearest(places, return_distance=True, all_matches=False)
            found[inside] = distance
        return found


def placed_footprint(pose: Pose2D, footprint: Footprint) -> shapely.Geometry:
    """The footprint's polygon at ``pose``, or the centre of a disc."""
    if footprint.is_disc:
        return shapely.Point(pose.x, pose.y)
    cos, sin = np.cos(pose.theta), np.sin(pose.theta)
    return shapely.Polygon(footprint.vertices @ np.array([[cos, sin], [-sin, cos]]) + pose[:2])


def occupied_runs(grid: OccupancyGrid) -> npt.NDArray[np.int64]:
    """Occupied cells as runs along rows: (n, 4) of row and column of either corner."""
    steps = np.diff(np.pad(grid.occupied, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, begin = np.nonzero(steps == 1)
    _, end = np.nonzero(steps == -1)
    return np.column_stack([rows, begin, rows + 1, end])


def _box_corners(boxes: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The corners (n, 4, 2), as row and column, of boxes (n, 4)."""
    return boxes[:, [[0, 1], [0, 3], [2, 3], [2, 1]]]


def _placed(cells: npt.NDArray[np.int64], grid: OccupancyGrid) -> Floats:
    """(n, 4, 2) of row and column as x and y in metres."""
    return grid.frame.points_to_world(cells).reshape(cells.shape)


def _polygon(number: int, ring: Floats) -> shapely.Polygon:
    what = f"obstacle {number}"
    points = np.asarray(ring, dtype=np.float64)
    if points.ndim != 2 or points.shape[0] < 3 or points.shape[1] != 2:
        raise ScenarioError(f"{what} has shape {points.shape}: expected (k >= 3, 2)")
    if not np.isfinite(points).all():
        raise ScenarioError(f"{what} has a corner that is not finite")
    polygon = shapely.Polygon(points)
    if not polygon.is_valid:
        raise ScenarioError(f"{what} is not a simple polygon: {shapely.is_valid_reason(polygon)}")
    return polygon
