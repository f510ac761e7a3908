"""Things that move, told from things that stand: cluster, associate, Kalman, confirm, predict."""

import math
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field
from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame
from dynastar.obstacles import tracker_kernels as kernels
from dynastar.obstacles.layer import ObstacleLayer, Points
from dynastar.scan import LaserScan

NEW = 8  # scans, after which what moves is known to, and where to


class TrackerConfig(NamedTuple):
    """The tracker's settings."""

    gap: Annotated[float, Field("points further apart are two things", "m", 0.01, 2.0)] = 0.2
    widest: Annotated[float, Field("what is wider does not walk", "m", 0.1, 5.0)] = 1.3
    scans: Annotated[int, Field("scans that have to agree", "", 2, 100)] = 3
    slowest: Annotated[float, Field("what is slower stands", "m/s", 0.01, 2.0)] = 0.12
    fastest: Annotated[float, Field("nothing is faster", "m/s", 0.1, 50.0)] = 3.0
    fresh_share: Annotated[
        float, Field("share of a mover's points in space seen free before", "", 0.0, 1.0)
    ] = 0.4
    fresh_time: Annotated[float, Field("how long space counts as seen before", "s", 0.1, 60.0)] = (
        3.0
    )
    rest_time: Annotated[float, Field("slow for so long stands again", "s", 0.0, 60.0)] = 1.0
    coast: Annotated[float, Field("one out of sight counts for so long", "s", 0.0, 60.0)] = 6.0
    gate: Annotated[float, Field("a track's next point lies within", "m", 0.01, 5.0)] = 0.35
    acceleration: Annotated[float, Field("noise of a mover's speed", "m/s2", 0.01, 20.0)] = 1.0
    error: Annotated[float, Field("noise of a mover's centre", "m", 0.001, 1.0)] = 0.04


class MovingObstacle(NamedTuple):
    """A disc that moves, in the map frame: centre m, velocity m/s, radius m.

    ``top_speed`` (m/s) is the fastest it was seen to go of late, if that is more than it goes now:
    what slows down may be about to turn back.
    """

    x: float
    y: float
    vx: float
    vy: float
    radius: float
    top_speed: float = 0.0


class Known(NamedTuple):
    """The map's obstacles, widened a little, which no mover is looked for in."""

    mask: npt.NDArray[np.bool_]
    frame: GridFrame


NOTHING_KNOWN = Known(np.zeros((1, 1), np.bool_), GridFrame(1.0))


