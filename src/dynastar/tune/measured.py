"""The robot that a recording shows: every estimate with its evidence, as TOML to use."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.errors import ConfigError
from dynastar.navigator import NavigatorConfig
from dynastar.robot import Robot
from dynastar.tune.estimate import Estimate, untold
from dynastar.tune.ramps import accelerations, stopping_delay
from dynastar.tune.recording import Drive
from dynastar.tune.response import (
    ONSET,
    SAME,
    SETTLED,
    Axis,
    dead_band,
    gain,
    latency,
    odometry_gain,
    onsets_of,
)
from dynastar.tune.robot_file import UNKNOWN, robot_tables
from dynastar.tune.senses import OwnPart, lidar_of, own_parts, range_error, readings
from dynastar.tune.toml import rounded, toml_text

Floats = npt.NDArray[np.float64]

AXES = "v", "omega"
MOST_ERROR = 0.5  # the largest drive_error that can be declared
BODY = 0.1  # m beyond the footprint that a part of the robot may reach
NEVER_TOLD = (
    "footprint, v_max and omega_max, constant errors of the ranges, pose_error and heading_error, where "
    "the lidar is mounted, and slip of the wheels"
)


@dataclass(frozen=True)
class Measured:
    """What a recording tells: estimates by name, own parts in the lidar's view, and their evidence."""

    estimates: Mapping[str, Estimate]
    own: tuple[OwnPart, ...]
    own_words: str
    robot: Robot | None
    lidar: Mapping[str, float]
    left_out: tuple[str, ...] = ()

    def words(self) -> str:
        """All of it as lines of text."""
        lines = [estimate.words() for estimate in self.estimates.values()]
        lines.append(self.own_words)
        for part in self.own:
            lines.append(
                f"own part: {part.angle:.3g} rad, {part.distance:.3g} m, {part.readings} readings"
            )
        return "\n".join([*lines, *self.left_out, f"no recording tells: {NEVER_TOLD}"])


def measured(drive: Drive, robot: Robot | None = None) -> Measured:
    """The estimates from a drive; ``robot`` tells the footprint where the recording does not."""
    robot = robot or drive.robot
    v, omega = _axes(drive)
    onsets = [*onsets_of(v), *onsets_of(omega)]
    delay = latency(onsets)
    delays = (min(one.lower - one.unseen for one in onsets), delay.high) if delay.told else None
    found, going_on = [], [0.0]
    for axis, travelled in ((v, _forward(drive.poses)), (omega, _turned(drive.poses))):
        reported = odometry_gain(axis, travelled)
        scale = 1.0  # unless the recording shows another
        if reported.value is not None and not reported.low <= 1.0 <= reported.high:
            scale = reported.value
        true = Axis(
            axis.name, axis.unit, axis.command_times, axis.commands, axis.times, axis.speeds / scale
        )
        response = gain(true)
        derived = [response, *accelerations(true, response, delays)]
        going_on.append(stopping_delay(true, derived[-1]))
        found += [reported, *(one.widened(_relative_error(reported)) for one in derived)]
        found.append(dead_band(true, delay))
    found.insert(0, delay.up_to(min(max(going_on), ONSET), "the longest stop"))
    found += [_period(drive), range_error(drive.scans, _resting(drive, v, omega))]
    found.append(readings(drive.scans))
    estimates = {estimate.name: estimate for estimate in found}
    reach = None
    if robot is not None:
        mount = math.hypot(robot.lidar.x, robot.lidar.y)
        reach = robot.footprint.circumscribed + mount + BODY
    error = estimates["range_error"]
    way = float(np.abs(np.diff(_forward(drive.poses))).sum())
    own, words = own_parts(drive.scans, way, reach, error.high if error.told else 0.05)
    lidar = lidar_of(drive.scans)
    return Measured(estimates, tuple(own), words, robot, lidar, drive.left_out)


def robot_toml(found: Measured, source: str, told: Mapping[str, Any] | None = None) -> str:
    """The robot as a file for ``--robot``, each value with its evidence as a comment.

    Of a range the end that is safe is written: the longest latency, the weakest braking. What the
    recording does not tell is that of the robot it was given, and of the navigator's settings ``told``
    with it.
    """
    comments = {_place(name): one.words() for name, one in found.estimates.items()}
    comments["navigator.drive_error"] = (
        "how much faster than told the drive is, and how far its gains are apart"
    )
    comments["lidar.posts"] = found.own_words
    head = [
        f"The robot as {source} shows it, by dynastar tune --bag.",
        "Above each value: the estimate, its range, and what it is from.",
        "What has none is not measured: check it, and declare what is true.",
        f"No recording tells: {NEVER_TOLD}.",
        *(one.words() for one in found.estimates.values() if not one.told),
        *_left_out(found.estimates["period"]),
    ]
    if found.robot is None:
        head.append(f"The base {UNKNOWN} is a guess, for the footprint: name your own.")
    too_fast = [name for name in AXES if is_too_fast(found.estimates[f"gain_{name}"])]
    head += [
        f"The drive is more than {MOST_ERROR:.0%} too fast in {name}: drive_error cannot declare that, "
        "so correct the drive's scale first."
        for name in too_fast
    ]
    return toml_text(_without_none(_tables(found, told or {})), comments, head)


def _legal(period: Estimate) -> float | None:
    """The period (s), or None where a file may not have it: of commands that are sent on a change."""
    try:
        return None if period.value is None else NavigatorConfig(period=period.value).period
    except ConfigError:
        return None


def _left_out(period: Estimate) -> list[str]:
    """Says that the period is known, and not in the file."""
    if not period.told or _legal(period) is not None:
        return []
    return [
        f"Commands come every {period.value:.3g} s, which no loop may: declare the loop's period."
    ]


