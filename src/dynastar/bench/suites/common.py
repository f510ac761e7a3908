"""What suites share: shapes, which mover was touched, worlds of other simulators."""

import math

import numpy as np
import numpy.typing as npt
import shapely

from dynastar.episode import Episode
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.simulation import World
from dynastar.simulation.contact import RESTING, placed_footprint

Floats = npt.NDArray[np.float64]

TOUCHING = 0.02  # m, the largest gap at which a mover counts as the one that was touched
DISC_SIDES = 12


def empty_map(x: tuple[float, float], y: tuple[float, float], resolution: float) -> OccupancyGrid:
    """A map where nothing is occupied, over ranges of x and y in metres."""
    rows = math.ceil((y[1] - y[0]) / resolution - 1e-9)
    columns = math.ceil((x[1] - x[0]) / resolution - 1e-9)
    return OccupancyGrid(
        np.zeros((rows, columns), dtype=np.int8), GridFrame(resolution, x[0], y[0])
    )


def disc_polygon(x: float, y: float, radius: float) -> Floats:
    """The regular polygon (12, 2) whose sides touch a disc from outside."""
    angles = np.arange(DISC_SIDES) * math.tau / DISC_SIDES
    reach = radius / math.cos(math.pi / DISC_SIDES)
    return np.column_stack([x + reach * np.cos(angles), y + reach * np.sin(angles)])


def touched_mover(episode: Episode) -> int | None:
    """The number of the mover that the robot was in contact with at the end; None for none."""
    if not episode.contact or len(episode.mover_radii) == 0:
        return None
    footprint = Footprint.polygon(episode.footprint.tolist()) if len(episode.footprint) else None
    shape = placed_footprint(
        Pose2D(*episode.trajectory.poses[-1]), footprint or Footprint.disc(episode.radius)
    )
    gaps = shapely.distance(shape, shapely.points(np.nan_to_num(episode.movers[-1], nan=1e9)))
    gaps = gaps - episode.mover_radii - (0.0 if footprint else episode.radius)
    nearest = int(np.argmin(gaps))
    return nearest if gaps[nearest] <= TOUCHING else None


class DirectWorld(World):
    """A world of another simulator, whose robots move as commanded: nothing slips or comes late."""

    @property
    def wheels(self) -> Twist:
        """The same as ``twist``."""
        return self.twist

    @property
    def resting(self) -> bool:
        """Whether the robot stands."""
        return all(abs(speed) < RESTING for speed in self.twist)