class Tracker:
    """Follows what the scans show from one to the next.

    ``movers`` are the confirmed ones as of the last scan. One that is out of sight is there twice:
    where it may have got to, and where it was lost, for it may come back.
    """

    def __init__(self, config: TrackerConfig = TrackerConfig()) -> None:
        self.config = config
        self._tracks = np.zeros((0, kernels.COLUMNS))
        self._stamp = -math.inf
        self.movers: tuple[MovingObstacle, ...] = ()

    def forget(self) -> None:
        """Drops all tracks."""
        self._tracks = self._tracks[:0]
        self.movers = ()

    def see(
        self,
        scan: LaserScan,
        sensor: Pose2D,
        points: Points,
        beams: npt.NDArray[np.int64],
        layer: ObstacleLayer,
        known: Known = NOTHING_KNOWN,
    ) -> npt.NDArray[np.bool_]:
        """Takes in one scan before the layer does; returns which ``points`` lie on movers.

        What has just turned out to move is erased from the layer, back to where it was first seen.
        """
        config, now = self.config, scan.stamp
        n_beams, step = len(scan.ranges), abs(scan.angle_increment)
        full = step * n_beams > math.tau - 0.5 * step
        found = kernels.clusters(
            points,
            beams,
            n_beams,
            full,
            step,
            sensor.x,
            sensor.y,
            config.gap,
            config.widest,
            layer.free_at,
            *layer.origin,
            layer.config.resolution,
            now - config.fresh_time,
            known.mask,
            known.frame,
        )
        dt = min(max(now - self._stamp, 0.0), 1.0) if self._stamp > -math.inf else 0.0
        self._stamp = now
        kernels.predict(self._tracks, dt, config.acceleration)
        taken = kernels.associate(self._tracks, found, config.gate)
        kernels.correct(self._tracks, found, config.error, now)
        kernels.lurk(
            self._tracks,
            dt,
            layer.free_at,
            *layer.origin,
            layer.config.resolution,
            now - kernels.UNSEEN,
        )
        confirmed = kernels.judge(
            self._tracks,
            now,
            config.scans,
            config.slowest,
            config.fastest,
            config.fresh_share,
            config.rest_time,
        )
        for row in self._tracks[confirmed]:
            self._erase(row, layer)
        age = now - self._tracks[:, kernels.T_SEEN]
        moving = self._tracks[:, kernels.T_MOVING] > 0
        kept = self._tracks[age <= np.where(moving, config.coast, 0.35)]
        born = found[~taken]
        self._tracks = np.vstack([kept, self._born(born, now)]) if len(born) else kept
        self._tracks[len(kept) :, kernels.T_CLUSTER] = -1.0
        self.movers = self._confirmed()
        return kernels.on_tracks(points, self._tracks, found, 0.1)

    def in_sight(self) -> Points:
        """Centre and radius (k, 3), metres, of the confirmed movers that the last scan showed."""
        return self._last_seen(self._tracks[:, kernels.T_MOVING] > 0)

    def newcomers(self) -> Points:
        """The same of what came into view so lately that it may be going anywhere, or nowhere."""
        return self._last_seen(self._tracks[:, kernels.T_HITS] <= NEW)

    def _last_seen(self, which: npt.NDArray[np.bool_]) -> Points:
        now = self._tracks[:, kernels.T_SEEN] >= self._stamp
        columns = [kernels.T_X, kernels.T_Y, kernels.T_RADIUS]
        return np.ascontiguousarray(self._tracks[which & now][:, columns])

    def _confirmed(self) -> tuple[MovingObstacle, ...]:
        rows = self._tracks[self._tracks[:, kernels.T_MOVING] > 0]
        lurking = rows[self._stamp - rows[:, kernels.T_SEEN] > kernels.LOST]
        lurking[:, [kernels.T_X, kernels.T_Y]] = lurking[:, [kernels.T_X0, kernels.T_Y0]]
        rows = np.vstack([rows, lurking])
        order = [kernels.T_X, kernels.T_Y, kernels.T_VX, kernels.T_VY, kernels.T_RADIUS]
        order.append(kernels.T_TOP)
        return tuple(MovingObstacle(*row) for row in rows[:, order].tolist())

    def _born(self, found: npt.NDArray[np.float64], now: float) -> npt.NDArray[np.float64]:
        born = np.zeros((len(found), kernels.COLUMNS))
        born[:, [kernels.T_X, kernels.T_Y]] = found[:, [kernels.C_X, kernels.C_Y]]
        born[:, [kernels.T_X0, kernels.T_Y0]] = found[:, [kernels.C_X, kernels.C_Y]]
        born[:, kernels.T_RADIUS] = found[:, kernels.C_RADIUS]
        born[:, kernels.T_FRESH] = found[:, kernels.C_FRESH]
        born[:, kernels.T_PP] = self.config.error**2
        born[:, kernels.T_VV] = 1.0
        born[:, kernels.T_HITS] = 1.0
        born[:, kernels.T_SEEN] = now
        return born

    @staticmethod
    def _erase(row: npt.NDArray[np.float64], layer: ObstacleLayer) -> None:
        x0, y0, x, y = row[[kernels.T_X0, kernels.T_Y0, kernels.T_X, kernels.T_Y]]
        for share in np.linspace(0.0, 1.0, 2 + int(math.hypot(x - x0, y - y0) / 0.1)):
            at = (x0 + share * (x - x0), y0 + share * (y - y0))
            layer.erase(*at, row[kernels.T_RADIUS] + 0.1)
