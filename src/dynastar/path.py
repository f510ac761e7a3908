"""Paths and trajectories: what is planned and what was driven."""

from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from dynastar.config import counted, shown, summary
from dynastar.errors import InputError

Floats = npt.NDArray[np.float64]

TURN_TOLERANCE = 0.25  # m, of the Douglas-Peucker simplification before bends are counted
TURN_ANGLE = np.radians(10.0)  # bends up to this are none


def turning_points(points: npt.ArrayLike) -> int:
    """Bends over 10 degrees of an (n, 2) polyline simplified by Douglas-Peucker at 0.25 m."""
    return len(bends(points))


def bends(points: npt.ArrayLike) -> Floats:
    """Where (k, 2) the ``turning_points`` of an (n, 2) polyline are."""
    line = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    if len(line) < 3:
        return np.empty((0, 2))
    origin = line[0]
    kept = cv2.approxPolyDP((line - origin).astype(np.float32), TURN_TOLERANCE, False)
    corners = kept.reshape(-1, 2).astype(np.float64)
    steps = np.diff(corners, axis=0)
    moved = np.hypot(steps[:, 0], steps[:, 1]) > 1e-6
    steps, begins = steps[moved], corners[:-1][moved]
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turned = np.abs((np.diff(headings) + np.pi) % (2 * np.pi) - np.pi)
    return np.asarray(begins[1:][turned > TURN_ANGLE] + origin, dtype=np.float64)


def ends_of(points: Floats) -> str:
    """In words, from where to where a polyline (n, 2 or more) leads; nothing for none."""
    if len(points) == 0:
        return ""
    (x, y), (to_x, to_y) = points[[0, -1], :2]
    return f"from ({x:.2f}, {y:.2f}) to ({to_x:.2f}, {to_y:.2f}) m"


@dataclass(frozen=True, eq=False)
class Path:
    """A polyline in the map frame: ``points`` (n >= 1, 2) in metres, ``arc`` (n,) the length so far.

    Raises InputError for points of another shape or not finite.
    """

    points: Floats
    arc: Floats = field(init=False)

    def __post_init__(self) -> None:
        try:
            points = np.array(self.points, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise InputError(
                f"a path is {shown(self.points)}: expected points (x, y), numbers in metres"
            ) from None
        if points.ndim != 2 or points.shape[1] != 2 or len(points) == 0:
            raise InputError(f"a path has shape {points.shape}: expected (n >= 1, 2), in metres")
        if not np.isfinite(points).all():
            raise InputError("a path has a point that is not finite")
        steps = np.diff(points, axis=0)
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])
        for name, array in (("points", points), ("arc", arc)):
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    def __repr__(self) -> str:
        points, turns = counted(len(self.points), "point"), counted(self.turns, "turning point")
        return summary(self, f"{self.length:.2f} m", points, turns, ends_of(self.points))

    @property
    def length(self) -> float:
        """Length in metres."""
        return float(self.arc[-1])

    @property
    def turns(self) -> int:
        """Turning points, see ``turning_points``."""
        return turning_points(self.points)

    def at(self, s: float) -> tuple[float, float]:
        """The point (x, y) ``s`` metres along the path, clamped to its ends."""
        return (
            float(np.interp(s, self.arc, self.points[:, 0])),
            float(np.interp(s, self.arc, self.points[:, 1])),
        )

    def resampled(self, start: float, stop: float, spacing: float) -> Floats:
        """Points (m >= 2, 2) every ``spacing`` metres or less from ``start`` to ``stop`` metres along."""
        stop = min(max(stop, start), self.length)
        count = max(2, int(np.ceil((stop - start) / spacing)) + 1)
        return self._at(np.linspace(min(start, stop), stop, count))

    def part(self, start: float, stop: float) -> Floats:
        """The points (m >= 2, 2) at ``start`` and ``stop`` metres along, and those between them."""
        between = self.points[(start < self.arc) & (self.arc < stop)]
        return np.vstack([self.at(start), between, self.at(stop)])

    def paced(self, start: float, stop: float, spacing: float) -> Floats:
        """Points (m >= 2, 2) exactly ``spacing`` metres apart along, but for the last, at the end."""
        stop = min(max(stop, start), self.length)
        count = max(2, int(np.ceil((stop - start) / spacing - 1e-9)) + 1)
        return self._at(np.minimum(start + spacing * np.arange(count), stop))

    def _at(self, s: Floats) -> Floats:
        found = np.empty((len(s), 2))
        for axis in (0, 1):
            found[:, axis] = np.interp(s, self.arc, self.points[:, axis])
        return found

    def project(self, x: float, y: float, low: float = 0.0, high: float = np.inf) -> float:
        """Metres along the path of its point nearest to (x, y), looked for from ``low`` to ``high``."""
        if len(self.points) == 1:
            return 0.0
        first = min(max(low, 0.0), self.length)
        last = min(max(high, first), self.length)
        i = max(int(np.searchsorted(self.arc, first - 1e-9)) - 1, 0)
        j = int(np.searchsorted(self.arc, last + 1e-9)) + 1  # the segments that are looked at
        points, arc = self.points[i:j], self.arc[i:j]
        a, begin, end = points[:-1], arc[:-1], arc[1:]
        step, length = points[1:] - a, np.maximum(end - begin, 1e-12)
        rel = np.array((x, y)) - a
        along = (rel[:, 0] * step[:, 0] + rel[:, 1] * step[:, 1]) / length
        low_s, high_s = np.maximum(begin, first), np.minimum(end, last)
        s = np.minimum(np.maximum(begin + along, low_s), high_s)
        off = rel - step * ((s - begin) / length)[:, None]
        return float(s[np.argmin(off[:, 0] * off[:, 0] + off[:, 1] * off[:, 1])])


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A driven trajectory: ``times`` (n,) s, ``poses`` (n, 3) m and rad, ``twists`` (n, 2) m/s, rad/s."""

    times: Floats
    poses: Floats
    twists: Floats

    def __repr__(self) -> str:
        if len(self.times) == 0:
            return summary(self, "no poses")
        steps = np.diff(self.poses[:, :2], axis=0)
        length, seconds = np.nansum(np.hypot(*steps.T)), self.times[-1] - self.times[0]
        poses = counted(len(self.poses), "pose")
        return summary(self, f"{length:.2f} m in {seconds:.1f} s", poses, ends_of(self.poses))

    @property
    def path(self) -> Path:
        """The positions alone."""
        return Path(self.poses[:, :2])

    @property
    def length(self) -> float:
        """Driven length in metres."""
        return self.path.length
