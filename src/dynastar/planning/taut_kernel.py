"""The bend of a string after it is pulled taut round one of its corners.

Let the string come from a, bend at b and go on to c. It can be caught only on convex corners of
blocked cells in the triangle a, b, c. After the pull it leaves a along the first line that touches
such a corner as the line swings from b towards c, and reaches c along the first such line from
there. The two lines meet in a bend nearer to the line a - c; where they touch two corners, a third
line cuts that bend off. A disc's centre keeps the radius from each corner.
"""

import math
from typing import NamedTuple

import numpy as np

from dynastar.compiled import inner, njit
from dynastar.planning.segments import Bytes, CellPoint, distance, is_clear, norm

CLOSE = 1e-7  # cells further than the radius, for the arithmetic's sake
HERE = 1e-5  # cells; what touches so near to where a line begins does not say where it goes
SHORTER = 1e-3  # cells; less is no gain
LEVEL = 1e-9  # cells; an edge that rises less says nothing of columns
LEFT = -1  # the bend stays as it is


class Part(NamedTuple):
    """The part of a string that comes from a, bends at b and goes on to c."""

    a: CellPoint
    b: CellPoint
    c: CellPoint


class Bend(NamedTuple):
    """How many points (0 to 2, or ``LEFT``) replace b; the first and the last of them."""

    number: int
    first: CellPoint
    last: CellPoint


class Edge(NamedTuple):
    """The columns of a row y inside an edge a - b of a triangle, or up to a radius outside.

    They go from a.x + slope (y - a.y) + lowest to a.x + slope (y - a.y) + highest.
    """

    slope: float
    lowest: float
    highest: float


class Lines(NamedTuple):
    """The first lines that touch a corner: unit direction and corner of that from a, that from c.

    ``caught`` is false if no line touches anything between a, b and c.
    """

    from_a: CellPoint
    corner_a: CellPoint
    from_c: CellPoint
    corner_c: CellPoint
    caught: bool


@inner
def no_point(number: int) -> Bend:
    """A bend without points of its own; ``number`` is 0 or ``LEFT``."""
    return Bend(number, CellPoint(0.0, 0.0), CellPoint(0.0, 0.0))


@inner
def touches_before(
    part: Part, corner: CellPoint, cell: CellPoint, side: float, radius: float, u: CellPoint
) -> tuple[bool, CellPoint]:
    """Whether a line from a that swings from b to c touches a corner before it reaches u.

    u is a unit direction; the unit direction of the touching line is returned, too. ``side`` is 1 if
    the line swings to the left, -1 to the right. From the corner, the blocked cell lies in direction
    ``cell``, and has to lie on that side of the line. Only the line's part from a to b - c can touch.
    """
    a, b, c = part
    py, px = corner.y - a.y, corner.x - a.x
    square = py * py + px * px
    along = math.sqrt(max(square - radius * radius, 0.0))
    if along < HERE:
        return False, u
    ty = (along * py - side * radius * px) / square
    tx = (along * px + side * radius * py) / square
    if side * (u.x * ty - u.y * tx) >= 0.0 or side * (tx * cell.y - ty * cell.x) < 0.0:
        return False, u
    wy, wx, ey, ex = b.y - a.y, b.x - a.x, c.y - b.y, c.x - b.x
    if side * (wx * ty - wy * tx) < -1e-6 * norm(wy, wx):  # outside of a - b
        return False, u
    across = side * (tx * ey - ty * ex)
    if across <= 0.0 or along * across >= side * (wx * ey - wy * ex):  # beyond b - c
        return False, u
    return True, CellPoint(ty, tx)


@njit(cache=True)
def edge(a: CellPoint, b: CellPoint, side: float, radius: float) -> Edge:
    """The edge a - b of a triangle that lies on its left if ``side`` is 1, on its right if -1."""
    dy, dx = b.y - a.y, b.x - a.x
    if abs(dy) < LEVEL:
        return Edge(0.0, -math.inf, math.inf)
    slope = dx / dy
    further = radius * math.sqrt(1.0 + slope * slope)
    if side * dy < 0.0:
        return Edge(slope, -further, math.inf)
    return Edge(slope, -math.inf, further)


@inner
def convex_corner(blocked: Bytes, row: int, column: int) -> tuple[bool, CellPoint]:
    """Whether a cell's low corner belongs to a single blocked cell, and the direction to that cell.

    Where two blocked cells touch diagonally, no string can go round the corner that they share.
    """
    low, low_right = np.int64(blocked[row - 1, column - 1]), np.int64(blocked[row - 1, column])
    high, high_right = np.int64(blocked[row, column - 1]), np.int64(blocked[row, column])
    convex = low + low_right + high + high_right == 1
    up, right = high + high_right - low - low_right, low_right + high_right - low - high
    return convex, CellPoint(float(up), float(right))


