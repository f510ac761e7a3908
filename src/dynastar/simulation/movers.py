"""Things that move by a script: keyframes, whatever happens around them."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dynastar.config import nearest
from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D
from dynastar.simulation import movers_kernels as kernels
from dynastar.simulation.scenario import Mover

Floats = npt.NDArray[np.float64]

AFTER = {
    "loop": kernels.LOOP,
    "back_and_forth": kernels.BACK_AND_FORTH,
    "stay": kernels.STAY,
    "vanish": kernels.VANISH,
}


class Movers:
    """All movers of a world at once; ``radii`` is (m,) metres.

    Raises ScenarioError for keyframes or radii that cannot be followed.
    """

    def __init__(self, movers: Sequence[Mover]) -> None:
        for number, mover in enumerate(movers):
            _check(mover, f"mover {number}")
        self.radii = np.array([mover.radius for mover in movers], dtype=np.float64)
        self._firsts = np.cumsum([0, *(len(mover.times) for mover in movers)], dtype=np.int64)
        self._times = np.concatenate([np.empty(0), *(np.asarray(m.times, float) for m in movers)])
        self._points = np.concatenate(
            [np.empty((0, 2)), *(np.asarray(m.points, float) for m in movers)]
        )
        self._after = np.array([AFTER[mover.after] for mover in movers], dtype=np.int64)

    def at(self, time: float) -> Floats:
        """Centres (m, 2) in metres at ``time`` (s); NaN for a mover that is not there."""
        out = np.empty((len(self.radii), 2))
        if len(out):
            kernels.positions(time, self._firsts, self._times, self._points, self._after, out)
        return out

    def gap(self, time: float, pose: Pose2D, footprint: Footprint) -> float:
        """Metres from the footprint at ``pose`` to a mover; inf without any, <= 0 touching."""
        return gap_to_discs(pose, footprint, self.at(time), self.radii)


def gap_to_discs(pose: Pose2D, footprint: Footprint, centres: Floats, radii: Floats) -> float:
    """Metres from the footprint at ``pose`` to discs (m, 2) with radii (m,); inf without any."""
    if len(radii) == 0:
        return math.inf
    return kernels.disc_gap(
        pose.x,
        pose.y,
        pose.theta,
        footprint.vertices,
        footprint.circumscribed,
        centres,
        radii,
    )


def _check(mover: Mover, what: str) -> None:
    times, points = np.asarray(mover.times, float), np.asarray(mover.points, float)
    if times.ndim != 1 or len(times) == 0 or points.shape != (len(times), 2):
        raise ScenarioError(
            f"{what} has times of shape {times.shape} and points of shape {points.shape}: "
            "expected (k,) and (k, 2), k >= 1"
        )
    if not (np.isfinite(times).all() and np.isfinite(points).all()):
        raise ScenarioError(f"{what} has a time or a point that is not finite")
    if not (np.diff(times) > 0.0).all():
        raise ScenarioError(f"{what} has times that do not rise from key to key")
    if not (np.isfinite(mover.radius) and mover.radius > 0.0):
        raise ScenarioError(f"{what} has a radius of {mover.radius} m: expected more than 0")
    if mover.after not in AFTER:
        raise ScenarioError(
            f"{what} does {mover.after!r} after its last key{nearest(mover.after, AFTER)}"
        )
