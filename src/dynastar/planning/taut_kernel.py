"""The bend of a string after it is pulled taut round one of its corners.

Let the string come from a, bend at b and go on to c. It can be caught only on convex corners of
blocked cells in the triangle a, b, c. After the pull it leaves a along the first line that touches
such a corner as the line swings from b towards c, and reaches c along the first such line from
there. The two lines meet in a bend nearer to the line a - c; where they touch two corners, a third
line cuts that bend off. A disc's centre keeps the radius from each corner.
"""

import math

import numpy as np

from dynastar.compiled import inner, njit
from dynastar.planning.segments import Bytes, is_clear, norm

CLOSE = 1e-7  # cells further than the radius, for the arithmetic's sake
HERE = 1e-5  # cells; what touches so near to where a line begins does not say where it goes
SHORTER = 1e-3  # cells; less is no gain
LEVEL = 1e-9  # cells; an edge that rises less says nothing of columns
LEFT = -1  # the bend stays as it is

# How many corners the string has in place of b, and the first and the last of them (y, x, y, x).
Bend = tuple[int, float, float, float, float]


@inner
def touches_before(
    ay: float, ax: float, by: float, bx: float, cy: float, cx: float,
    oy: float, ox: float, qy: int, qx: int, side: float, radius: float, uy: float, ux: float,
) -> tuple[bool, float, float]:  # fmt: skip
    """Whether a line from a that swings from b to c touches the corner o before it reaches u.

    u is a unit direction; the unit direction of the touching line is returned, too. ``side`` is 1 if
    the line swings to the left, -1 to the right. From o, the blocked cell lies towards q, and has to
    lie on that side of the line. Only the line's part from a to b - c can touch a corner.
    """
    py, px = oy - ay, ox - ax
    square = py * py + px * px
    along = math.sqrt(max(square - radius * radius, 0.0))
    if along < HERE:
        return False, uy, ux
    ty = (along * py - side * radius * px) / square
    tx = (along * px + side * radius * py) / square
    if side * (ux * ty - uy * tx) >= 0.0 or side * (tx * qy - ty * qx) < 0.0:
        return False, uy, ux
    wy, wx, ey, ex = by - ay, bx - ax, cy - by, cx - bx
    if side * (wx * ty - wy * tx) < -1e-6 * norm(wy, wx):  # outside of a - b
        return False, uy, ux
    across = side * (tx * ey - ty * ex)
    if across <= 0.0 or along * across >= side * (wx * ey - wy * ex):  # beyond b - c
        return False, uy, ux
    return True, ty, tx


@njit(cache=True)
def edge(
    ay: float, ax: float, by: float, bx: float, side: float, r: float
) -> tuple[float, float, float]:
    """The columns inside the edge a - b of a triangle, or up to r outside: slope, lowest, highest.

    In a row y these are the columns from ax + slope (y - ay) + lowest to the same + highest. The
    inside is on the left of the edge if ``side`` is 1, on the right if it is -1.
    """
    dy, dx = by - ay, bx - ax
    if abs(dy) < LEVEL:
        return 0.0, -math.inf, math.inf
    slope = dx / dy
    further = r * math.sqrt(1.0 + slope * slope)
    if side * dy < 0.0:
        return slope, -further, math.inf
    return slope, -math.inf, further


@inner
def convex_corner(blocked: Bytes, row: int, column: int) -> tuple[bool, int, int]:
    """Whether a cell's low corner belongs to a single blocked cell, and the direction to that cell.

    Where two blocked cells touch diagonally, no string can go round the corner that they share.
    """
    low, low_right = np.int64(blocked[row - 1, column - 1]), np.int64(blocked[row - 1, column])
    high, high_right = np.int64(blocked[row, column - 1]), np.int64(blocked[row, column])
    return (
        low + low_right + high + high_right == 1,
        int(high + high_right - low - low_right),
        int(low_right + high_right - low - high),
    )


