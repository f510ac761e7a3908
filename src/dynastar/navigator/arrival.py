"""The end of a mission: whether the robot is at its goal."""

import math

from dynastar.geometry import Goal, Pose2D, Twist, wrap_angle
from dynastar.navigator.braking import Acting
from dynastar.navigator.config import NavigatorConfig
from dynastar.robot import Limits

GENTLE_BRAKING = 0.7  # of the braking limits, to turn to a heading or slow down for a speed limit


def rest_pose(pose: Pose2D, twist: Twist, limits: Limits) -> Pose2D:
    """Where a robot that brakes straight ahead, and in its turn, comes to rest."""
    stop = 0.5 * twist.v * abs(twist.v) / limits.v_brake
    turn = 0.5 * twist.omega * abs(twist.omega) / limits.omega_brake
    x, y, theta = pose
    return Pose2D(x + stop * math.cos(theta), y + stop * math.sin(theta), theta + turn)


def stays_near(
    goal: Goal, now: Pose2D, acting: Acting, limits: Limits, config: NavigatorConfig
) -> bool:
    """Whether the robot is within the tolerance of a goal's position, and still when it has come to rest.

    ``acting`` are pose and twist when a command given now acts.
    """
    places = now[:2], rest_pose(*acting, limits)[:2]
    return all(math.dist(goal[:2], place) <= config.goal_tolerance for place in places)


def has_arrived(
    goal: Goal, now: Pose2D, acting: Acting, limits: Limits, config: NavigatorConfig
) -> bool:
    """Whether the robot is at its goal and stays there, with the goal's heading if it has one."""
    if not stays_near(goal, now, acting, limits, config):
        return False
    if goal.heading is None:
        return True
    headings = now.theta, rest_pose(*acting, limits).theta
    return all(abs(wrap_angle(goal.heading - at)) <= config.heading_tolerance for at in headings)
