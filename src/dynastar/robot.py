"""The robot: what it may do, what room it takes, and how it moves (section IV.A, Eq. 4, Fig. 4)."""

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import Field, nearest, self_checking, shown, summary
from dynastar.errors import ConfigError, UnknownRobot
from dynastar.footprint import Footprint, box
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

    beams: Annotated[int, Field("readings in a scan", "", 2, 20000)] = 360
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


@dataclass(frozen=True)
class Robot:
    """A differential-drive robot: its limits, its footprint and the lidar it carries.

    ``Robot.simple`` is enough to begin with. Raises ConfigError for a robot that could not drive or see.
    """

    name: str
    limits: Limits
    footprint: Footprint
    lidar: Lidar = Lidar()

    def __post_init__(self) -> None:
        limits, lidar = self.limits, self.lidar
        for what, value, kind in (
            ("name", self.name, str),
            ("limits", limits, Limits),
            ("footprint", self.footprint, Footprint),
            ("lidar", lidar, Lidar),
        ):
            if not isinstance(value, kind):
                hint = ", as Footprint.disc(0.2)" if kind is Footprint else ""
                raise ConfigError(
                    f"a robot's {what}: got {shown(value)}, expected {kind.__name__}{hint}"
                )
        if lidar.range_min >= lidar.range_max:
            raise ConfigError(
                f"range_min is {lidar.range_min:g} m: expected less than range_max, {lidar.range_max:g} m"
            )
        for name, least, most, unit in (
            ("v", limits.v_least, limits.v_max, "m/s"),
            ("omega", limits.omega_least, limits.omega_max, "rad/s"),
        ):
            if least > most:
                raise ConfigError(
                    f"{name}_least is {least:g} {unit}: expected at most {name}_max, {most:g} {unit}"
                )

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
