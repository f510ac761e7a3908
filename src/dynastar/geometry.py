"""Poses and twists in the plane (REP 103: metres, radians, x ahead, counter-clockwise positive)."""

import math
from collections.abc import Iterable
from numbers import Real
from typing import Any, NamedTuple

from dynastar.config import shown
from dynastar.errors import InputError

MOST_HEADING = 7.0  # rad, of a goal: a larger number is likely to be in degrees


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


def as_point(value: Any, what: str) -> tuple[float, float]:
    """(x, y) in metres of a point, a pose or a goal; InputError, which calls it ``what``, for another."""
    numbers = _numbers(value)
    if numbers is None or not 2 <= len(numbers) <= 3:
        raise InputError(f"{what} is {shown(value)}: expected (x, y), two numbers in metres")
    return numbers[0], numbers[1]


def place(x: float, y: float, decimals: int = 3) -> str:
    """A position (m) as messages show it; all digits are kept far from the origin, too."""
    return f"({length(x, decimals)}, {length(y, decimals)})"


def length(metres: float, decimals: int = 6) -> str:
    """Metres as messages show them."""
    return f"{round(metres, decimals) + 0.0:.12g}"


def as_goal(value: Any) -> Goal:
    """A goal from a Goal, a pose or a tuple (x, y) or (x, y, heading); InputError for anything else."""
    numbers = _numbers(value)
    if numbers is None or not 2 <= len(numbers) <= 3:
        raise InputError(
            f"a goal is {shown(value)}: expected (x, y) in metres, or (x, y, heading) in radians"
        )
    x, y = numbers[:2]
    heading = numbers[2] if len(numbers) == 3 else None
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"a goal is ({x}, {y}, {heading}): expected finite numbers")
    if heading is not None and abs(heading) > MOST_HEADING:
        raise InputError(
            f"a goal's heading is {heading:g} rad: expected -7 to 7 "
            f"({heading:g} degrees are {wrap_angle(math.radians(heading)):.4g} rad)"
        )
    return Goal(x, y, heading)


def as_goals(value: Any) -> list[Goal]:
    """The goals of one (see ``as_goal``) or of a sequence of them; InputError for anything else."""
    parts = list(value) if isinstance(value, Iterable) and not isinstance(value, str) else [0.0]
    one = isinstance(value, Goal) or not all(hasattr(part, "__len__") for part in parts)
    return [as_goal(value)] if one else [as_goal(part) for part in parts]


def _numbers(value: Any) -> list[float] | None:
    """The numbers of a tuple, a list or an array, None left out at the end; None if it is none such."""
    if isinstance(value, str | bytes) or not isinstance(value, Iterable):
        return None
    found = list(value)
    if len(found) == 3 and found[2] is None:
        found.pop()
    if not all(isinstance(v, Real) and not isinstance(v, bool) for v in found):
        return None
    try:
        return [float(v) for v in found]
    except OverflowError:  # an int beyond all floats
        return None


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
