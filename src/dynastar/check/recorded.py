"""Findings on a recording: where it breaks what is declared."""

import math

import numpy as np

from dynastar.check.finding import Finding, Level, at_least, at_most, worst
from dynastar.check.recording import Recording, Stream
from dynastar.navigator import NavigatorConfig
from dynastar.robot import Robot

SLOWER = 1.5  # times the period, between two commands
RARE = 0.99  # fraction of the gaps that may not exceed scan_age before it is a problem
TOLERANCE = 0.01  # relative difference of angles and ranges
CLOCKS = 60.0  # s between stamp and time of recording, beyond which they are of different clocks
AGED = 0.5  # of scan_age that a message may be old when it is recorded
OVER = 0.02  # m/s and rad/s beyond the limits that noise may make
MOVED, TURNED = 0.02, 0.05  # m and rad that a mount may be off
COMMAND_SHARE = 95  # percentile of the gaps between commands


def findings_of(recording: Recording, robot: Robot, config: NavigatorConfig) -> list[Finding]:
    """All findings on a recording."""
    return [
        rate("scans", recording.scans, config),
        rate("odometry messages", recording.odometry, config),
        stamps(recording, config),
        readings(recording, robot),
        mount(recording, robot),
        odd(recording),
        speeds(recording, robot, config),
        commands(recording, config),
    ]


def rate(what: str, stream: Stream, config: NavigatorConfig) -> Finding:
    """How often messages come, and whether gaps between them brake the robot."""
    gaps, age, name = stream.gaps, config.scan_age, f"recorded {what.partition(' ')[0]}"
    middle, longest = float(np.median(gaps)), float(gaps.max())
    over = int((gaps > age).sum())
    text = (
        f"Recorded {what} come {1.0 / middle if middle > 0.0 else math.inf:.1f} times a second; the "
        f"longest gap is {longest:.2f} s, {over} of {len(gaps)} are longer than scan_age, {age:g} s."
    )
    values = {"median_gap": middle, "longest_gap": longest, "over": over, "gaps": len(gaps)}
    if over:
        few = over <= (1.0 - RARE) * len(gaps)
        advice = f"The robot brakes in each of them: find what delays the {what}."
        return Finding(name, "warning" if few else "problem", text, advice, values)
    if age < 2.0 * middle:
        advice = f"Declare scan_age = {at_least(2.0 * middle)} or more, two of these gaps."
        return Finding(name, "warning", text, advice, values)
    return Finding(name, "ok", text, "", values)


def stamps(recording: Recording, config: NavigatorConfig) -> Finding:
    """Whether stamps rise, and how old messages are when they are recorded."""
    level: Level = "ok"
    words, advice = [], []
    values: dict[str, float] = {}
    for what, stream in (("scans", recording.scans), ("odometry messages", recording.odometry)):
        back = int((stream.gaps <= 0.0).sum())
        ages = stream.recorded - stream.stamps
        age, largest = float(np.median(ages)), float(ages.max())
        name = what.partition(" ")[0]
        values |= {f"{name}_back": back, f"{name}_age": age, f"{name}_largest_age": largest}
        if back:
            level = "problem"
            advice.append(f"{back} stamps of {what} do not rise: correct the driver.")
        if abs(age) > CLOCKS:
            words.append(f"{what} have the stamps of another clock than the recording's")
            continue
        words.append(f"{what} are {age:.3f} s old when they are recorded, {largest:.3f} s at most")
        if largest > config.scan_age or age < -AGED * config.scan_age:
            level = worst(level, "problem")
            advice.append(f"Set the clocks of the computers alike, or find what delays the {what}.")
        elif age > AGED * config.scan_age:
            level = worst(level, "warning")
            advice.append(f"Find what delays the {what}.")
    text = f"{'; '.join(words)}."
    return Finding("recorded stamps", level, text[0].upper() + text[1:], " ".join(advice), values)


def readings(recording: Recording, robot: Robot) -> Finding:
    """Whether scans have the beams and ranges that are declared of the lidar."""
    lidar = robot.lidar
    beams, least = int(np.median(recording.beams)), int(recording.beams.min())
    fov = float(np.median(recording.fov))
    low, high = float(np.median(recording.range_min)), float(np.median(recording.range_max))
    declared = lidar.increment * max(lidar.beams - 1, 0)
    text = (
        f"Recorded scans have {beams} readings over {math.degrees(fov):.0f} degrees, from {low:g} to "
        f"{high:g} m; declared are {lidar.beams} over {math.degrees(declared):.0f} degrees, from "
        f"{lidar.range_min:g} to {lidar.range_max:g} m."
    )
    wrong = []
    apart = fov > (1.0 + TOLERANCE) * lidar.increment * max(least - 1, 1)
    if apart or least < (1.0 - TOLERANCE) * lidar.beams:
        wrong.append(f"beams = {least}")
    if apart or fov < (1.0 - TOLERANCE) * declared:
        wrong.append(f"fov = {at_most(fov, 4)}")
    if high < (1.0 - TOLERANCE) * lidar.range_max:
        wrong.append(f"range_max = {high:g}")
    if low > lidar.range_min + TOLERANCE:
        wrong.append(f"range_min = {low:g}")
    values = {"beams": beams, "least_beams": least, "fov": fov, "range_min": low, "range_max": high}
    if wrong:
        advice = f"This lidar sees less than declared: declare {', '.join(wrong)} of it."
        return Finding("recorded readings", "problem", text, advice, values)
    return Finding("recorded readings", "ok", text, "", values)


