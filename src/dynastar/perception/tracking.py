"""Tracking: which of the obstacles that scans show move, and how."""

import math
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, self_checking
from dynastar.perception import detection
from dynastar.perception import tracking_kernels as kernels
from dynastar.perception.detection import Known, Records
from dynastar.perception.past_scans import PastScans
from dynastar.perception.placed_scan import PlacedScan

TrackState = Literal["tentative", "confirmed", "stopped", "occluded"]
STATES = "tentative", "confirmed", "stopped"  # of the kernels' tracks that are in sight
Disc = tuple[float, float, float]  # x, y, radius (m)


@self_checking
class TrackerConfig(NamedTuple):
    """Settings of detection and tracking."""

    widest: Annotated[float, Field("largest width of a moving obstacle", "m", 0.1, 5.0)] = 1.4
    fastest: Annotated[float, Field("largest speed of a moving obstacle", "m/s", 0.1, 50.0)] = 3.0


class MovingObstacle(NamedTuple):
    """A disc that moves, in the map frame: centre (m), velocity (m/s), radius (m)."""

    x: float
    y: float
    vx: float
    vy: float
    radius: float


class Track(NamedTuple):
    """A disc followed over time, in the map frame: centre (m), velocity (m/s), radius (m).

    ``position_sd`` (m) and ``velocity_sd`` (m/s) are standard deviations along each axis. ``age`` and
    ``unseen`` are the seconds since it was first and last seen, ``still`` those that it has been at rest.
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

    def __repr__(self) -> str:
        at = f"({self.x:.2f}, {self.y:.2f}) m, ({self.vx:.2f}, {self.vy:.2f}) m/s"
        return f"<Track {self.id}: {self.state}, {at}, radius {self.radius:.2f} m, age {self.age:.1f} s>"


class Tracker:
    """Tracks obstacles from scan to scan, and finds out which of them move.

    ``tracks``, as of the last scan, are "tentative" (seems to move, not yet for certain), "confirmed"
    (moves), "stopped" (moved, and is at rest now) or "occluded" (moved, and is out of sight). Obstacles
    that were at rest whenever they were seen are not listed.
    """

    def __init__(self, config: TrackerConfig = TrackerConfig()) -> None:
        self.config = config
        self._stamp, self._next_id = -math.inf, 0
        self.forget()

    def forget(self) -> None:
        """Drop all tracks and past scans."""
        self.tracks: tuple[Track, ...] = ()
        self._records = np.zeros(0, kernels.TRACK)
        self._past = PastScans()

    def update(self, scan: PlacedScan, known: Known) -> tuple[npt.NDArray[np.bool_], list[Disc]]:
        """Update the tracks with one scan. Returns what of it moves, and what to erase from a map.

        That is which of the scan's points (k,) lie on a moving obstacle, and the discs where obstacles
        just found to move have been since they were first seen or last at rest.
        """
        config, tracks, now = self.config, self._records, max(scan.sensor.stamp, self._stamp)
        dt = now - self._stamp if math.isfinite(self._stamp) else 0.0
        self._stamp = now
        sensor, space = scan.sensor._replace(stamp=now), self._past.space()
        kernels.predict(tracks, dt, now)
        groups, points = detection.find_groups(
            detection.points_of(scan), sensor, known, space, tracks, config.widest
        )
        kernels.update(tracks, groups, points, sensor, space, config, dt)
        moving = np.isin(scan.beams, points["beam"][points["moving"]])
        left = [disc for track in tracks[tracks["started"]] for disc in _discs_left(track)]
        self._past.add(scan)
        self._replace_lost(groups[~groups["taken"] & (groups["owner"] == detection.UNOWNED)])
        self.tracks = self._listed()
        return moving, left

    def _replace_lost(self, groups: Records) -> None:
        """Drop the lost tracks, and begin a new one for each of ``groups``."""
        kept = self._records[self._records["state"] != kernels.LOST]
        self._records = np.zeros(len(kept) + len(groups), kernels.TRACK)
        self._records[: len(kept)], new = kept, self._records[len(kept) :]
        for name in ("x", "y", "radius", "inside_x", "inside_y", "hidden", "legs"):
            new[name] = groups[name]
        new["start_x"], new["start_y"] = groups["x"], groups["y"]
        new["var_x"] = np.where(groups["legs"], kernels.LEGS_ERROR, kernels.ERROR) ** 2
        new["var_v"] = kernels.NEW_SPEED**2
        new["born"] = new["seen"] = new["moved"] = self._stamp
        new["id"] = self._next_id + np.arange(len(new))
        self._next_id += len(new)

    def _listed(self) -> tuple[Track, ...]:
        tracks, now = self._records, self._stamp
        speed, unsure = np.hypot(tracks["vx"], tracks["vy"]), np.sqrt(tracks["var_v"])
        fast = speed > np.maximum(kernels.REST_SPEED, kernels.SURE * unsure)
        shown = fast | (tracks["state"] != kernels.TENTATIVE)
        tracks, speed = tracks[shown], speed[shown]
        states, unseen = np.array(STATES)[tracks["state"]], now - tracks["seen"]
        states[(tracks["state"] != kernels.TENTATIVE) & (unseen > kernels.MISSED)] = "occluded"
        still = np.where(speed > kernels.REST_SPEED, 0.0, now - tracks["moved"])
        columns = [tracks[name] for name in ("id", "x", "y", "vx", "vy", "radius")]
        columns += [np.sqrt(tracks["var_x"]), np.sqrt(tracks["var_v"])]
        columns += [states, now - tracks["born"], unseen, still]
        return tuple(map(Track, *(column.tolist() for column in columns)))


def _discs_left(track: Any) -> list[Disc]:
    """The discs, 0.1 m apart, that a track has passed since it was first seen or last at rest."""
    x, y, radius = track["start_x"], track["start_y"], track["radius"] + kernels.MARGIN
    dx, dy = track["x"] - x, track["y"] - y
    parts = np.linspace(0.0, 1.0, 2 + int(math.hypot(dx, dy) / 0.1))
    return [(float(x + part * dx), float(y + part * dy), float(radius)) for part in parts]
