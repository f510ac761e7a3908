"""How a drive responds: gain, latency and dead band, from commands and odometry.

Each speed is treated on its own. A *stretch* is a time in which its command does not change.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from dynastar.tune.estimate import Estimate, untold

Floats = npt.NDArray[np.float64]

SETTLED = 1.0  # s after which a speed has followed a command that did not change
CLEAR = 5.0  # standard deviations of the odometry's noise that are a motion
CERTAIN = 3.0  # such motions, from which on a ramp is told well enough to tell where it began
RESOLUTION = 1e-3  # of the largest speed, below which nothing is a motion
SAME = 1e-6  # m/s or rad/s between commands that are the same
ONSET = 1.0  # s within which a command must take effect
ROUNDING = 0.01  # share of an estimate that is stated as its error at least
ERRORS = 3.0  # standard errors that are stated
FEWEST = 3  # stretches, or changes of the command, for an estimate
CONFIDENCE = 0.05  # probability that the longest latency is longer than stated


@dataclass(frozen=True)
class Axis:
    """One speed of a drive: commands (n,) and odometry (m,) with their times, rising."""

    name: str  # "v" or "omega"
    unit: str
    command_times: Floats
    commands: Floats
    times: Floats
    speeds: Floats

    @cached_property
    def stretches(self) -> list[tuple[float, float, float]]:
        """Begin (s), end (s) and command of each stretch."""
        changes = np.abs(np.diff(self.commands)) > SAME
        first = np.flatnonzero(np.concatenate([[True], changes]))
        ends = np.append(self.command_times[first[1:]], self.times[-1])
        begins = self.command_times[first]
        return [
            (float(a), float(b), float(c))
            for a, b, c in zip(begins, ends, self.commands[first], strict=True)
        ]

    def steady(self, begin: float, end: float) -> Floats:
        """Speeds in the last third of a stretch that is long enough to settle; else none.

        A speed that is still on its way differs from one half of that time to the other.
        """
        if end - begin < SETTLED:
            return np.empty(0)
        inside = (self.times > end - (end - begin) / 3.0) & (self.times <= end)
        part = self.speeds[inside]
        half = len(part) // 2
        if half < 2:
            return part
        first, last = part[:half], part[-half:]
        spread = math.hypot(float(np.std(first)), float(np.std(last)))
        change = abs(float(last.mean() - first.mean()))
        least = RESOLUTION * float(np.abs(self.speeds).max())
        return part if change <= ERRORS * spread / half**0.5 + least else np.empty(0)

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the odometry's speed while the command is steady."""
        parts = [self.steady(begin, end) for begin, end, _ in self.stretches]
        spreads = [float(np.std(part)) for part in parts if len(part) > 2]
        return float(np.median(spreads)) if spreads else 0.0

    @cached_property
    def motion(self) -> float:
        """The smallest change of speed that is no noise."""
        return max(CLEAR * self.noise, RESOLUTION * float(np.abs(self.speeds).max()), 1e-6)


def gain(axis: Axis) -> Estimate:
    """Speed over command, in stretches in which the robot moved steadily."""
    name, ratios, errors = f"gain_{axis.name}", [], []
    for begin, end, command in axis.stretches:
        part = axis.steady(begin, end)
        if len(part) > 2 and abs(command) > SAME and np.ptp(part) <= 2.0 * axis.motion:
            mean = float(part.mean())
            if abs(mean) > axis.motion:
                ratios.append(mean / command)
                errors.append(axis.noise / abs(command) / len(part) ** 0.5)
    if len(ratios) < FEWEST:
        return untold(name, "", lack(len(ratios), "steady speeds of 1 s or more"), len(ratios))
    value = float(np.median(ratios))
    error = ERRORS * (_error_of_median(ratios) + float(np.median(errors)))
    error = max(error, ROUNDING * abs(value))
    evidence = "odometry over command in steady stretches"
    return Estimate(name, "", value, value - error, value + error, len(ratios), evidence)


@dataclass(frozen=True)
class Onset:
    """Bounds (s) of the time from a change of the command to that of the speed.

    ``unseen`` is how much earlier the change may have been, too small to be told from noise.
    """

    lower: float
    upper: float
    unseen: float


def latency(onsets: Sequence[Onset]) -> Estimate:
    """The longest time from a command to the first change of a speed, over changes from steady speeds.

    The change lies between two messages of the odometry, so each gives a lower and an upper bound.
    """
    if len(onsets) < FEWEST:
        why = lack(len(onsets), "changes of the command after a steady second")
        return untold("latency", "s", why, len(onsets))
    lower, upper, unseen = np.array([(one.lower, one.upper, one.unseen) for one in onsets]).T
    low = max(float((lower - unseen).max()), 0.0)
    if lower.max() < upper.min():
        high, what = float(upper.min()), "the same each time"
    else:
        spread = float(lower.max() - lower.min())
        high = float(upper.max()) + spread * (CONFIDENCE ** (-1.0 / len(onsets)) - 1.0)
        what = f"it varies by up to {spread:.2g} s, this is the longest"
    high = min(high, ONSET)
    evidence = f"time from a change of the command to that of the odometry; {what}"
    return Estimate("latency", "s", 0.5 * (low + high), low, high, len(onsets), evidence)


