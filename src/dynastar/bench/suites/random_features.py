"""What the static worlds of the suite ``random`` are made of: clutter, walls, doors, pockets."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.bench.suites.random_layout import BOARD, CELL, Layout, Point, aligned, narrow
from dynastar.robot import Robot

Floats = npt.NDArray[np.float64]
Random = np.random.Generator

MAPPED = (0.0, 0.0, 0.4, 0.8)  # fraction of the clutter that the map has


def strew(
    layout: Layout,
    robot: Robot,
    density: float,
    scale: float,
    ends: tuple[Point, Point],
    keep: float = 0.0,
) -> None:
    """Add obstacles until they cover ``density``, ``keep`` m from those there before."""
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


def positions(layout: Layout, count: int) -> list[float]:
    """x of the left sides of ``count`` walls across, in order."""
    part = layout.width / (count + 1)
    shifts = layout.random.uniform(-0.15, 0.1, count)
    return [round((n + 1 + float(shift)) * part / CELL) * CELL for n, shift in enumerate(shifts)]


def thickness(layout: Layout, count: int, robot: Robot, random: Random) -> float:
    """Of a wall (0.1 m) or, in half of the cases, of one that its way makes a corridor of."""
    if random.random() < 0.5:
        return 2 * CELL
    most = 0.3 * layout.width / count
    return aligned(min(float(random.uniform(3.0, 8.0)) * robot.footprint.circumscribed, most))


def wall_across(layout: Layout, x: float, thick: float, doors: list[tuple[float, float]]) -> None:
    """A wall from bottom to top at x with openings from y to y."""
    layout.wall(x, 0.0, x + thick, layout.height)
    for low, high in doors:
        layout.room(x, low, x + thick, high)


def doors_of(layout: Layout, robot: Robot, middle: float) -> list[tuple[float, float]]:
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


def close_door(layout: Layout, x: float, thick: float, door: tuple[float, float]) -> None:
    """An unmapped board somewhere in an opening, from side to side."""
    at = x + float(layout.random.uniform(0.0, 1.0)) * max(thick - BOARD, 0.0)
    layout.board(at, door[0] - 0.01, at + min(BOARD, thick), door[1] + 0.01)


def pocket(layout: Layout, end: Point, depth: float, gap: float, mapped: bool) -> None:
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


def u_shape(depth: float, width: float) -> Floats:
    """A U (8, 2) with its middle at (0, 0) that opens towards -x."""
    x, y = depth / 2, width / 2
    outside = [(-x, -y), (x, -y), (x, y), (-x, y)]
    inside = [(-x, y - BOARD), (x - BOARD, y - BOARD), (x - BOARD, BOARD - y), (-x, BOARD - y)]
    return np.array(outside + inside)


def enclosure(layout: Layout, goal: Point, half: float, mapped: bool) -> None:
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