@inner
def taut_bend(
    blocked: Bytes, ay: float, ax: float, by: float, bx: float, cy: float, cx: float, radius: float
) -> Bend:
    """The bends of the taut string between a and c in place of the one at b; see ``Bend``."""
    wy, wx, vy, vx = by - ay, bx - ax, cy - ay, cx - ax
    turn, length = wx * vy - wy * vx, norm(vy, vx)
    if length < 1e-9 or abs(turn) < 1e-9:
        return 0, 0.0, 0.0, 0.0, 0.0
    side = 1.0 if turn > 0.0 else -1.0
    r = radius + CLOSE
    uy, ux = vy / length, vx / length  # from a, and from c
    ty, tx = -uy, -ux
    oy = ox = qy = qx = 0.0  # what they touch
    caught = False
    rows, columns = blocked.shape
    low, high = (
        max(math.ceil(min(ay, by, cy) - r), 1),
        min(math.floor(max(ay, by, cy) + r), rows - 1),
    )
    left, right = max(min(ax, bx, cx) - r, 1.0), min(max(ax, bx, cx) + r, columns - 1.0)
    slope_a, low_a, high_a = edge(ay, ax, by, bx, side, r)
    slope_b, low_b, high_b = edge(by, bx, cy, cx, side, r)
    slope_c, low_c, high_c = edge(cy, cx, ay, ax, side, r)
    for row in range(low, high + 1):
        x_a, x_b = ax + slope_a * (row - ay), bx + slope_b * (row - by)
        x_c = cx + slope_c * (row - cy)
        first = math.ceil(max(left, x_a + low_a, x_b + low_b, x_c + low_c))
        last = math.floor(min(right, x_a + high_a, x_b + high_b, x_c + high_c))
        for column in range(first, last + 1):
            convex, gy, gx = convex_corner(blocked, row, column)
            if not convex:
                continue
            y, x = float(row), float(column)
            hit, uy, ux = touches_before(ay, ax, by, bx, cy, cx, y, x, gy, gx, side, r, uy, ux)
            if hit:
                oy, ox, caught = y, x, True
            hit, ty, tx = touches_before(cy, cx, by, bx, ay, ax, y, x, gy, gx, -side, r, ty, tx)
            if hit:
                qy, qx, caught = y, x, True
    if not caught:
        return 0, 0.0, 0.0, 0.0, 0.0
    across = ux * ty - uy * tx
    if side * across >= -1e-12:
        return LEFT, 0.0, 0.0, 0.0, 0.0
    s = (vx * ty - vy * tx) / across
    my, mx = ay + s * uy, ax + s * ux
    dy, dx = qy - oy, qx - ox
    apart = norm(dy, dx)
    from_a, from_c = ux * dy - uy * dx, tx * dy - ty * dx
    if apart == 0.0 or abs(from_a) < 1e-9 or abs(from_c) < 1e-9:
        return 1, my, mx, my, mx
    # The line along both corners, on the side of b.
    zy, zx = oy - side * r * dx / apart, ox + side * r * dy / apart
    at_a = ((zx - ax) * dy - (zy - ay) * dx) / from_a
    at_c = ((zx - cx) * dy - (zy - cy) * dx) / from_c
    if 0.0 < at_a < s and 0.0 < at_c < norm(my - cy, mx - cx):
        return 2, ay + at_a * uy, ax + at_a * ux, cy + at_c * ty, cx + at_c * tx
    return 1, my, mx, my, mx


@inner
def by_two(
    ay: float, ax: float, py: float, px: float, qy: float, qx: float, cy: float, cx: float
) -> float:
    """Length of the way from a to c by p and q."""
    length = norm(py - ay, px - ax) + norm(qy - py, qx - px)
    return length + norm(cy - qy, cx - qx)


@inner
def all_clear(
    blocked: Bytes, ay: float, ax: float, py: float, px: float,
    qy: float, qx: float, cy: float, cx: float, radius: float,
) -> bool:  # fmt: skip
    """Whether a disc can go from a to c by p and q, which may be the same point."""
    return (
        is_clear(blocked, ay, ax, py, px, radius)
        and is_clear(blocked, qy, qx, cy, cx, radius)
        and ((py == qy and px == qx) or is_clear(blocked, py, px, qy, qx, radius))
    )


@inner
def pulled_bend(
    blocked: Bytes, ay: float, ax: float, by: float, bx: float, cy: float, cx: float, radius: float
) -> Bend:
    """The bend at b after one pull: shorter, and clear for a disc that can go by b; see ``Bend``.

    Where the taut string is caught by more than two corners, the bend is only cut, and the next pull
    goes on from there. ``LEFT`` comes first if the way does not get shorter.
    """
    now = norm(by - ay, bx - ax) + norm(cy - by, cx - bx)
    how, py, px, qy, qx = taut_bend(blocked, ay, ax, by, bx, cy, cx, radius)
    if how == 0 and is_clear(blocked, ay, ax, cy, cx, radius):
        return how, py, px, qy, qx
    if how > 0:
        if by_two(ay, ax, py, px, qy, qx, cy, cx) > now - SHORTER:
            return LEFT, 0.0, 0.0, 0.0, 0.0
        if all_clear(blocked, ay, ax, py, px, qy, qx, cy, cx, radius):
            return how, py, px, qy, qx
    share = 0.5
    while how > 0 and share > 0.05:
        py, px = by + share * (ay - by), bx + share * (ax - bx)
        qy, qx = by + share * (cy - by), bx + share * (cx - bx)
        if by_two(ay, ax, py, px, qy, qx, cy, cx) > now - SHORTER:
            break
        if all_clear(blocked, ay, ax, py, px, qy, qx, cy, cx, radius):
            return 2, py, px, qy, qx
        share *= 0.5
    return LEFT, 0.0, 0.0, 0.0, 0.0
