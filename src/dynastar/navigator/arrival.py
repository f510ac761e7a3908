"""The end of a mission: whether the robot is at its goal."""

import math

from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.navigator.config import NavigatorConfig
from dynastar.robot import Limits

GENTLE = 0.7  # of the braking limits, used to turn to a heading or to slow down for a speed limit
TURNING = 0.1  # rad/s from which on the robot still turns


def is_near(goal: Goal, pose: Pose2D, config: NavigatorConfig) -> bool:
    """Whether a pose is within the tolerance of a goal's position."""
    return math.hypot(goal.x - pose.x, goal.y - pose.y) <= config.goal_tolerance


def has_arrived(
    goal: Goal, now: Pose2D, acting: tuple[Pose2D, Twist], limits: Limits, config: NavigatorConfig
) -> bool:
    """Whether the robot is at its goal, and will still be when it has come to rest.

    ``acting`` are pose and twist when a command given now acts.
    """
    pose, twist = acting
    stop = 0.5 * twist.v * abs(twist.v) / limits.v_brake
    rest = pose._replace(
        x=pose.x + stop * math.cos(pose.theta), y=pose.y + stop * math.sin(pose.theta)
    )
    if not (is_near(goal, now, config) and is_near(goal, rest, config)):
        return False
    if goal.heading is None:
        return True
    off = abs(wrap_angle(goal.heading - now.theta))
    return abs(twist.omega) <= TURNING and off <= config.heading_tolerance
