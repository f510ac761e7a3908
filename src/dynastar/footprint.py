"""The room that a robot takes: a disc or a convex polygon round its centre of rotation."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.config import shown
from dynastar.errors import ConfigError, DynastarWarning

LARGE = 5.0  # m, the radius above which a footprint is perhaps not in metres
FARTHEST = 1e6  # m, a coordinate of a polygon
PIECES = 4  # that a polygon is cut into for its covering discs


@dataclass(frozen=True)
class Footprint:
    """The room the robot takes, round its centre of rotation: a disc, or a convex polygon.

    ``vertices`` is (0, 2) for a disc and (n, 2), counter-clockwise, metres, for a polygon. Warns
    (DynastarWarning) of a footprint that reaches more than 5 m from its centre.
    """

    vertices: npt.NDArray[np.float64]
    circumscribed: float
    inscribed: float

    def __post_init__(self) -> None:
        if self.circumscribed > LARGE:
            words = f"a footprint reaches {self.circumscribed:g} m from its centre: lengths are in metres"
            warnings.warn(words, DynastarWarning, stacklevel=4)

    def __repr__(self) -> str:
        return f"<Footprint: {self.words()}>"

    def words(self) -> str:
        """Its shape and size in words."""
        if self.is_disc:
            return f"disc of radius {self.circumscribed:g} m"
        length, width = np.ptp(self.vertices, axis=0)
        corners = len(self.vertices)
        return f"polygon of {corners} corners, {length:.3g} m long, {width:.3g} m wide"

    @staticmethod
    def disc(radius: float) -> "Footprint":
        """A disc of ``radius`` metres."""
        number = _numbers(radius)
        if number is None or number.shape != () or not 0.0 <= number < math.inf:
            raise ConfigError(f"a footprint's radius is {shown(radius)}: expected 0 m or more")
        return Footprint(_readonly(np.empty((0, 2))), float(number), float(number))

    @staticmethod
    def polygon(vertices: Sequence[Sequence[float]]) -> "Footprint":
        """A convex polygon (n >= 3 vertices, metres) that contains the centre of rotation."""
        points = _numbers(vertices)
        if points is None:
            raise ConfigError(
                f"a footprint polygon is {shown(vertices)}: expected (n >= 3, 2) metres"
            )
        if points.ndim != 2 or points.shape[0] < 3 or points.shape[1] != 2:
            raise ConfigError(f"a footprint polygon has shape {points.shape}: expected (n >= 3, 2)")
        if not (np.abs(points) <= FARTHEST).all():
            raise ConfigError(
                f"a footprint polygon has a vertex that is not finite, or beyond {FARTHEST:g} m: expected "
                "metres from the centre of rotation"
            )
        points = _corners(points)
        edges = np.roll(points, -1, axis=0) - points
        turns = _cross(edges, np.roll(edges, -1, axis=0))
        same = len(points) >= 3 and (np.sign(turns) == np.sign(turns[0])).all()
        if not same or _times_round(edges) != 1:
            raise ConfigError("a footprint polygon is not convex: give its corners in order")
        if turns[0] < 0:
            points = points[::-1].copy()
            edges = np.roll(points, -1, axis=0) - points
        inside = _cross(edges, -points) / np.hypot(edges[:, 0], edges[:, 1])
        if inside.min() < 0:
            raise ConfigError("a footprint polygon does not contain the centre of rotation (0, 0)")
        circumscribed = float(np.hypot(points[:, 0], points[:, 1]).max())
        return Footprint(_readonly(points), circumscribed, float(inside.min()))

    @property
    def half_width(self) -> float:
        """Largest distance (m) of the footprint from the line that it drives along."""
        return self.circumscribed if self.is_disc else float(np.abs(self.vertices[:, 1]).max())

    @property
    def half_gap(self) -> float:
        """Half the width (m) of the narrowest gap that the footprint passes, driving straight."""
        return self.circumscribed if self.is_disc else 0.5 * float(np.ptp(self.vertices[:, 1]))

    @property
    def discs(self) -> npt.NDArray[np.float64]:
        """Discs (k, 3) of centre x, y and radius, metres, that together cover a polygon; (0, 3) of a disc.

        The polygon is cut across its longer side into pieces, and each has its disc.
        """
        if self.is_disc:
            return np.empty((0, 3))
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        axis = int(np.argmax(high - low))
        cuts = np.linspace(low[axis], high[axis], PIECES + 1)
        discs = []
        for begin, end in pairwise(cuts):
            corners = [v for v in self.vertices if begin <= v[axis] <= end]
            for a, b in zip(self.vertices, np.roll(self.vertices, -1, axis=0), strict=True):
                for cut in (begin, end):
                    if min(a[axis], b[axis]) < cut < max(a[axis], b[axis]):
                        corners.append(a + (b - a) * (cut - a[axis]) / (b[axis] - a[axis]))
            piece = np.array(corners)
            centre = 0.5 * (piece.min(axis=0) + piece.max(axis=0))
            discs.append((*centre, np.hypot(*(piece - centre).T).max()))
        return np.array(discs)

    def covers(self, points: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Whether points (n, 2) lie within the footprint."""
        inside = np.hypot(points[:, 0], points[:, 1]) <= self.circumscribed
        for corner, after in zip(self.vertices, np.roll(self.vertices, -1, axis=0), strict=True):
            (dx, dy), (x, y) = after - corner, (points - corner).T
            inside &= dx * y - dy * x >= 0.0
        return np.asarray(inside)

    @property
    def is_disc(self) -> bool:
        """Whether the footprint is a disc."""
        return len(self.vertices) == 0


def box(length: float, width: float) -> Footprint:
    """A rectangular footprint, ``length`` along x and ``width`` along y, in metres, centred."""
    x, y = length / 2, width / 2
    return Footprint.polygon([(x, -y), (x, y), (-x, y), (-x, -y)])


def _numbers(values: Any) -> npt.NDArray[np.float64] | None:
    """What was given as an array of floats; None where it is none."""
    try:
        if not isinstance(values, str):
            return np.array(values, dtype=np.float64)
    except (OverflowError, TypeError, ValueError):
        pass
    return None


def _times_round(edges: npt.NDArray[np.float64]) -> int:
    """How often a ring with these edges (n, 2) goes round; a star does so twice."""
    after = np.roll(edges, -1, axis=0)
    turned = np.arctan2(_cross(edges, after), (edges * after).sum(axis=1))
    return round(abs(float(turned.sum())) / math.tau)


def _corners(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The corners (k, 2) of a ring (n, 2): without points that are repeated or in the middle of a side."""
    points = points[(points != np.roll(points, 1, axis=0)).any(axis=1)]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    scale = np.hypot(*before.T) * np.hypot(*after.T)
    straight = np.abs(_cross(before, after)) <= 1e-9 * scale
    return points[~(straight & ((before * after).sum(axis=1) > 0.0))]


def _cross(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _readonly(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    array = np.ascontiguousarray(array, dtype=np.float64)
    array.flags.writeable = False
    return array
