"""Poses and twists in the plane (REP 103: metres, radians, x ahead, counter-clockwise positive)."""

import math
from typing import NamedTuple


class Pose2D(NamedTuple):
    """A position in metres and a heading in radians."""

    x: float
    y: float
    theta: float = 0.0


class Twist(NamedTuple):
    """A forward speed in m/s and a turning rate in rad/s."""

    v: float
    omega: float


class Goal(NamedTuple):
    """A place to reach in metres, with a heading in radians if that matters."""

    x: float
    y: float
    heading: float | None = None


def wrap_angle(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped == -math.pi else wrapped


def compose(a: Pose2D, b: Pose2D) -> Pose2D:
    """Pose ``b``, given in the frame ``a``, in the frame that ``a`` is given in."""
    cos, sin = math.cos(a.theta), math.sin(a.theta)
    return Pose2D(
        a.x + cos * b.x - sin * b.y, a.y + sin * b.x + cos * b.y, wrap_angle(a.theta + b.theta)
    )


def inverse(a: Pose2D) -> Pose2D:
    """The pose with ``compose(a, inverse(a))`` the identity."""
    cos, sin = math.cos(a.theta), math.sin(a.theta)
    return Pose2D(-cos * a.x - sin * a.y, sin * a.x - cos * a.y, wrap_angle(-a.theta))


def interpolate(a: Pose2D, b: Pose2D, share: float) -> Pose2D:
    """The pose at ``share`` of the way from ``a`` (0) to ``b`` (1), turning the short way round."""
    return Pose2D(
        a.x + share * (b.x - a.x),
        a.y + share * (b.y - a.y),
        wrap_angle(a.theta + share * wrap_angle(b.theta - a.theta)),
    )
