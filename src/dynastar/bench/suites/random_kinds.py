"""The kinds of static worlds that the suite ``random`` draws from.

``ROBOT_SCALES`` says how large a robot's worlds are; every kind is a function of a robot and a random
generator that returns a ``StaticWorld``. What a kind is meant to be is checked afterwards, see
``random_truth``.
"""

import math
from collections.abc import Callable

import numpy as np

from dynastar.bench.suites.random_features import (
    close_door,
    doors_of,
    enclosure,
    pocket,
    positions,
    strew,
    thickness,
    u_shape,
    wall_across,
)
from dynastar.bench.suites.random_layout import (
    BOARD,
    CELL,
    Layout,
    Point,
    StaticWorld,
    aligned,
    narrow,
    turned,
)
from dynastar.robot import Robot

Random = np.random.Generator

# Width and height of a world (m), and how large its furniture is.
ROBOT_SCALES: dict[str, tuple[float, float, float]] = {
    "turtlebot3_burger": (7.0, 5.5, 0.6),
    "pioneer3dx": (12.0, 9.0, 1.0),
    "jackal": (14.0, 10.0, 1.0),
}
DENSITY = (0.03, 0.20)  # of the area, covered by clutter


def clutter(robot: Robot, random: Random) -> StaticWorld:
    """Boxes, polygons and cylinders all over, of which the map has some or none."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    strew(layout, robot, float(random.uniform(*DENSITY)), scale, (start, goal))
    return layout.finished((*start, None), goal)


def narrows(robot: Robot, random: Random) -> StaticWorld:
    """One to three walls across, each with a way through that is barely wider than the robot.

    The wall is thin (a doorway) or thick (a corridor). Half of the ways are so narrow on the map, the
    others are wide there and narrowed by unmapped boards.
    """
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    count = int(random.integers(1, 4))
    room = 2.5 * robot.footprint.circumscribed
    for x in positions(layout, count):
        thick = thickness(layout, count, robot, random)
        gap = narrow(robot.footprint, random)
        y = float(random.uniform(0.2, 0.8) * layout.height)
        if random.random() < 0.5:
            gap = aligned(gap)
            low = round((y - gap / 2) / CELL) * CELL
            wall_across(layout, x, thick, [(low, low + gap)])
        else:
            spare = aligned(float(random.uniform(0.2, 0.6)))
            low = round((y - gap / 2 - spare) / CELL) * CELL
            wall_across(layout, x, thick, [(low, low + aligned(gap) + 2 * spare)])
            layout.board(x, low, x + thick, low + spare)
            layout.board(x, low + spare + gap, x + thick, low + aligned(gap) + 2 * spare)
    strew(layout, robot, 0.02, scale, (start, goal), keep=2.0 * room)
    return layout.finished((*start, None), goal)


def dead_end(robot: Robot, random: Random) -> StaticWorld:
    """The robot stands nose first in a pocket barely wider than itself, or finds one on its way."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    gap, reach = narrow(robot.footprint, random), robot.footprint.circumscribed
    depth = float(random.uniform(3.0, 7.0)) * reach
    if random.random() < 0.5:
        away = float(random.uniform(0.3, 0.5)) * layout.width
        y = float(random.uniform(0.3, 0.7)) * layout.height
        pocket(layout, (away, y), depth, gap, mapped=bool(random.random() < 0.5))
        begin = (away - BOARD - reach - 0.15, y)
        strew(layout, robot, 0.02, scale, (begin, goal), keep=depth + 2.0 * reach)
        return layout.finished((*begin, 0.0), goal)
    along = float(random.uniform(0.45, 0.6))
    x, y = (start[i] + along * (goal[i] - start[i]) for i in (0, 1))
    pocket(layout, (x + depth / 2, y), depth, gap, mapped=False)
    return layout.finished((*start, None), goal)


