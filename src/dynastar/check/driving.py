"""Findings on braking and on what the lidar sees, from the declared numbers alone."""

import math

import numpy as np

from dynastar.check.finding import Finding, Level, at_most
from dynastar.check.stopping import (
    blind_beyond,
    fastest_within,
    front_of,
    looks_towards,
    room_ahead,
    sight_of,
    stop_from,
)
from dynastar.navigator.config import NavigatorConfig, fitted, margin_of
from dynastar.robot import Robot

SLOWEST = 0.01  # m/s that v_max can be
AMPLE = 2.0  # times the stopping distance that the robot should see
STRONG_BRAKE = 5.0  # m/s2 that few drives reach on a floor
BLIND = 0.05  # m beyond the footprint that may go unseen
ALL_ROUND = math.radians(1.0)  # of a turn that may lack


def braking(robot: Robot, config: NavigatorConfig) -> Finding:
    """Whether a stop from v_max ends within what the lidar sees."""
    limits = robot.limits
    stop, sight = stop_from(limits.v_max, limits, config), sight_of(robot, config)
    room = room_ahead(robot, config)
    fastest = fastest_within(room, limits, config)
    values = {
        "stop": stop.distance, "stop_time": stop.seconds, "sight": sight.ahead,
        "room": room, "fastest": fastest,
    }  # fmt: skip
    text = (
        f"A stop from v_max, {limits.v_max:g} m/s, takes {stop.distance:.2f} m and "
        f"{stop.seconds:.1f} s"
    )
    if sight.ahead <= 0.0:
        words = "the lidar does not look ahead, so the robot cannot drive forward."
        return Finding("braking", "problem", f"{text}; {words}", _turn_lidar(), values)
    seen = f"the lidar shows free space {sight.ahead:.1f} m ahead ({_limit(robot, config)})"
    if stop.distance > room:
        words = f"{seen}, so the robot drives about {fastest:.2f} m/s."
        slower = f"declare v_max = {at_most(fastest)}, or " if fastest >= SLOWEST else ""
        advice = f"{slower}{_see_farther(robot, config)}."
        advice = advice[0].upper() + advice[1:]
        return Finding("braking", "problem", f"{text}; {words}", advice, values)
    if AMPLE * stop.distance > room:
        advice = (
            f"More than {AMPLE:g} times the stop lets it keep v_max near obstacles: "
            f"drive slower, or {_see_farther(robot, config)}."
        )
        return Finding("braking", "warning", f"{text}; {seen}.", advice, values)
    return Finding("braking", "ok", f"{text}; {seen}.", "", values)


def _turn_lidar() -> str:
    return "Correct the mount, sensor.theta, or the field of view, sensor.fov."


def _limit(robot: Robot, config: NavigatorConfig) -> str:
    """Names what limits how far the lidar shows free space."""
    sight = sight_of(robot, config)
    if sight.ahead == sight.by_beams:
        return f"{robot.lidar.beams} beams, narrowest {config.local_map.narrowest:g} m"
    if sight.ahead == sight.by_map:
        own = fitted(config, robot)
        return f"the local map's size, {own.local_map.size:.3g} m, with the robot near its middle"
    return f"range_max {robot.lidar.range_max:g} m"


def _see_farther(robot: Robot, config: NavigatorConfig) -> str:
    """Says which change lets the robot see farther."""
    sight = sight_of(robot, config)
    if sight.ahead == sight.by_beams:
        return (
            "take a lidar with more beams, or raise local_map.narrowest if no obstacle is so thin"
        )
    if sight.ahead == sight.by_map:
        return "raise local_map.size"
    return "take a lidar with a larger range_max"


def brakes(robot: Robot, config: NavigatorConfig) -> Finding:
    """Whether the declared braking and drive can be true."""
    limits = robot.limits
    text = (
        f"The robot is taken to brake at {limits.v_brake:g} m/s2 or more, and each of its "
        f"speeds to be at most {100.0 * config.drive_error:g} % off what is commanded."
    )
    values = {"v_brake": limits.v_brake, "drive_error": config.drive_error}
    if limits.v_brake > STRONG_BRAKE:
        advice = (
            f"Few drives brake at more than {STRONG_BRAKE:g} m/s2: measure v_brake, and declare it."
        )
        return Finding("brakes", "warning", text, advice, values)
    if config.drive_error == 0.0:
        advice = "No drive is exact: measure drive_error, and declare it."
        return Finding("brakes", "warning", text, advice, values)
    return Finding("brakes", "ok", text, "", values)


def beams(robot: Robot, config: NavigatorConfig) -> Finding:
    """Whether neighbouring beams leave gaps for an obstacle within a stop from v_max."""
    lidar, narrowest = robot.lidar, config.local_map.narrowest
    stop = stop_from(robot.limits.v_max, robot.limits, config).distance
    far = max(0.0, front_of(robot.footprint) + margin_of(robot, config) + stop - lidar.x)
    gap = far * lidar.increment
    text = (
        f"Where a stop from v_max ends, {far:.2f} m from the lidar, neighbouring beams are "
        f"{gap:.3f} m apart; the thinnest obstacle declared (local_map.narrowest) is {narrowest:g} m."
    )
    values = {"gap": gap, "narrowest": narrowest, "distance": far}
    if gap <= narrowest:
        return Finding("beams", "ok", text, "", values)
    needed = math.ceil(lidar.beams * gap / narrowest)
    advice = f"Take {needed} beams or more"
    left = narrowest / lidar.increment - (far - stop)
    advice += f", or stop within {at_most(left)} m." if left > 0.0 else "."
    return Finding("beams", "problem", text, advice, values)


def blind_sectors(robot: Robot, config: NavigatorConfig) -> Finding:
    """What the lidar does not see: beside or behind the robot, and close to it."""
    lidar, advice = robot.lidar, []
    close, blind = blind_beyond(robot), math.tau - lidar.fov
    text = "The lidar sees all round the robot"
    if not looks_towards(lidar, lidar.theta + math.pi):
        text = f"{math.degrees(blind):.0f} degrees round the robot are blind"
        if config.reverse and robot.limits.v_min < 0.0:
            text += ", and it backs up only where it has seen free space before"
        advice.append(
            "Start it where it can turn: out of a dead end as narrow as itself it finds no way."
        )
    if close > BLIND:
        text += f"; obstacles within {close:.2f} m of its side can be nearer than range_min"
        advice.append("Mount the lidar further inside, or declare a footprint that contains this.")
    if not robot.footprint.covers(np.array([(lidar.x, lidar.y)]))[0]:
        text += "; the lidar is outside of the footprint"
        advice.append("Correct its mount, or declare a footprint that contains all of the robot.")
    level: Level = "warning" if advice else "ok"
    values = {"blind": blind, "close": close}
    return Finding("blind sectors", level, f"{text}.", " ".join(advice), values)
