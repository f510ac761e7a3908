"""Who may come out of hiding, or has just: slow enough where a lane leads from there onto the path."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.dwa.manoeuvre_kernels import SURE
from dynastar.navigator import lookout_kernels
from dynastar.navigator.chart import Chart
from dynastar.navigator.config import NavigatorConfig
from dynastar.obstacles import ObstacleLayer, Tracker
from dynastar.obstacles.tracker_kernels import HALF_SEEN, UNSEEN
from dynastar.path import Path
from dynastar.robot import Robot

Floats = npt.NDArray[np.float64]
AHEAD = 3.0  # m of the path onto which somebody may come
FURTHER = 3.0  # m of the path that the robot may go on
EVERY = 0.1  # m between the points that they may come onto
SPACING = 0.1  # m between the path's points
RADIUS = HALF_SEEN  # m, of somebody
COME = 1.2  # m that they have come straight to where they are hidden
NEAR = 3.0  # m from the path, beyond which there is time enough
REACTION = 0.4  # s until they are known to move
CANDIDATES = 7  # speeds
SLOW = 0.2  # m/s, slower than which the robot goes for nobody that it does not see


class View(NamedTuple):
    """What is known of the cells (n, n) round the robot, their low corner and size.

    ``free_at`` s when each was last seen free, ``since`` s after which it counts; ``solid`` where the
    map or a scan shows something.
    """

    free_at: Floats
    solid: npt.NDArray[np.bool_]
    x0: float
    y0: float
    resolution: float
    since: float


class Lookout:
    """Keeps a robot slow enough to stop for somebody who steps out, or fast enough to be past."""

    def __init__(self, robot: Robot, config: NavigatorConfig) -> None:
        self.limits, self.pace = robot.limits, config.hidden_speed
        self.look = NEAR / self.pace if self.pace > 0.0 else 0.0  # s until whoever is near has come
        self.reaction = REACTION + config.latency
        self.apart = robot.footprint.circumscribed + RADIUS
        # As much as commands will need to go on, once they are seen.
        self.spare = config.mover_margin + SURE * config.mover_error

    def speed(
        self,
        now: float,
        v: float,
        top: float,
        path: Path,
        s: float,
        layer: ObstacleLayer,
        chart: Chart,
        tracker: Tracker,
    ) -> float:
        """The speed (m/s) to go at, near the present ``v`` and up to ``top``, ``s`` metres along a path.

        From it the robot can stop before whoever comes straight out of hiding, and back out of their
        way if it can back, or go on and be past; so it can for who has just come into view and may be
        walking or not. Nobody comes through what is known to move, which the window deals with. If
        there is no such speed near ``v`` it is the lowest; for who cannot be seen, never less than
        ``SLOW``.
        """
        if self.pace == 0.0:
            return top
        view = View(
            layer.free_at,
            chart.blocked_under(layer),
            *layer.origin,
            layer.config.resolution,
            now - UNSEEN,
        )
        points = path.paced(s, s + AHEAD + FURTHER, SPACING)
        onto = points[: round(AHEAD / SPACING) + 1 : round(EVERY / SPACING)]
        onto = np.ascontiguousarray(onto)
        lookout_kernels.shut_discs(tracker.in_sight(), view)
        hidden = lookout_kernels.lanes(onto, view, RADIUS, COME, NEAR)
        speed = self._careful(hidden, points, v, top, min(SLOW, top), COME)
        newcomers = chart.on_free_ground(tracker.newcomers())
        if len(newcomers):
            come = lookout_kernels.lanes_of(newcomers, onto, view, RADIUS, NEAR)
            speed = min(speed, self._careful(come, points, v, top, 0.0, 0.0))
        return speed

    def _careful(
        self, lanes: Floats, points: Floats, v: float, top: float, least: float, tail: float
    ) -> float:
        """The speed, from ``least`` to ``top`` and near the present ``v``, for who comes by ``lanes``."""
        accel = self.limits.v_accel
        high, low = min(v + accel, top), max(v - 0.5 * accel, least)  # within a second
        return float(
            lookout_kernels.careful(
                lanes,
                points,
                SPACING,
                v,
                np.linspace(max(high, low), low, CANDIDATES),
                -min(self.limits.v_min, 0.0),
                top,
                self.apart,
                self.spare,
                (self.limits.v_brake, accel),
                self.reaction,
                tail,
                self.pace,
                self.look,
            )
        )
