"""Trajectory -> how evenly it was driven: turning, jerk, angular acceleration, swings, circles."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.path import Trajectory

Floats = npt.NDArray[np.float64]

JERK_STEP = 0.25  # s over which speeds are averaged before they are differentiated twice
SAMPLES = 25  # of the speed in each such step
OMEGA_DEADBAND = 0.05  # rad/s, turning rates up to this have no sign
CIRCLE_ANGLE = math.radians(270.0)
CIRCLE_LENGTH = 6.0  # m, the longest stretch that is a circle; 270 degrees at 1 m radius are 4.7 m


def smoothness(driven: Trajectory) -> float | None:
    """Total variation of the turning rate per metre, in (rad/s)/m; None without a metre.

    ``sum |omega_{i+1} - omega_i| / length``: 0 on a line or a single arc, small is smooth.
    """
    length = _length(driven)
    variation = float(np.abs(np.diff(driven.twists[:, 1])).sum())
    return variation / length if length > 0.0 else None


def turning_angle(driven: Trajectory) -> float:
    """All that the heading has turned, either way, in rad: ``sum |theta_{i+1} - theta_i|``."""
    return float(np.abs(np.diff(np.unwrap(driven.poses[:, 2]))).sum())


def jerk(driven: Trajectory) -> float | None:
    """RMS of the speed's second derivative, in m/s3; None under 0.75 s.

    The speed at ticks, linear between them, is averaged over steps of 0.25 s, and the second difference
    of these means is divided by the squared step. So the value does not grow with the rate of the ticks,
    which are at most 0.25 s apart in every suite.
    """
    times, v = driven.times, driven.twists[:, 0]
    steps = int((times[-1] - times[0]) / JERK_STEP + 1e-9) if len(times) else 0
    if steps < 3:
        return None
    samples = times[0] + JERK_STEP * (np.arange(steps * SAMPLES) + 0.5) / SAMPLES
    means = np.interp(samples, times, v).reshape(steps, SAMPLES).mean(axis=1)
    return float(np.sqrt(np.mean((np.diff(means, 2) / JERK_STEP**2) ** 2)))


def angular_acceleration(driven: Trajectory) -> float | None:
    """RMS over time of the turning rate's difference quotient, in rad/s2; None without time.

    The quotient is taken from tick to tick, between which the turning rate is a ramp, so that samples
    between the ticks would not change the value.
    """
    steps, changes = np.diff(driven.times), np.diff(driven.twists[:, 1])
    changes, steps = changes[steps > 0.0], steps[steps > 0.0]
    if len(steps) == 0:
        return None
    return float(np.sqrt((changes**2 / steps).sum() / steps.sum()))


def omega_changes(driven: Trajectory) -> float | None:
    """Sign changes of the turning rate per metre driven, in 1/m; None without a metre.

    Turning rates up to 0.05 rad/s have no sign: what is between them and the next larger one does not
    count, so that noise around 0 is no change.
    """
    omega, length = driven.twists[:, 1], _length(driven)
    signs = np.sign(omega[np.abs(omega) > OMEGA_DEADBAND])
    changes = int(np.count_nonzero(np.diff(signs)))
    return changes / length if length > 0.0 else None


def circles(driven: Trajectory) -> int:
    """Number of turns by 270 degrees net, one way, each within 6 m of driving or on the spot.

    The turns do not overlap: where one ends, the next may begin. Turns to and fro cancel.
    """
    if len(driven.times) == 0:
        return 0
    heading, arc = np.unwrap(driven.poses[:, 2]), driven.path.arc
    firsts = np.searchsorted(arc, arc - CIRCLE_LENGTH)
    count = begin = 0
    for tick, first in enumerate(firsts):
        since = heading[max(begin, first) : tick + 1]
        if np.abs(since - heading[tick]).max() >= CIRCLE_ANGLE:
            count, begin = count + 1, tick
    return count


def _length(driven: Trajectory) -> float:
    return driven.length if len(driven.times) else 0.0
