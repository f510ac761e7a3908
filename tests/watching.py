"""A sensor that looks at discs, with its own local map and tracker."""

import math

import numpy as np

from dynastar.geometry import Pose2D, compose
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.perception.detection import Known
from dynastar.perception.local_map import LocalMap
from dynastar.perception.placed_scan import placed
from dynastar.perception.tracking import Tracker
from dynastar.robot import Lidar
from dynastar.simulation.lidar import LidarSimulator

ROUND = Lidar(720, math.tau, 0.05, 8.0)
HERE = Pose2D(0.0, 0.0, 0.0)
OPEN = OccupancyGrid.from_occupied(np.zeros((40, 40), bool), 1.0, -20.0, -20.0)
NOTHING_KNOWN = Known(np.zeros((1, 1), bool), GridFrame(1.0))
PILLAR = (2.0, 0.0, 0.5)  # hides about 2 m at x = 4


class Watcher:
    """A sensor with its own local map and tracker, which looks at discs (x, y, radius)."""

    def __init__(self, lidar=ROUND, bound=0.01, seed=1, polygons=(), known=NOTHING_KNOWN):
        random = np.random.default_rng(seed)
        self.lidar = LidarSimulator(lidar, OPEN, polygons, bound, random)
        self.local_map, self.tracker, self.known = LocalMap(), Tracker(), known
        self.ever = set()

    def look(self, t, discs, pose=HERE, lidar=None):
        lidar = lidar or self.lidar
        scan = lidar.scan(pose, t, np.array(discs, float).reshape(-1, 3))
        view = placed(scan, compose(pose, scan.mount), (0.02, 0.0), 0.1)
        self.local_map.follow(pose.x, pose.y)
        moving, left = self.tracker.update(view, self.known)
        for disc in left:
            self.local_map.erase(disc)
        self.local_map.see(view, moving)
        self.local_map.update(t, np.zeros_like(self.local_map.states, bool))
        for track in self.confirmed:
            self.ever.add(track.id)
        return view.points, moving

    def watch(self, discs_at, seconds, pose_at=lambda t: HERE, rate=20.0):
        for k in range(round(seconds * rate) + 1):
            _, moving = self.look(k / rate, discs_at(k / rate), pose_at(k / rate))
        return moving

    @property
    def confirmed(self):
        return [t for t in self.tracker.tracks if t.state == "confirmed"]

    def of(self, *states):
        return [t for t in self.tracker.tracks if t.state in states]