@inner
def first_lines(blocked: Bytes, part: Part, side: float, r: float) -> Lines:
    """The lines that the string leaves a along, and reaches c along, kept ``r`` from each corner."""
    a, b, c = part
    back = Part(c, b, a)
    vy, vx = c.y - a.y, c.x - a.x
    length = norm(vy, vx)
    u, t = CellPoint(vy / length, vx / length), CellPoint(-(vy / length), -(vx / length))
    at_u = at_t = CellPoint(0.0, 0.0)
    caught = False
    rows, columns = blocked.shape
    low = max(math.ceil(min(a.y, b.y, c.y) - r), 1)
    high = min(math.floor(max(a.y, b.y, c.y) + r), rows - 1)
    left, right = max(min(a.x, b.x, c.x) - r, 1.0), min(max(a.x, b.x, c.x) + r, columns - 1.0)
    ab, bc, ca = edge(a, b, side, r), edge(b, c, side, r), edge(c, a, side, r)
    for row in range(low, high + 1):
        x_a, x_b = a.x + ab.slope * (row - a.y), b.x + bc.slope * (row - b.y)
        x_c = c.x + ca.slope * (row - c.y)
        first = math.ceil(max(left, x_a + ab.lowest, x_b + bc.lowest, x_c + ca.lowest))
        last = math.floor(min(right, x_a + ab.highest, x_b + bc.highest, x_c + ca.highest))
        for column in range(first, last + 1):
            convex, cell = convex_corner(blocked, row, column)
            if not convex:
                continue
            corner = CellPoint(float(row), float(column))
            hit, u = touches_before(part, corner, cell, side, r, u)
            if hit:
                at_u, caught = corner, True
            hit, t = touches_before(back, corner, cell, -side, r, t)
            if hit:
                at_t, caught = corner, True
    return Lines(u, at_u, t, at_t, caught)


@inner
def taut_bend(blocked: Bytes, part: Part, radius: float) -> Bend:
    """The bend of the taut string between a and c in place of the one at b."""
    a, b, c = part
    vy, vx = c.y - a.y, c.x - a.x
    turn = (b.x - a.x) * vy - (b.y - a.y) * vx
    if norm(vy, vx) < 1e-9 or abs(turn) < 1e-9:
        return no_point(0)
    side = 1.0 if turn > 0.0 else -1.0
    r = radius + CLOSE
    lines = first_lines(blocked, part, side, r)
    if not lines.caught:
        return no_point(0)
    u, t = lines.from_a, lines.from_c
    across = u.x * t.y - u.y * t.x
    if side * across >= -1e-12:
        return no_point(LEFT)
    s = (vx * t.y - vy * t.x) / across
    meeting = CellPoint(a.y + s * u.y, a.x + s * u.x)
    o = lines.corner_a
    dy, dx = lines.corner_c.y - o.y, lines.corner_c.x - o.x
    apart = norm(dy, dx)
    from_a, from_c = u.x * dy - u.y * dx, t.x * dy - t.y * dx
    if apart == 0.0 or abs(from_a) < 1e-9 or abs(from_c) < 1e-9:
        return Bend(1, meeting, meeting)
    # The line along both corners, on the side of b.
    zy, zx = o.y - side * r * dx / apart, o.x + side * r * dy / apart
    at_a = ((zx - a.x) * dy - (zy - a.y) * dx) / from_a
    at_c = ((zx - c.x) * dy - (zy - c.y) * dx) / from_c
    if 0.0 < at_a < s and 0.0 < at_c < distance(c, meeting):
        first = CellPoint(a.y + at_a * u.y, a.x + at_a * u.x)
        return Bend(2, first, CellPoint(c.y + at_c * t.y, c.x + at_c * t.x))
    return Bend(1, meeting, meeting)


@inner
def length_by(part: Part, bend: Bend) -> float:
    """Length of the way from a to c by the points of a bend."""
    first, last = bend.first, bend.last
    return distance(part.a, first) + distance(first, last) + distance(last, part.c)


@inner
def is_clear_by(blocked: Bytes, part: Part, bend: Bend, radius: float) -> bool:
    """Whether a disc can go from a to c by the points of a bend, which may be the same."""
    first, last = bend.first, bend.last
    return (
        is_clear(blocked, part.a, first, radius)
        and is_clear(blocked, last, part.c, radius)
        and ((first.y == last.y and first.x == last.x) or is_clear(blocked, first, last, radius))
    )


@inner
def pulled_bend(blocked: Bytes, part: Part, radius: float) -> Bend:
    """The bend at b after one pull: shorter, and clear for a disc that can go by b.

    Where the taut string is caught by more than two corners, the bend is only cut, and the next pull
    goes on from there. The bend is ``LEFT`` if the way does not get shorter.
    """
    a, b, c = part
    now = distance(a, b) + distance(b, c)
    bend = taut_bend(blocked, part, radius)
    if bend.number == 0 and is_clear(blocked, a, c, radius):
        return bend
    if bend.number > 0:
        if length_by(part, bend) > now - SHORTER:
            return no_point(LEFT)
        if is_clear_by(blocked, part, bend, radius):
            return bend
    share = 0.5
    while bend.number > 0 and share > 0.05:
        first = CellPoint(b.y + share * (a.y - b.y), b.x + share * (a.x - b.x))
        last = CellPoint(b.y + share * (c.y - b.y), b.x + share * (c.x - b.x))
        bend = Bend(2, first, last)
        if length_by(part, bend) > now - SHORTER:
            break
        if is_clear_by(blocked, part, bend, radius):
            return bend
        share *= 0.5
    return no_point(LEFT)