def u_trap(robot: Robot, random: Random) -> StaticWorld:
    """One or two unmapped U-shaped walls on the way that open towards the robot."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    bearing = math.atan2(goal[1] - start[1], goal[0] - start[0])
    reach = robot.footprint.circumscribed
    count = int(random.integers(1, 3))
    for number in range(count):
        along = (number + 0.75) / (count + 0.3) * math.dist(start, goal)
        middle = np.add(start, along * np.array([math.cos(bearing), math.sin(bearing)]))
        depth = float(random.uniform(1.0, 2.7)) * scale
        depth = min(depth, 0.8 * (math.dist(start, goal) / (count + 0.3)) - 2.5 * reach)
        width = min(float(random.uniform(1.7, 4.0)) * scale, 0.55 * layout.height)
        ring = u_shape(depth, width)
        turn = bearing + float(random.uniform(-0.35, 0.35))
        layout.unmapped(turned(ring, turn) + middle)
    return layout.finished((*start, None), goal)


def blocked_way(robot: Robot, random: Random) -> StaticWorld:
    """A wall with two doors: an unmapped board closes the one on the shorter way."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    x, thick = float(random.uniform(0.4, 0.6)) * layout.width, thickness(layout, 1, robot, random)
    doors = doors_of(layout, robot, 0.5 * (start[1] + goal[1]))
    wall_across(layout, x, thick, doors)
    close_door(layout, x, thick, doors[0])
    keep = 5.0 * robot.footprint.circumscribed
    strew(layout, robot, 0.02, scale, (start, goal), keep=keep)
    return layout.finished((*start, None), goal)


def unreachable(robot: Robot, random: Random) -> StaticWorld:
    """Goal in an enclosure that unmapped boards close, or behind a wall whose doors all are closed."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    form, points = int(random.integers(3)), (start, goal)
    if form == 0:
        x = float(random.uniform(0.4, 0.6)) * layout.width
        thick, middle = thickness(layout, 1, robot, random), 0.5 * (start[1] + goal[1])
        doors = doors_of(layout, robot, middle)
        wall_across(layout, x, thick, doors)
        for door in doors:
            close_door(layout, x, thick, door)
        strew(layout, robot, 0.02, scale, points, keep=5.0 * robot.footprint.circumscribed)
        return layout.finished((*start, None), goal, reachable=False)
    half = float(random.uniform(1.8, 3.0)) * robot.footprint.circumscribed + 0.5
    goal = (min(goal[0], layout.width - half - 0.4), goal[1])
    goal = (goal[0], min(max(goal[1], half + 0.4), layout.height - half - 0.4))
    enclosure(layout, goal, half, mapped=form == 1)
    strew(layout, robot, 0.02, scale, points, keep=half * 1.5 + 0.3)
    return layout.finished((*start, None), goal, reachable=False)


KINDS: dict[str, Callable[[Robot, Random], StaticWorld]] = {
    "clutter": clutter,
    "narrow_ways": narrows,
    "dead_end": dead_end,
    "u_trap": u_trap,
    "blocked_way": blocked_way,
    "unreachable": unreachable,
}


def _layout(robot: Robot, random: Random) -> tuple[Layout, float]:
    width, height, scale = ROBOT_SCALES.get(robot.name) or _scales(robot)
    stretch = random.uniform(0.85, 1.15, 2)
    return Layout(width * stretch[0], height * stretch[1], random), scale


def _scales(robot: Robot) -> tuple[float, float, float]:
    """The scales of another robot, by its size beside the Pioneer's, whose radius is 0.25 m."""
    scale = max(0.6, robot.footprint.circumscribed / 0.25)
    return 12.0 * scale, 9.0 * scale, scale


def _ends(layout: Layout, robot: Robot) -> tuple[Point, Point]:
    """A start near the left wall and a goal near the right one."""
    keep = robot.footprint.circumscribed + 0.3
    low, high = keep + 0.1, layout.height - keep - 0.1
    y = layout.random.uniform(low, high, 2)
    inset = layout.random.uniform(keep, keep + 0.5, 2)
    return (float(inset[0]) + 0.1, float(y[0])), (layout.width - 0.1 - float(inset[1]), float(y[1]))
