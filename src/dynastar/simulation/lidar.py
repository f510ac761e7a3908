"""The simulated lidar: what a scan of the true world says."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, compose
from dynastar.grid import OccupancyGrid
from dynastar.robot import Lidar
from dynastar.scan import LaserScan
from dynastar.simulation import lidar_kernels as kernels
from dynastar.simulation.imperfections import LidarDriver
from dynastar.simulation.noise import cut_gaussian
from dynastar.simulation.rings import made_of

Floats = npt.NDArray[np.float64]

NO_DISCS = np.empty((0, 3))


class LidarSimulator:
    """Casts a lidar's beams, all at one moment, against a map, polygons and discs.

    The map's occupied cells are solid and so is its border; unknown cells are not. ``obstacles``
    are polygons (k, 2) in metres. ``random`` draws errors of up to ``range_bound`` metres and
    the number of readings, if ``driver`` varies it.
    """

    def __init__(
        self,
        lidar: Lidar,
        grid: OccupancyGrid,
        obstacles: Sequence[Floats] = (),
        range_bound: float = 0.0,
        random: np.random.Generator | None = None,
        driver: LidarDriver = LidarDriver(),
    ) -> None:
        self.lidar, self._driver = lidar, driver
        self._free = free_cells(grid)
        self._frame = tuple(map(float, grid.frame))
        self._edges_of: dict[int, tuple[Floats, Floats]] = {}  # by the array's id
        self.change(obstacles)
        self._range_bound = range_bound
        self._random = random or np.random.default_rng(0)

    def change(self, obstacles: Sequence[Floats]) -> None:
        """Takes polygons (k, 2), metres, in place of the present ones."""
        self._edges_of = made_of(obstacles, self._edges_of, lambda _, ring: edges_of(ring))
        edges = [edges for _, edges in self._edges_of.values()]
        self._edges = np.concatenate([np.empty((0, 4)), *edges])

    def scan(self, pose: Pose2D, stamp: float, discs: Floats = NO_DISCS) -> LaserScan:
        """Scan of a lidar of a robot at ``pose``; ``discs`` (m, 3) are x, y, radius in metres.

        +inf, or what the driver writes for it, is nothing within range_max; readings below range_min
        are given as they are.
        """
        lidar = self.lidar
        if self._driver.readings is not None:
            low, high = sorted(self._driver.readings)
            lidar = lidar._replace(beams=int(self._random.integers(low, high + 1)))
        sensor, increment = compose(pose, lidar.mount), lidar.increment
        full = lidar.fov > math.tau - 1e-6
        angle_min = -math.pi if full else -0.5 * increment * (lidar.beams - 1)
        ranges = np.empty(lidar.beams)
        kernels.cast(
            self._free,
            self._frame,
            self._edges,
            discs,
            (sensor.x, sensor.y, sensor.theta + angle_min),
            (increment, lidar.range_max),
            ranges,
        )
        self._see_posts(ranges, angle_min, increment)
        if self._range_bound > 0.0:
            error = cut_gaussian(self._random, self._range_bound, lidar.beams)
            seen = np.isfinite(ranges)
            ranges[seen] = np.clip(ranges[seen] + error[seen], 0.0, lidar.range_max)
        return LaserScan(
            stamp,
            self._written(ranges).astype(np.float32),
            angle_min,
            increment,
            lidar.range_min,
            lidar.range_max,
            lidar.mount,
        )

    def _see_posts(self, ranges: Floats, angle_min: float, increment: float) -> None:
        """Puts the posts of the robot's own body into the ranges."""
        for post in self._driver.posts:
            middle = (post.angle - angle_min) % math.tau / increment
            first = round(middle - 0.5 * (post.readings - 1))
            hit = (first + np.arange(post.readings)) % max(round(math.tau / increment), 1)
            hit = hit[hit < len(ranges)]
            ranges[hit] = np.minimum(ranges[hit], post.distance)

    def _written(self, ranges: Floats) -> Floats:
        """The ranges as the driver writes them."""
        driver = self._driver
        if driver.rounding > 0.0:
            ranges = np.round(ranges / driver.rounding) * driver.rounding
        return np.where(np.isinf(ranges), driver.nothing, ranges)


def edges_of(ring: Floats) -> Floats:
    """The edges (k, 4) of a polygon (k, 2), anticlockwise."""
    after = np.roll(ring, -1, axis=0)
    area = ring[:, 0] @ after[:, 1] - ring[:, 1] @ after[:, 0]
    return np.hstack([ring, after]) if area >= 0.0 else np.hstack([after, ring])


def free_cells(grid: OccupancyGrid) -> npt.NDArray[np.int32]:
    """Chessboard distance in cells to the nearest solid one, [rows + 2, columns + 2].

    It is 0 in occupied cells and in the outermost ring, which stands for the border.
    """
    free = np.pad(~grid.occupied, 1).astype(np.uint8)
    return np.ascontiguousarray(cv2.distanceTransform(free, cv2.DIST_C, 3), dtype=np.int32)
