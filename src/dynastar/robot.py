"""The robot: what it may do, what room it takes, and how it moves (section IV.A, Eq. 4, Fig. 4)."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, nearest, self_checking, summary
from dynastar.errors import ConfigError, DynastarWarning, UnknownRobot
from dynastar.geometry import Pose2D, Twist, wrap_angle


@self_checking
class Limits(NamedTuple):
    """Limits of the drive; ``v_min`` is negative for a robot that may reverse."""

    v_max: Annotated[float, Field("largest forward speed", "m/s", 0.01, 20.0)]
    omega_max: Annotated[float, Field("largest turning rate, either way", "rad/s", 0.01, 20.0)]
    v_accel: Annotated[float, Field("largest acceleration", "m/s2", 0.01, 100.0)]
    omega_accel: Annotated[float, Field("largest angular acceleration", "rad/s2", 0.01, 200.0)]
    v_brake: Annotated[float, Field("largest deceleration", "m/s2", 0.01, 100.0)]
    omega_brake: Annotated[float, Field("largest angular deceleration", "rad/s2", 0.01, 200.0)]
    v_min: Annotated[float, Field("smallest speed, negative to reverse", "m/s", -20.0, 0.0)] = 0.0
    v_least: Annotated[
        float, Field("speed below which the drive does not move, either way", "m/s", 0.0, 5.0)
    ] = 0.0
    omega_least: Annotated[
        float, Field("turning rate below which the drive does not turn", "rad/s", 0.0, 5.0)
    ] = 0.0


@self_checking
class Lidar(NamedTuple):
    """A planar lidar as mounted on the robot.

    ``nothing`` are the values that the driver writes for "no return", besides +inf and range_max.
    """

    beams: Annotated[int, Field("readings in a scan", "", 1, 20000)] = 360
    fov: Annotated[float, Field("angle from the first beam to the last", "rad", 0.01, math.tau)] = (
        math.tau
    )
    range_min: Annotated[float, Field("smallest range that is measured", "m", 0.0, 10.0)] = 0.0
    range_max: Annotated[float, Field("largest range that is measured", "m", 0.1, 200.0)] = 5.0
    x: Annotated[float, Field("mount, forward of the base", "m", -5.0, 5.0)] = 0.0
    y: Annotated[float, Field("mount, left of the base", "m", -5.0, 5.0)] = 0.0
    theta: Annotated[float, Field("mount, direction of the middle", "rad", -math.tau, math.tau)] = (
        0.0
    )
    nothing: Annotated[
        tuple[float, ...],
        Field("readings that mean no return, as 0, nan or 65.5", "m", nan_is_legal=True),
    ] = ()

    @property
    def increment(self) -> float:
        """Angle between neighbouring beams, rad; a full circle does not repeat its first beam."""
        if self.fov > math.tau - 1e-6:
            return math.tau / self.beams
        return self.fov / max(self.beams - 1, 1)

    @property
    def mount(self) -> Pose2D:
        """Pose of the sensor on the robot."""
        return Pose2D(self.x, self.y, self.theta)


LARGE = 5.0  # m, the radius above which a footprint is perhaps not in metres
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
        if not (math.isfinite(radius) and radius >= 0.0):
            raise ConfigError(f"a footprint's radius is {radius}: expected 0 m or more")
        return Footprint(_readonly(np.empty((0, 2))), float(radius), float(radius))

    @staticmethod
    def polygon(vertices: Sequence[Sequence[float]]) -> "Footprint":
        """A convex polygon (n >= 3 vertices, metres) that contains the centre of rotation."""
        points = np.array(vertices, dtype=np.float64)
        if points.ndim != 2 or points.shape[0] < 3 or points.shape[1] != 2:
            raise ConfigError(f"a footprint polygon has shape {points.shape}: expected (n >= 3, 2)")
        if not np.isfinite(points).all():
            raise ConfigError("a footprint polygon has a vertex that is not finite")
        edges = np.roll(points, -1, axis=0) - points
        turns = _cross(edges, np.roll(edges, -1, axis=0))
        if (turns < 0).all():
            points = points[::-1].copy()
            edges = np.roll(points, -1, axis=0) - points
        elif not (turns > 0).all():
            raise ConfigError("a footprint polygon is not convex: give its corners in order")
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

    def covers(self, points: npt.NDArray[np.float64], margin: float) -> npt.NDArray[np.bool_]:
        """Whether points (n, 2) lie within the footprint, each side moved out by ``margin`` (m)."""
        inside = np.hypot(points[:, 0], points[:, 1]) <= self.circumscribed + margin
        for corner, after in zip(self.vertices, np.roll(self.vertices, -1, axis=0), strict=True):
            (dx, dy), (x, y) = after - corner, (points - corner).T
            inside &= dx * y - dy * x >= -margin * math.hypot(dx, dy)
        return np.asarray(inside)

    @property
    def is_disc(self) -> bool:
        """Whether the footprint is a disc."""
        return len(self.vertices) == 0


def _cross(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _readonly(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    array = np.ascontiguousarray(array, dtype=np.float64)
    array.flags.writeable = False
    return array


@dataclass(frozen=True)
class Robot:
    """A differential-drive robot: its limits, its footprint and the lidar it carries.

    ``Robot.simple`` is enough to begin with.
    """

    name: str
    limits: Limits
    footprint: Footprint
    lidar: Lidar = Lidar()

    def __repr__(self) -> str:
        limits, lidar = self.limits, self.lidar
        return summary(
            self,
            f"{self.name!r:.80}",
            f"{limits.v_min:g} to {limits.v_max:g} m/s, {limits.omega_max:g} rad/s",
            f"brakes at {limits.v_brake:g} m/s2",
            self.footprint.words(),
            f"lidar of {lidar.beams} beams to {lidar.range_max:g} m",
        )

    @staticmethod
    def simple(radius: float, v_max: float, name: str = "simple") -> "Robot":
        """A disc of ``radius`` (m) that drives ``v_max`` (m/s) at most, with usual values for the rest.

        It takes 1 s to reach ``v_max`` and 1 s to stop from it, reverses at a quarter of ``v_max``,
        turns at 1.5 rad/s at most, and takes 0.5 s to reach and to leave that. Its lidar has 360
        beams all round, at the centre, up to 10 m. The no-contact guarantee needs the true braking
        limits: declare measured ones before a real robot drives.
        """
        limits = Limits(v_max, 1.5, v_max, 3.0, v_max, 3.0, v_min=-0.25 * v_max)
        return Robot(name, limits, Footprint.disc(radius), Lidar(range_max=10.0))


def box(length: float, width: float) -> Footprint:
    """A rectangular footprint, ``length`` along x and ``width`` along y, in metres, centred."""
    x, y = length / 2, width / 2
    return Footprint.polygon([(x, -y), (x, y), (-x, y), (-x, -y)])


class Robots(dict[str, Robot]):
    """Robots by name; a wrong name raises UnknownRobot, which names the nearest right one."""

    def __missing__(self, name: object) -> Robot:
        raise UnknownRobot(f"unknown robot '{name!s:.80}'{nearest(str(name), self)}")

    def __repr__(self) -> str:
        return summary(self, *self)


ROBOTS = Robots(
    {
        # Table II; braking is not printed, so as accelerating, nor is v_min: the preset paper takes 0.
        "paper": Robot(
            "paper",
            Limits(1.5, 0.5, 0.2, 0.3, 0.2, 0.3, v_min=-0.5),
            Footprint.disc(0.3),
            Lidar(360, math.tau),
        ),
        # [Robotis]: 0.22 m/s and 2.84 rad/s; LDS-01, 360 beams, 0.12 to 3.5 m, 32 mm behind the axle.
        "turtlebot3_burger": Robot(
            "turtlebot3_burger",
            Limits(0.22, 2.84, 2.5, 3.2, 2.5, 3.2, v_min=-0.22),
            Footprint.disc(0.105),
            Lidar(360, math.tau, 0.12, 3.5, x=-0.032),
        ),
        # [BARN]: 0.508 x 0.430 m, 2 m/s, 4 rad/s, 720 beams over 270 degrees.
        "jackal": Robot(
            "jackal",
            Limits(2.0, 4.0, 20.0, 25.0, 20.0, 25.0, v_min=-0.5),
            box(0.508, 0.430),
            Lidar(720, math.radians(270.0), 0.1, 30.0, x=0.12),
        ),
        # [MRPB]: radius 0.25 m, 0.55 m/s, 1 rad/s, 2.5 m/s2, 3.2 rad/s2.
        "pioneer3dx": Robot(
            "pioneer3dx",
            Limits(0.55, 1.0, 2.5, 3.2, 2.5, 3.2, v_min=-0.2),
            Footprint.disc(0.25),
            Lidar(720, math.tau, 0.05, 10.0),
        ),
    }
)


def arc(pose: Pose2D, twist: Twist, duration: float) -> Pose2D:
    """Where ``pose`` is after ``duration`` seconds at a constant ``twist``: Eq. 4, integrated exactly.

    The chord of the arc has length v t sinc(omega t / 2) and points half the turn ahead.
    """
    half = 0.5 * twist.omega * duration
    sinc = math.sin(half) / half if abs(half) > 1e-9 else 1.0
    chord = twist.v * duration * sinc
    return Pose2D(
        pose.x + chord * math.cos(pose.theta + half),
        pose.y + chord * math.sin(pose.theta + half),
        wrap_angle(pose.theta + 2.0 * half),
    )


def poses_along(
    pose: Pose2D, twist: Twist, durations: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Poses (n, 3) after each of ``durations`` (n,) seconds at a constant ``twist``, as ``arc``."""
    half = 0.5 * twist.omega * durations
    chord = twist.v * durations * np.sinc(half / math.pi)
    x, y = pose.x + chord * np.cos(pose.theta + half), pose.y + chord * np.sin(pose.theta + half)
    return np.column_stack([x, y, pose.theta + 2.0 * half])


def stopping_time(twist: Twist, limits: Limits) -> float:
    """Seconds until both speeds are zero when they ramp down in proportion (so along one arc)."""
    return max(abs(twist.v) / limits.v_brake, abs(twist.omega) / limits.omega_brake)


def slew(current: float, wanted: float, accel: float, brake: float, duration: float) -> float:
    """One speed after ``duration`` seconds of going from ``current`` to ``wanted``.

    Towards zero it changes at ``brake``, away from zero at ``accel``; through zero it does both.
    """
    if current * wanted < 0.0:
        to_zero = abs(current) / brake
        if to_zero >= duration:
            return current - math.copysign(brake * duration, current)
        return slew(0.0, wanted, accel, brake, duration - to_zero)
    rate = accel if abs(wanted) > abs(current) else brake
    return current + max(-rate * duration, min(rate * duration, wanted - current))
