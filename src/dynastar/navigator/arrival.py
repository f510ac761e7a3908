"""The end of a mission: whether the robot is at its goal."""

import math

from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.navigator.braking import Acting
from dynastar.navigator.config import NavigatorConfig
from dynastar.robot import Limits

GENTLE_BRAKING = 0.7  # of the braking limits, to turn to a heading or slow down for a speed limit
TURNING = 0.1  # rad/s from which on the robot still turns


def rest_place(pose: Pose2D, twist: Twist, limits: Limits) -> tuple[float, float]:
    """Where a robot that brakes straight ahead comes to rest (x, y)."""
    stop = 0.5 * twist.v * abs(twist.v) / limits.v_brake
    return pose.x + stop * math.cos(pose.theta), pose.y + stop * math.sin(pose.theta)


def stays_near(
    goal: Goal, now: Pose2D, acting: Acting, limits: Limits, config: NavigatorConfig
) -> bool:
    """Whether the robot is within the tolerance of a goal's position, and still when it has come to rest.

    ``acting`` are pose and twist when a command given now acts.
    """
    places = (now.x, now.y), rest_place(*acting, limits)
    return all(math.dist(goal[:2], place) <= config.goal_tolerance for place in places)


def has_arrived(
    goal: Goal, now: Pose2D, acting: Acting, limits: Limits, config: NavigatorConfig
) -> bool:
    """Whether the robot is at its goal and stays there, with the goal's heading if it has one."""
    if not stays_near(goal, now, acting, limits, config):
        return False
    if goal.heading is None:
        return True
    off = abs(wrap_angle(goal.heading - now.theta))
    return abs(acting.twist.omega) <= TURNING and off <= config.heading_tolerance
