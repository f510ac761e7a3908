"""A search over poses (x, y, heading): how a robot gets on where following the cost-to-go does not.

The cost-to-go knows places only. A long robot that meets a narrow way at an angle, or one that stands
close to a wall, has to back, and to turn where its footprint has room. Hybrid A* [Dolgov2010] over arcs
of one length, ahead and back, and turns on the spot.
"""

import heapq
import math
from typing import NamedTuple

import numpy as np

from dynastar.compiled import allocating, inner, njit
from dynastar.dwa.clearance import ROUNDING, Closed, clearance_slack, least_clearance
from dynastar.dwa.motion import Pose, moved
from dynastar.dwa.rollout import is_on_map
from dynastar.dwa.terms import state_value

HEADINGS = 32
ACROSS = 64  # bins from one side of the searched square to the other
STEP, BIN = 2.0, 1.6  # cells, the length of a move and the side of a bin
BACKING = 3.0  # m ahead that a metre back is as dear as: lidars look ahead
MOST = 3000  # moves that are checked at most
TURN = math.tau / HEADINGS
NODE = np.dtype(
    [(name, np.float64) for name in Pose._fields]
    + [(name, np.int64) for name in ("before", "move", "is_settled")]
)
FIRST = -1  # in place of a move


class Move(NamedTuple):
    """Steps ahead and turns to the left."""

    ahead: int
    left: int


class Arc(NamedTuple):
    """The length (m) and the angle (rad) of a move."""

    length: float
    angle: float


AHEAD = Move(1, 0), Move(1, 1), Move(1, -1)
BACK = Move(-1, 0), Move(-1, 1), Move(-1, -1)
MOVES = *AHEAD, *BACK, Move(0, 1), Move(0, -1)


@inner
def bin_of(pose, middle, side):
    """The index of the bin that a pose lies in, -1 outside of the square round ``middle``."""
    column = int(math.floor((pose.x - middle.x) / side)) + ACROSS // 2
    row = int(math.floor((pose.y - middle.y) / side)) + ACROSS // 2
    if not (0 <= row < ACROSS and 0 <= column < ACROSS):
        return -1
    heading = int(round(math.atan2(pose.sin, pose.cos) / TURN)) % HEADINGS
    return (heading * ACROSS + row) * ACROSS + column


@inner
def left_from(scene, rules, pose):
    """The cost-to-go (m) of a robot that rests at a pose."""
    return state_value(scene.cost_to_go, rules.limits, pose, 0.0)


@inner
def is_open(scene, rules, start, pose, arc, spare):
    """Whether the robot may drive an arc from ``pose``, and nobody who moves is near its end.

    It keeps ``spare`` (m) beyond the margin. What lies ahead and was not seen comes into view on the
    way; what lies behind may not.
    """
    around, body = scene.around, rules.body
    distance = scene.distance_to_obstacle if arc.length > 0.0 else around.closed.distance
    closed = Closed(distance, around.closed.occupied, around.closed.hits)
    margin = around.margin_to_closed + spare
    near = margin + distance.resolution + body.probe_error
    sweep = max(abs(arc.length), abs(arc.angle) * body.circumscribed)
    parts, at = int(math.ceil(sweep / distance.resolution)), pose
    for k in range(1, parts + 1):
        at = moved(pose, arc.length * k / parts, arc.angle * k / parts)
        if least_clearance(distance, body, at) >= near:
            continue
        if clearance_slack(closed, body, margin, start, at) < -ROUNDING:
            return False
    for obstacle in around.moving.obstacles:
        away = body.circumscribed + obstacle.radius + rules.config.personal_space
        if math.hypot(obstacle.x - at.x, obstacle.y - at.y) < away:
            return False
    return True


@inner
def settle(node, pose, before, move):
    """Write a pose, the node that it is reached from and the move."""
    node.x, node.y, node.cos, node.sin = pose.x, pose.y, pose.cos, pose.sin
    node.before, node.move, node.is_settled = before, move, 1


@inner
def pose_of(node):
    """The pose of a node."""
    return Pose(node.x, node.y, node.cos, node.sin)


@allocating
def way_to(nodes, last):
    """The way (n, 4) to a node, see ``search_poses``."""
    count, at = 0, last
    while nodes[at].move != FIRST:
        count, at = count + 1, nodes[at].before
    way, at = np.empty((count, 4)), last
    for i in range(count - 1, -1, -1):
        node = nodes[at]
        way[i, 0], way[i, 1], way[i, 2] = node.x, node.y, math.atan2(node.sin, node.cos)
        way[i, 3] = MOVES[node.move].ahead
        at = node.before
    return way


@inner
def arc_of(move, step):
    """The arc of a move whose steps are ``step`` (m) long."""
    return Arc(MOVES[move].ahead * step, MOVES[move].left * TURN)


@njit(cache=True)
def search_poses(scene, rules, state, gain, spare):
    """A way (n, 4) from a state at rest to where the cost-to-go is lower by ``gain`` (m).

    Its rows are poses (x, y, heading) and how the robot comes there from the one before: driving ahead
    (1), backing (-1) or turning on the spot (0). No rows if there is no way that keeps ``spare`` (m)
    beyond the margin. Only a move that is to be made next is checked, since most never are.
    """
    start, cell = state.pose, scene.distance_to_obstacle.resolution
    step, side = STEP * cell, BIN * cell
    per_radian = rules.limits.v_max / rules.limits.omega_max
    target = max(left_from(scene, rules, start) - gain, 2.0 * cell)
    nodes = np.zeros(HEADINGS * ACROSS * ACROSS, NODE)
    heap, checked = [(0.0, 0.0, bin_of(start, start, side), FIRST)], 0
    while len(heap) > 0 and checked < MOST:
        _, cost, at, move = heapq.heappop(heap)
        pose, before = start, at
        if move != FIRST:
            pose, arc = pose_of(nodes[before]), arc_of(move, step)
            end = moved(pose, arc.length, arc.angle)
            at = bin_of(end, start, side)
            if nodes[at].is_settled:
                continue
            checked += 1
            if not is_open(scene, rules, start, pose, arc, spare):
                continue
            pose = end
        settle(nodes[at], pose, before, move)
        if left_from(scene, rules, pose) <= target:
            return way_to(nodes, at)
        for k, (ahead, _) in enumerate(MOVES):
            arc = arc_of(k, step)
            end = moved(pose, arc.length, arc.angle)
            to = bin_of(end, start, side)
            if to < 0 or nodes[to].is_settled or (ahead < 0 and rules.limits.v_min >= 0.0):
                continue
            if not is_on_map(scene.cost_to_go.value, end.x, end.y):
                continue
            more = max(arc.length, -BACKING * arc.length) + abs(arc.angle) * per_radian
            if move != FIRST and MOVES[move].ahead != ahead:
                more += step
            left = max(0.0, left_from(scene, rules, end) - target)
            heapq.heappush(heap, (cost + more + left, cost + more, at, k))
    return np.empty((0, 4))
