"""Room to turn on the spot among what is known to be occupied."""

import math

from dynastar.compiled import inner, njit
from dynastar.dwa.admissible import keeps_clear
from dynastar.dwa.clearance import Closed
from dynastar.dwa.motion import Pose

ACROSS = 6  # places looked at from the middle of the tolerance to its rim
KEPT_WITHIN = 0.9  # of a tolerance, that is made use of


@njit(cache=True)
def has_room_to_turn(scene, rules, start, pose, angle, need):
    """Whether the footprint of a robot that is at ``start`` could turn at ``pose`` by an angle (rad).

    ``need`` is the room beyond the margin (m), and by what the turn may fall short of the angle (rad).
    What was not seen counts as free: it comes into view while the robot turns.
    """
    spare, short_by = need
    angle = math.copysign(max(abs(angle) - short_by, 0.0), angle)
    known, closed = scene.distance_to_obstacle, scene.around.closed
    occupied = Closed(known, closed.occupied, closed.hits)
    margin = scene.around.margin_to_closed + spare
    return keeps_clear(occupied, rules.body, margin, start, pose, (0.0, angle))


@inner
def can_turn(scene, rules, start, place, turn, need):
    """Whether a robot can turn at a place from one heading to another, ``turn`` (rad)."""
    theta, heading = turn
    x, y = place
    at = Pose(x, y, math.cos(theta), math.sin(theta))
    short = (heading - theta + math.pi) % math.tau - math.pi
    long = short - math.copysign(math.tau, short)
    if has_room_to_turn(scene, rules, start, at, short, need):
        return True
    return has_room_to_turn(scene, rules, start, at, long, need)


@njit(cache=True)
def place_to_turn(scene, rules, pose, goal, tolerance, need):
    """The place nearest to a goal (x, y, heading), within a tolerance (m), where the robot can turn.

    The robot comes straight from ``pose``, backward if the place lies behind it; ``need`` as in
    ``has_room_to_turn``. Returns (found, x, y).
    """
    goal_x, goal_y, heading = goal
    nearest, best_x, best_y = tolerance, goal_x, goal_y
    for i in range(-ACROSS, ACROSS + 1):
        for j in range(-ACROSS, ACROSS + 1):
            dx = KEPT_WITHIN * tolerance * i / ACROSS
            dy = KEPT_WITHIN * tolerance * j / ACROSS
            away = math.sqrt(dx * dx + dy * dy)
            if away >= nearest or away > KEPT_WITHIN * tolerance:
                continue
            place = goal_x + dx, goal_y + dy
            ahead_x, ahead_y = goal_x + dx - pose.x, goal_y + dy - pose.y
            if rules.limits.v_min < 0.0 and pose.cos * ahead_x + pose.sin * ahead_y < 0.0:
                ahead_x, ahead_y = -ahead_x, -ahead_y  # it comes backward
            theta = math.atan2(ahead_y, ahead_x)
            if can_turn(scene, rules, pose, place, (theta, heading), need):
                nearest, best_x, best_y = away, goal_x + dx, goal_y + dy
    return nearest < tolerance, best_x, best_y
