"""Tracking of moving obstacles: which of the things that scans show move, and how."""

import math
from typing import Annotated, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, self_checking
from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame
from dynastar.perception import detection
from dynastar.perception import tracking_kernels as kernels
from dynastar.perception.detection import Known, Sensor
from dynastar.perception.local_map import LocalMap, Points
from dynastar.perception.past_scans import PastScans
from dynastar.scan import LaserScan

TrackState = Literal["tentative", "confirmed", "stopped", "occluded"]
NOTHING_KNOWN = Known(np.zeros((1, 1), np.bool_), GridFrame(1.0))


@self_checking
class TrackerConfig(NamedTuple):
    """Settings of detection and tracking."""

    widest: Annotated[float, Field("largest width of a moving obstacle", "m", 0.1, 5.0)] = 1.4
    fastest: Annotated[float, Field("largest speed of a moving obstacle", "m/s", 0.1, 50.0)] = 3.0
    occluded_time: Annotated[
        float, Field("time for which a track out of sight is kept", "s", 0.0, 60.0)
    ] = 6.0


class MovingObstacle(NamedTuple):
    """A disc that moves, in the map frame: centre (m), velocity (m/s), radius (m)."""

    x: float
    y: float
    vx: float
    vy: float
    radius: float


class Track(NamedTuple):
    """A disc followed over time, in the map frame: centre (m), velocity (m/s), radius (m).

    ``position_sd`` (m) and ``velocity_sd`` (m/s) are standard deviations along each axis; ``age``,
    ``unseen`` and ``still`` the seconds since it was first seen, since it was last seen, and that it
    has stood still (0 while it moves).
    """

    id: int
    x: float
    y: float
    vx: float
    vy: float
    radius: float
    position_sd: float
    velocity_sd: float
    state: TrackState
    age: float
    unseen: float
    still: float


class Tracker:
    """Follows things from scan to scan, within ``range_error`` (m), and finds out which of them move.

    ``tracks``, as of the last scan, are "tentative" (seems to move, not yet for certain), "confirmed"
    (moves), "stopped" (moved, and stands now) or "occluded" (moved, and is out of sight). What was
    only ever seen to stand is not among them.
    """

    def __init__(
        self,
        config: TrackerConfig = TrackerConfig(),
        range_error: float = 0.0,
        heading_error: float = 0.0,
    ) -> None:
        self.config = config
        self._rows = np.zeros((0, kernels.COLUMNS))
        self._stamp = -math.inf
        self._next_id = 0
        self._past = PastScans(range_error, heading_error)
        self.tracks: tuple[Track, ...] = ()

    def forget(self) -> None:
        """Drops all tracks."""
        self._rows = self._rows[:0]
        self._past.forget()
        self.tracks = ()

    def update(
        self,
        scan: LaserScan,
        sensor: Pose2D,
        points: Points,
        beams: npt.NDArray[np.int64],
        local_map: LocalMap,
        known: Known = NOTHING_KNOWN,
    ) -> npt.NDArray[np.bool_]:
        """Takes in one scan before the local map does; returns which ``points`` (n,) move.

        ``points`` (n, 2) are the ends of ``beams`` (n,) in the map frame. What is found to move is
        erased from the local map, back to where it was first seen or last stood.
        """
        config, now = self.config, max(scan.stamp, self._stamp)
        dt = now - self._stamp if math.isfinite(self._stamp) else 0.0
        self._stamp = now
        step = abs(scan.angle_increment)
        view = Sensor(
            float(sensor.x), float(sensor.y), step, len(scan.ranges), int(scan.full_circle)
        )
        before = self._past.since(-math.inf)
        lately = before._replace(since=now - kernels.MISSED)
        kernels.predict(self._rows, dt)
        discs = kernels.expected_discs(self._rows, now)
        owned = detection.find_owners(points, view, known, before, discs)
        groups = detection.find_groups(points, beams, view, owned, discs, config.widest)
        taken = kernels.associate(self._rows, groups, now)
        kernels.correct(self._rows, groups, points, view, now)
        kernels.hide(self._rows, dt, now, lately, config.occluded_time)
        for row in self._rows[kernels.judge(self._rows, now, lately, config.fastest)]:
            self._erase(row, local_map)
        moving = kernels.points_on(points, owned[0], self._rows, groups)
        kept = self._rows[self._rows[:, kernels.T_STATE] != kernels.LOST]
        new = groups[~taken & (groups[:, detection.G_TRACK] < 0.0)]
        self._rows = np.vstack([kept, self._born(new, now)]) if len(new) else kept
        self.tracks = tuple(self._listed())
        self._past.add(scan, sensor)
        return moving

    def _born(self, groups: npt.NDArray[np.float64], now: float) -> npt.NDArray[np.float64]:
        born = np.zeros((len(groups), kernels.COLUMNS))
        born[:, [kernels.T_X, kernels.T_Y]] = groups[:, [detection.G_X, detection.G_Y]]
        born[:, [kernels.T_X0, kernels.T_Y0]] = groups[:, [detection.G_X, detection.G_Y]]
        born[:, kernels.T_RADIUS] = groups[:, detection.G_RADIUS]
        born[:, kernels.T_FREE] = groups[:, detection.G_FREE]
        hidden = groups[:, [detection.G_HIDDEN_FIRST, detection.G_HIDDEN_LAST]]
        born[:, kernels.T_ENDS] = hidden @ (1.0, 2.0)
        born[:, kernels.T_PP] = kernels.ERROR**2
        born[:, kernels.T_VV] = kernels.NEW_SPEED**2
        born[:, [kernels.T_BORN, kernels.T_SEEN, kernels.T_MOVED]] = now
        born[:, kernels.T_ID] = np.arange(self._next_id, self._next_id + len(groups))
        self._next_id += len(groups)
        return born

    def _listed(self) -> list[Track]:
        now, rows = self._stamp, self._rows
        known = rows[:, kernels.T_STATE] != kernels.TENTATIVE
        speed = np.hypot(rows[:, kernels.T_VX], rows[:, kernels.T_VY])
        unsure = kernels.SURE * np.sqrt(rows[:, kernels.T_VV])
        fast = speed > np.maximum(kernels.REST_SPEED, unsure)
        listed = []
        for row in rows[known | fast].tolist():
            x, y, vx, vy = row[kernels.T_X : kernels.T_VY + 1]
            unseen = now - row[kernels.T_SEEN]
            state: TrackState = "tentative"
            if row[kernels.T_STATE] != kernels.TENTATIVE:
                state = "confirmed" if row[kernels.T_STATE] == kernels.CONFIRMED else "stopped"
                state = "occluded" if unseen > kernels.MISSED else state
            still = 0.0 if math.hypot(vx, vy) > kernels.REST_SPEED else now - row[kernels.T_MOVED]
            sds = math.sqrt(row[kernels.T_PP]), math.sqrt(row[kernels.T_VV])
            shape = x, y, vx, vy, row[kernels.T_RADIUS], *sds
            age = now - row[kernels.T_BORN]
            listed.append(Track(int(row[kernels.T_ID]), *shape, state, age, unseen, still))
        return listed

    @staticmethod
    def _erase(row: npt.NDArray[np.float64], local_map: LocalMap) -> None:
        x0, y0, x, y = row[[kernels.T_X0, kernels.T_Y0, kernels.T_X, kernels.T_Y]]
        for fraction in np.linspace(0.0, 1.0, 2 + int(math.hypot(x - x0, y - y0) / 0.1)):
            at = (x0 + fraction * (x - x0), y0 + fraction * (y - y0))
            local_map.erase(*at, row[kernels.T_RADIUS] + kernels.MARGIN)