def mount(recording: Recording, robot: Robot) -> Finding:
    """Whether the lidar is where it is declared to be, by the recorded transforms."""
    lidar, found = robot.lidar, recording.mount
    if found is None:
        return Finding("recorded mount", "ok", "No transform of the lidar was recorded.")
    away = math.hypot(found.x - lidar.x, found.y - lidar.y)
    off = abs(math.remainder(found.theta - lidar.theta, math.tau))
    text = (
        f"By the recorded transforms the lidar is at ({found.x:.3f}, {found.y:.3f}) m and its middle "
        f"points to {round(found.theta, 2) + 0.0:.2f} rad; declared are ({lidar.x:g}, {lidar.y:g}) m and "
        f"{lidar.theta:g} rad."
    )
    values = {"x": found.x, "y": found.y, "theta": found.theta}
    part = lidar.fov < math.tau - lidar.increment - TURNED
    if away > MOVED or (part and off > TURNED):
        advice = "Correct the transform, or declare x, y and theta of the lidar."
        return Finding("recorded mount", "problem", text, advice, values)
    return Finding("recorded mount", "ok", text, "", values)


def odd(recording: Recording) -> Finding:
    """What the navigator's status would have said of the readings."""
    if not recording.hints:
        text = "Nothing is odd about the recorded readings."
        return Finding("recorded ranges", "ok", text)
    text = "; ".join(recording.hints)
    return Finding("recorded ranges", "warning", f"{text[0].upper()}{text[1:]}.")


def speeds(recording: Recording, robot: Robot, config: NavigatorConfig) -> Finding:
    """Whether the robot was within its limits."""
    limits, more = robot.limits, 1.0 + config.drive_error
    v, omega = recording.speeds[:, 0], np.abs(recording.speeds[:, 1])
    text = (
        f"The recorded speeds are {v.min():.2f} to {v.max():.2f} m/s, and up to {omega.max():.2f} rad/s; "
        f"declared are {limits.v_min:g} to {limits.v_max:g} m/s and {limits.omega_max:g} rad/s."
    )
    values = {"least": float(v.min()), "largest": float(v.max()), "turning": float(omega.max())}
    fast = v.max() > more * limits.v_max + OVER or v.min() < more * limits.v_min - OVER
    if fast or omega.max() > more * limits.omega_max + OVER:
        advice = (
            "If dynastar drove, drive_error is too small; else somebody drove faster than declared."
        )
        return Finding("recorded speeds", "warning", text, advice, values)
    if max(v.max(), -v.min(), omega.max()) < OVER:
        advice = "The robot rested: record a drive, which tells more."
        return Finding("recorded speeds", "warning", text, advice, values)
    return Finding("recorded speeds", "ok", text, "", values)


def commands(recording: Recording, config: NavigatorConfig) -> Finding:
    """How often commands came, and when they acted."""
    gaps = np.diff(recording.commands)
    if len(gaps) == 0:
        number = "One command was" if len(recording.commands) else "No commands were"
        return Finding("recorded commands", "ok", f"{number} recorded (topic cmd_vel).")
    slow = float(np.percentile(gaps, COMMAND_SHARE))
    text = f"{COMMAND_SHARE} of 100 recorded commands came within {slow:.3f} s of the one before"
    values = {"gap": slow, "latency": recording.latency}
    advice = []
    level: Level = "ok"
    if slow > SLOWER * config.period:
        level = "warning"
        advice.append(
            f"Unless they were given by hand, find what slows the loop down, or declare a period of "
            f"{at_least(slow)} s (1 s at most)."
        )
    if recording.latency is not None:
        text += f", and acted after about {recording.latency:.2f} s, not {config.latency:g} s"
        level = "problem"
        advice.append(
            f"Declare latency = {recording.latency:.2g} with some reserve, or smaller accelerations: "
            "dynastar tune --bag tells which."
        )
    return Finding("recorded commands", level, f"{text}.", " ".join(advice), values)
