"""The kinds of static worlds that the suite ``random`` draws from.

``ROBOT_SCALES`` says how large a robot's worlds are; every kind is a function of a robot and a random
generator that returns a ``StaticWorld``. What a kind is meant to be is checked afterwards, see
``random_truth``.
"""

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

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

Floats = npt.NDArray[np.float64]
Random = np.random.Generator

# Width and height of a world (m), and how large its furniture is.
ROBOT_SCALES: dict[str, tuple[float, float, float]] = {
    "turtlebot3_burger": (7.0, 5.5, 0.6),
    "pioneer3dx": (12.0, 9.0, 1.0),
    "jackal": (14.0, 10.0, 1.0),
}
DENSITY = (0.03, 0.20)  # of the area, covered by clutter
MAPPED = (0.0, 0.0, 0.4, 0.8)  # fraction of the clutter that the map has


def clutter(robot: Robot, random: Random) -> StaticWorld:
    """Boxes, polygons and cylinders all over, of which the map has some or none."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    _strew(layout, robot, float(random.uniform(*DENSITY)), scale, (start, goal))
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
    for x in _positions(layout, count):
        thick = _thickness(layout, count, robot, random)
        gap = narrow(robot.footprint, random)
        y = float(random.uniform(0.2, 0.8) * layout.height)
        if random.random() < 0.5:
            gap = aligned(gap)
            low = round((y - gap / 2) / CELL) * CELL
            _wall_across(layout, x, thick, [(low, low + gap)])
        else:
            spare = aligned(float(random.uniform(0.2, 0.6)))
            low = round((y - gap / 2 - spare) / CELL) * CELL
            _wall_across(layout, x, thick, [(low, low + aligned(gap) + 2 * spare)])
            layout.board(x, low, x + thick, low + spare)
            layout.board(x, low + spare + gap, x + thick, low + aligned(gap) + 2 * spare)
    _strew(layout, robot, 0.02, scale, (start, goal), keep=2.0 * room)
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
        _pocket(layout, (away, y), depth, gap, mapped=bool(random.random() < 0.5))
        begin = (away - BOARD - reach - 0.15, y)
        _strew(layout, robot, 0.02, scale, (begin, goal), keep=depth + 2.0 * reach)
        return layout.finished((*begin, 0.0), goal)
    along = float(random.uniform(0.45, 0.6))
    x, y = (start[i] + along * (goal[i] - start[i]) for i in (0, 1))
    _pocket(layout, (x + depth / 2, y), depth, gap, mapped=False)
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
        ring = _u_shape(depth, width)
        turn = bearing + float(random.uniform(-0.35, 0.35))
        layout.unmapped(turned(ring, turn) + middle)
    return layout.finished((*start, None), goal)


def blocked_way(robot: Robot, random: Random) -> StaticWorld:
    """A wall with two doors: an unmapped board closes the one on the shorter way."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    x, thick = float(random.uniform(0.4, 0.6)) * layout.width, _thickness(layout, 1, robot, random)
    doors = _doors(layout, robot, 0.5 * (start[1] + goal[1]))
    _wall_across(layout, x, thick, doors)
    _close(layout, x, thick, doors[0])
    keep = 5.0 * robot.footprint.circumscribed
    _strew(layout, robot, 0.02, scale, (start, goal), keep=keep)
    return layout.finished((*start, None), goal)


def unreachable(robot: Robot, random: Random) -> StaticWorld:
    """Goal in an enclosure that unmapped boards close, or behind a wall whose doors all are closed."""
    layout, scale = _layout(robot, random)
    start, goal = _ends(layout, robot)
    form, points = int(random.integers(3)), (start, goal)
    if form == 0:
        x = float(random.uniform(0.4, 0.6)) * layout.width
        thick, middle = _thickness(layout, 1, robot, random), 0.5 * (start[1] + goal[1])
        doors = _doors(layout, robot, middle)
        _wall_across(layout, x, thick, doors)
        for door in doors:
            _close(layout, x, thick, door)
        _strew(layout, robot, 0.02, scale, points, keep=5.0 * robot.footprint.circumscribed)
        return layout.finished((*start, None), goal, reachable=False)
    half = float(random.uniform(1.8, 3.0)) * robot.footprint.circumscribed + 0.5
    goal = (min(goal[0], layout.width - half - 0.4), goal[1])
    goal = (goal[0], min(max(goal[1], half + 0.4), layout.height - half - 0.4))
    _enclosure(layout, goal, half, mapped=form == 1)
    _strew(layout, robot, 0.02, scale, points, keep=half * 1.5 + 0.3)
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
    width, height, scale = ROBOT_SCALES[robot.name]
    stretch = random.uniform(0.85, 1.15, 2)
    return Layout(width * stretch[0], height * stretch[1], random), scale


def _ends(layout: Layout, robot: Robot) -> tuple[Point, Point]:
    """A start near the left wall and a goal near the right one."""
    keep = robot.footprint.circumscribed + 0.3
    low, high = keep + 0.1, layout.height - keep - 0.1
    y = layout.random.uniform(low, high, 2)
    inset = layout.random.uniform(keep, keep + 0.5, 2)
    return (float(inset[0]) + 0.1, float(y[0])), (layout.width - 0.1 - float(inset[1]), float(y[1]))


