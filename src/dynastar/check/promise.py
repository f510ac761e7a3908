"""Findings on the no-contact guarantee: what it covers with the declared numbers."""

from dynastar.check.finding import Finding
from dynastar.check.stopping import fastest_near_people, front_of, sight_of, stop_from
from dynastar.navigator.config import NavigatorConfig, margin_of
from dynastar.robot import Robot

WALKING = 1.5  # m/s of a person


def at_rest(robot: Robot, config: NavigatorConfig) -> Finding:
    """What the guarantee says of obstacles at rest."""
    text = (
        f"Obstacles at rest, {config.local_map.narrowest:g} m wide or more at the height of the lidar, "
        f"are not touched by a robot that moves, as long as ranges are off by {config.range_error:.3g} m "
        f"at most, positions by {config.pose_error:.3g} m and headings by {config.heading_error:.3g} rad, "
        f"commands act within {config.latency:.3g} s, and drive, brakes and period are as declared."
    )
    margin = margin_of(robot, config)
    values = {"margin": margin}
    if config.unseen_speed > 0.0:
        advice = (
            f"unseen_speed is {config.unseen_speed:g} m/s: as a last resort the robot drives where only "
            "the map says that it is free. 0 rules that out."
        )
        return Finding("obstacles at rest", "warning", text, advice, values)
    exact = [
        name
        for name in ("range_error", "pose_error", "heading_error")
        if getattr(config, name) == 0.0
    ]
    if exact:
        advice = f"Nothing is exact: measure {' and '.join(exact)}, and declare it."
        return Finding("obstacles at rest", "warning", text, advice, values)
    return Finding("obstacles at rest", "ok", text, "", values)


def moving(robot: Robot, config: NavigatorConfig) -> Finding:
    """Up to which speed somebody ahead may walk towards the robot and find it at rest.

    That is somebody who is seen as far away as the lidar measures; the local map does not limit tracks.
    """
    stop = stop_from(robot.limits.v_max, robot.limits, config)
    seen = sight_of(robot, config).by_range
    room = seen - front_of(robot.footprint) - margin_of(robot, config) - stop.distance
    fastest = min(config.tracker.fastest, max(0.0, room) / stop.seconds)
    text = (
        f"Somebody who is first seen {seen:.1f} m ahead and walks towards the robot at up to "
        f"{fastest:.1f} m/s finds it at rest, {stop.seconds:.1f} s later."
    )
    values = {"speed": fastest, "stop_time": stop.seconds}
    if fastest >= WALKING:
        return Finding("moving obstacles", "ok", text, "", values)
    advice = (
        f"People walk at {WALKING:g} m/s: see farther, brake harder, or declare a smaller v_max."
    )
    return Finding("moving obstacles", "warning", text, advice, values)


def hidden(robot: Robot, config: NavigatorConfig) -> Finding:
    """What the guarantee says of people who step out of unseen space."""
    speed, fastest = config.hidden_speed, fastest_near_people(robot, config)
    values = {"hidden_speed": speed, "fastest": fastest}
    if speed == 0.0:
        text = "The robot does not slow down for people who step out of unseen space."
        advice = "Declare hidden_speed above 0 unless nobody walks there."
        return Finding("hidden people", "warning", text, advice, values)
    text = (
        f"Somebody who steps out of unseen space at up to {speed:g} m/s finds the robot at rest; "
    )
    if fastest >= robot.limits.v_max:
        text += "what it sees ahead in the open allows v_max for that."
        return Finding("hidden people", "ok", text, "", values)
    text += f"for that it drives about {fastest:.2f} m/s in the open, as it sees no farther."
    advice = "For more speed see farther, brake harder, or declare a smaller hidden_speed."
    return Finding("hidden people", "warning", text, advice, values)