def onsets_of(axis: Axis) -> list[Onset]:
    """The onset of a motion at each change of the command from a steady speed.

    From rest the motion has to begin before the command changes again: a smaller one may be within the
    dead band.
    """
    found = []
    for (begin, end, before), (_, following, after) in pairwise(axis.stretches):
        part = axis.steady(begin, end)
        if len(part) < 3 or np.ptp(part) > 2.0 * axis.motion or abs(after - before) < axis.motion:
            continue
        steady = float(part.mean())
        until = end + ONSET if abs(steady) > axis.motion else min(end + ONSET, following)
        later = np.flatnonzero((axis.times > end) & (axis.times <= until))
        apart = np.abs(axis.speeds[later] - steady)
        if apart.max(initial=0.0) > CERTAIN * axis.motion and later[0] > 0:
            first = int(later[np.argmax(apart > axis.motion)])
            lower, upper = axis.times[[first - 1, first]] - end
            place = int(np.argmax(apart > CERTAIN * axis.motion))
            slope = (apart[place] - axis.motion) / (axis.times[later[place]] - end - lower)
            found.append(Onset(float(lower), float(upper), float(2.0 * axis.motion / slope)))
    return found


def dead_band(axis: Axis, delay: Estimate) -> Estimate:
    """The command below which the drive does not move, from commands given while it stood."""
    name = f"deadband_{axis.name}"
    stood: list[float] = []
    moved: list[float] = []
    for begin, end, command in axis.stretches:
        wait = begin + (delay.high if delay.told else ONSET)
        before = axis.speeds[(axis.times <= begin)][-3:]
        within = axis.speeds[(axis.times > wait) & (axis.times <= end)]
        still = len(before) > 0 and np.abs(before).max() <= axis.motion
        if abs(command) > SAME and still and len(within) > 2:
            if np.abs(within).max() > axis.motion:
                moved.append(abs(command))
            elif abs(command) > 2.0 * axis.motion:  # else noise may hide the motion
                stood.append(abs(command))
    if not moved:
        return untold(name, axis.unit, "it has no command that moved a robot at rest", len(stood))
    least = min(moved)
    n = len(stood) + len(moved)
    if not stood:
        why = (
            f"it has no command that clearly left the robot at rest; it is at most {least:.3g} "
            f"{axis.unit}"
        )
        return untold(name, axis.unit, why, n)
    most = max(stood)
    evidence = f"{most:.3g} did not move the robot, {least:.3g} did"
    low, high = min(most, least), max(most, least)
    return Estimate(name, axis.unit, high, low, high, n, evidence)


def odometry_gain(axis: Axis, travelled: Floats) -> Estimate:
    """Reported speed over that of the pose; ``travelled`` (m,) is how far the pose has moved along.

    1 where odometry derives its pose from its speeds: then only another localisation can tell.
    """
    name = f"odometry_gain_{axis.name}"
    integral = np.concatenate(
        [[0.0], np.cumsum(0.5 * (axis.speeds[1:] + axis.speeds[:-1]) * np.diff(axis.times))]
    )
    marks = np.searchsorted(axis.times, np.arange(axis.times[0], axis.times[-1], SETTLED))
    told, true = np.diff(integral[marks]), np.diff(travelled[marks])
    fast = np.abs(told) > 0.2 * np.abs(told).max() if len(told) else np.empty(0, np.bool_)
    fast &= np.abs(true) > SAME
    if fast.sum() < FEWEST or np.abs(told).max() < axis.motion:
        return untold(name, "", "the robot hardly moved", int(fast.sum()))
    ratios = told[fast] / true[fast]
    value, n = float(np.median(ratios)), len(ratios)
    error = max(ERRORS * _error_of_median(ratios), ROUNDING)
    return Estimate(name, "", value, value - error, value + error, n, "twist over change of pose")


def _error_of_median(values: Sequence[float] | Floats) -> float:
    """Standard error of the median of values that are normally distributed."""
    return 1.2533 * float(np.std(values, ddof=1)) / len(values) ** 0.5


def lack(found: int, what: str) -> str:
    """Says that ``found`` of ``what`` are too few."""
    return f"it has {found or 'no'} {what}, {FEWEST} are needed"