def _strew(
    layout: Layout,
    robot: Robot,
    density: float,
    scale: float,
    ends: tuple[Point, Point],
    keep: float = 0.0,
) -> None:
    """Things until they cover ``density``; ``keep`` m between the things and what stands already."""
    random, covered = layout.random, 0.0
    known = float(random.choice(MAPPED))
    room = robot.footprint.circumscribed + 0.15
    standing = _standing_points(layout) if keep else np.empty((0, 2))
    for _ in range(400):
        if covered >= density * layout.width * layout.height:
            return
        ring = layout.thing(scale) + random.uniform((0, 0), (layout.width, layout.height))
        middle = ring.mean(axis=0)
        if not layout.clear_of(ring, ends, room):
            continue
        if keep and np.hypot(*(standing - middle).T).min(initial=math.inf) < keep:
            continue
        covered += _area(ring)
        if random.random() < known:
            layout.mapped(ring)
        else:
            layout.unmapped(ring)


def _standing_points(layout: Layout) -> Floats:
    """Points of inner walls and obstacles."""
    inner = layout.occupied.copy()
    inner[[0, 1, -2, -1]] = False
    inner[:, [0, 1, -2, -1]] = False
    cells = (np.argwhere(inner)[:, ::-1] + 0.5) * CELL
    return np.vstack([cells, *layout.obstacles])


def _area(ring: Floats) -> float:
    x, y = ring.T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def _positions(layout: Layout, count: int) -> list[float]:
    """x of the left sides of ``count`` walls across, in order."""
    part = layout.width / (count + 1)
    shifts = layout.random.uniform(-0.15, 0.1, count)
    return [round((n + 1 + float(shift)) * part / CELL) * CELL for n, shift in enumerate(shifts)]


def _thickness(layout: Layout, count: int, robot: Robot, random: Random) -> float:
    """Of a wall (0.1 m) or, in half of the cases, of one that its way makes a corridor of."""
    if random.random() < 0.5:
        return 2 * CELL
    most = 0.3 * layout.width / count
    return aligned(min(float(random.uniform(3.0, 8.0)) * robot.footprint.circumscribed, most))


def _wall_across(layout: Layout, x: float, thick: float, doors: list[tuple[float, float]]) -> None:
    """A wall from bottom to top at x with openings from y to y."""
    layout.wall(x, 0.0, x + thick, layout.height)
    for low, high in doors:
        layout.room(x, low, x + thick, high)


def _doors(layout: Layout, robot: Robot, middle: float) -> list[tuple[float, float]]:
    """Two doors, from y to y, the first nearer to ``middle``; a third of them is narrow."""
    random, reach = layout.random, robot.footprint.circumscribed
    doors = []
    upwards = middle < layout.height / 2
    for number in (0, 1):
        wide = aligned(float(random.uniform(3.0, 5.0)) * reach)
        if random.random() < 1 / 3:
            wide = aligned(narrow(robot.footprint, random))
        y = middle if number == 0 else (0.9 if upwards else 0.1) * layout.height
        y = min(max(y, wide / 2 + 0.3), layout.height - wide / 2 - 0.3)
        low = round((y - wide / 2) / CELL) * CELL
        doors.append((low, low + wide))
    return doors


def _close(layout: Layout, x: float, thick: float, door: tuple[float, float]) -> None:
    """An unmapped board somewhere in an opening, from side to side."""
    at = x + float(layout.random.uniform(0.0, 1.0)) * max(thick - BOARD, 0.0)
    layout.board(at, door[0] - 0.01, at + min(BOARD, thick), door[1] + 0.01)


def _pocket(layout: Layout, end: Point, depth: float, gap: float, mapped: bool) -> None:
    """Three sides round a pocket: its end is at ``end``, and it opens to the left."""
    x, y = end
    sides = [
        (x - depth, y - gap / 2 - BOARD, x, y - gap / 2),
        (x - depth, y + gap / 2, x, y + gap / 2 + BOARD),
        (x - BOARD, y - gap / 2, x, y + gap / 2),
    ]
    for x0, y0, x1, y1 in sides:
        if mapped:  # outwards to whole cells, so that the pocket stays as wide as it should be
            x0, y0 = math.floor(x0 / CELL) * CELL, math.floor(y0 / CELL) * CELL
            x1, y1 = math.ceil(x1 / CELL) * CELL, math.ceil(y1 / CELL) * CELL
            if y0 < y - gap / 2 < y1 and y1 <= y:
                y1 = math.floor((y - gap / 2) / CELL) * CELL
            if y0 < y + gap / 2 < y1 and y0 >= y:
                y0 = math.ceil((y + gap / 2) / CELL) * CELL
            layout.wall(x0, y0, x1, y1)
        else:
            layout.board(x0, y0, x1, y1)


def _u_shape(depth: float, width: float) -> Floats:
    """A U (8, 2) with its middle at (0, 0) that opens towards -x."""
    x, y = depth / 2, width / 2
    outside = [(-x, -y), (x, -y), (x, y), (-x, y)]
    inside = [(-x, y - BOARD), (x - BOARD, y - BOARD), (x - BOARD, BOARD - y), (-x, BOARD - y)]
    return np.array(outside + inside)


def _enclosure(layout: Layout, goal: Point, half: float, mapped: bool) -> None:
    """Four sides round a goal: boards, or mapped walls of which a board closes one opening."""
    x, y = goal
    low_x, high_x, low_y, high_y = x - half, x + half, y - half, y + half
    sides = [
        (low_x - BOARD, low_y - BOARD, low_x, high_y + BOARD),
        (high_x, low_y - BOARD, high_x + BOARD, high_y + BOARD),
        (low_x, low_y - BOARD, high_x, low_y),
        (low_x, high_y, high_x, high_y + BOARD),
    ]
    opening = int(layout.random.choice([0, 2, 3])) if mapped else -1
    for number, side in enumerate(sides):
        if mapped and number != opening:
            layout.wall(side[0] - CELL, side[1] - CELL, side[2] + CELL, side[3] + CELL)
        else:
            layout.board(*side)