def is_too_fast(gain: Estimate) -> bool:
    """Whether a drive is faster than told by more than ``drive_error`` can declare."""
    return gain.told and gain.high - 1.0 > MOST_ERROR


def _tables(found: Measured, told: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of the file, None for what is not known."""
    names, robot, settings = found.estimates, found.robot, dict(told)
    latency = settings.pop("latency", None)
    if names["latency"].told:
        latency = names["latency"].high
    limits = {
        "v_accel": names["v_accel"].value,
        "omega_accel": names["omega_accel"].value,
        "v_brake": _end(names["v_brake"], "low"),
        "omega_brake": _end(names["omega_brake"], "low"),
        "v_least": _end(names["deadband_v"], "high"),
        "omega_least": _end(names["deadband_omega"], "high"),
    }
    navigator = {
        "period": _legal(names["period"]),
        "range_error": _end(names["range_error"], "high"),
        "drive_error": _drive_error(names["gain_v"], names["gain_omega"]),
    }
    known: dict[str, Any] = {"robot": {"base": UNKNOWN, "limits": {}}, "sensor": found.lidar}
    if robot is not None:
        known = robot_tables(robot)
    own = known["robot"]
    return {
        **rounded({"latency": latency}),
        "robot": {**own, "limits": own["limits"] | rounded(_without_none(limits))},
        "sensor": known["sensor"] | found.lidar | {"beams": _whole(names["beams"].value)},
        "drive": rounded({f"gain_{name}": names[f"gain_{name}"].value for name in AXES}),
        "odometry": rounded(
            {f"gain_{name}": names[f"odometry_gain_{name}"].value for name in AXES}
        ),
        "lidar": {"posts": [rounded(vars(part)) for part in found.own] or None},
        "navigator": settings | rounded(_without_none(navigator)),
    }


def _relative_error(estimate: Estimate) -> float:
    """Half of the range over the value; 0 where nothing is told."""
    return 0.5 * (estimate.high - estimate.low) / estimate.value if estimate.value else 0.0


def _axes(drive: Drive) -> tuple[Axis, Axis]:
    """Both speeds, v first."""
    times, commands = drive.command_times, drive.commands
    v, omega = (
        Axis(name, unit, times, told, drive.times, speeds)
        for name, unit, told, speeds in zip(
            AXES, ("m/s", "rad/s"), commands.T, drive.twists.T, strict=True
        )
    )
    return v, omega


def _forward(poses: Floats) -> Floats:
    """How far (m) the robot has moved along its heading, at each pose."""
    steps, headings = np.diff(poses[:, :2], axis=0), np.unwrap(poses[:, 2])
    middle = 0.5 * (headings[1:] + headings[:-1])
    along = steps[:, 0] * np.cos(middle) + steps[:, 1] * np.sin(middle)
    return np.concatenate([[0.0], np.cumsum(along)])


def _turned(poses: Floats) -> Floats:
    return np.unwrap(poses[:, 2])


def _resting(drive: Drive, v: Axis, omega: Axis) -> npt.NDArray[np.bool_]:
    """Whether the robot was at rest at each scan, and had been told so for a while.

    Noise of the odometry hides a slow motion, which would pass for errors of the ranges.
    """
    still = (np.abs(v.speeds) <= v.motion) & (np.abs(omega.speeds) <= omega.motion)
    places = np.clip(np.searchsorted(drive.times, drive.scan_times), 1, len(drive.times) - 1)
    moving = np.concatenate([[0], np.cumsum(np.abs(drive.commands).max(axis=1) > SAME)])
    begins, ends = (
        np.searchsorted(drive.command_times, drive.scan_times - earlier, "right")
        for earlier in (SETTLED, 0.0)
    )
    told = moving[ends] == moving[np.maximum(begins - 1, 0)]
    return np.asarray(still[places] & still[places - 1] & told)


def _period(drive: Drive) -> Estimate:
    steps = np.diff(drive.command_times)
    if len(steps) < 10:
        return untold("period", "s", "it has fewer than 11 commands", len(steps))
    low, high = np.percentile(steps, [5.0, 95.0])
    evidence = "time between two commands; the range has 90 % of them"
    value = float(np.median(steps))
    return Estimate("period", "s", value, float(low), float(high), len(steps), evidence)


def _drive_error(*gains: Estimate) -> float | None:
    """How much more than told the drive does at most, as a fraction, and how far its gains are apart.

    Of a drive that is slower than told only a difference of the two speeds, which bends an arc, counts.
    """
    if not all(one.told for one in gains):
        return None
    high, low = max(one.high for one in gains), min(one.low for one in gains)
    return min(max(high - 1.0, (high - low) / (high + low)), MOST_ERROR)


def _end(estimate: Estimate, end: str) -> float | None:
    return getattr(estimate, end) if estimate.told else None


def _whole(value: float | None) -> int | None:
    return None if value is None else round(value)


def _place(name: str) -> str:
    """The key in the file under which an estimate stands."""
    moved = {
        "latency": "latency",
        "beams": "sensor.beams",
        "deadband_v": "robot.limits.v_least",
        "deadband_omega": "robot.limits.omega_least",
        "period": "navigator.period",
        "range_error": "navigator.range_error",
    }
    if name in moved:
        return moved[name]
    if "gain" in name:
        return f"drive.{name}" if name.startswith("gain") else name.replace("_", ".", 1)
    return f"robot.limits.{name}"


def _without_none(table: Mapping[str, Any]) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for key, value in table.items():
        value = _without_none(value) if isinstance(value, Mapping) else value
        if value is not None and value != {}:
            kept[key] = value
    return kept
