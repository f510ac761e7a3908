"""How fast a drive speeds up and brakes, from ramps of its speed that are as steep as it can."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np

from dynastar.tune.estimate import Estimate, untold
from dynastar.tune.response import CLEAR, ERRORS, FEWEST, ROUNDING, SAME, SETTLED, Axis, lack

MIDDLE = 0.1, 0.9  # of the change of speed in a ramp, between which its slope is measured
LARGE = 0.5  # of the largest change of speed in a ramp, that others need


def accelerations(
    axis: Axis, response: Estimate, delays: tuple[float, float] | None
) -> tuple[Estimate, Estimate]:
    """Acceleration and braking while the drive could not yet follow its command.

    ``response`` is the gain, ``delays`` the least and the longest latency. The stated range is that of the
    single ramps, and the error that noise makes in it. Small ramps beside much larger ones are left out.
    """
    names = f"{axis.name}_accel", f"{axis.name}_brake"
    unit = f"{axis.unit}2"
    if delays is None or response.value is None:
        both = [untold(name, unit, "it needs latency and gain") for name in names]
        return both[0], both[1]
    kinds = [_kind(axis, k, response.value, delays) for k in range(len(axis.times) - 1)]
    ramps: dict[str, list[Ramp]] = {name: [] for name in names}
    for name, (begin, end) in _runs(kinds, names):
        ramp = _ramp(axis, begin, end)
        if ramp.change > 2.0 * axis.motion:
            ramps[name].append(ramp)
    accel, brake = (_slope(name, unit, ramps[name], axis) for name in names)
    return accel, brake


def stopping_delay(axis: Axis, brake: Estimate) -> float:
    """Seconds that the drive goes on before it brakes, as its fast stops have it; 0 if there are none.

    That is the time for which it would have kept its speed to come as far, with the weakest braking that
    is stated: a drive that nears its speed gradually needs longer than its latency.
    """
    found = list(_stops(axis)) if brake.told else []
    fastest = max((speed for speed, _ in found), default=0.0)
    delays = [
        way / speed - 0.5 * speed / brake.low for speed, way in found if speed >= LARGE * fastest
    ]
    return max(delays, default=0.0)


def _stops(axis: Axis) -> Iterator[tuple[float, float]]:
    """Speed and way (from the command 0 on) of each stop from a steady speed, both positive."""
    for (begin, end, _), (_, until, command) in pairwise(axis.stretches):
        before = axis.steady(begin, end)
        if abs(command) > SAME or len(before) < 3 or until - end < SETTLED:
            continue
        speed = float(before.mean())
        if abs(speed) > CLEAR * axis.motion:
            inside = (axis.times > end) & (axis.times <= until)
            times = np.concatenate([[end], axis.times[inside]])
            speeds = np.concatenate([[speed], axis.speeds[inside]])
            way = float((0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times)).sum())
            yield abs(speed), abs(way)


@dataclass(frozen=True)
class Ramp:
    """A ramp of a speed: its ``slope`` with its standard error, and the ``change`` of the speed."""

    slope: float
    error: float
    change: float


def _runs(kinds: Sequence[str], names: tuple[str, str]) -> Iterator[tuple[str, tuple[int, int]]]:
    """The name of each run of equal kinds that are not empty, and its first and last message."""
    begin = 0
    for kind, group in groupby(kinds):
        end = begin + len(list(group))
        if kind:
            yield names[kind == "brake"], (begin, end)
        begin = end


def _kind(axis: Axis, k: int, scale: float, delays: tuple[float, float]) -> str:
    """Whether the drive speeds up or brakes as fast as it can between two messages, or neither.

    It does where all commands that may act then are clearly ahead of it. Close to rest noise hides
    which of the two it is.
    """
    before, after = axis.speeds[k], axis.speeds[k + 1]
    least, longest = delays
    first = np.searchsorted(axis.command_times, axis.times[k] - longest, "right") - 1
    last = np.searchsorted(axis.command_times, axis.times[k + 1] - least, "right")
    if first < 0 or before * after < 0.0 or abs(before + after) <= 2.0 * axis.motion:
        return ""
    aims = scale * axis.commands[first:last]
    up = bool(aims.min() > max(before, after))
    left = aims.min() - max(before, after) if up else min(before, after) - aims.max()
    if left <= axis.motion:
        return ""
    return "accel" if (before + after > 0.0) == up else "brake"


def _ramp(axis: Axis, begin: int, end: int) -> Ramp:
    """The ramp in messages ``begin`` to ``end``, by a straight line through the middle of its change.

    So a drive counts that nears its speed gradually, or that never reaches what it is told.
    """
    times, speeds = axis.times[begin : end + 1], axis.speeds[begin : end + 1]
    done = np.abs(speeds - speeds[0])
    change = float(done.max())
    low, high = MIDDLE
    last = int(np.argmax(done >= high * change)) + 1
    first = int(np.flatnonzero(done[:last] <= low * change)[-1])
    away = times[first:last] - times[first:last].mean()
    spread = max(float((away**2).sum()), 1e-12)
    slope = abs(float((away * speeds[first:last]).sum())) / spread
    return Ramp(slope, axis.noise / spread**0.5, change)


def _slope(name: str, unit: str, ramps: Sequence[Ramp], axis: Axis) -> Estimate:
    largest = max((ramp.change for ramp in ramps), default=0.0)
    kept = [ramp for ramp in ramps if ramp.change >= LARGE * largest]
    if len(kept) < FEWEST:
        step = np.diff(axis.speeds) / np.diff(axis.times)
        rising = np.abs(axis.speeds[1:]) > np.abs(axis.speeds[:-1])
        seen = np.abs(step[rising if name.endswith("accel") else ~rising])
        most = float(seen.max()) if len(seen) else 0.0
        why = lack(len(kept), "ramps in which the command was ahead of the drive")
        return untold(name, unit, f"{why}; at least {most:.3g} {unit} was seen", len(kept))
    slopes = [ramp.slope for ramp in kept]
    value = float(np.median(slopes))
    noise = ERRORS * float(np.median([ramp.error for ramp in kept])) / len(kept) ** 0.5
    error = max(ROUNDING * value, noise)
    low, high = min(slopes) - error, max(slopes) + error
    if low <= 0.0:
        return untold(name, unit, "noise of the odometry hides the slope of its ramps", len(kept))
    evidence = "slope of the odometry's speed while the command was ahead of it"
    return Estimate(name, unit, value, low, high, len(kept), evidence)
