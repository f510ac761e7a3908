"""Exact ray casting: through a grid's cells, against straight edges and against discs."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.compiled import allocating, inner, njit

Floats = npt.NDArray[np.float64]


@inner
def grid_hit(
    free: npt.NDArray[np.int32], x: float, y: float, dx: float, dy: float, limit: float
) -> float:
    """Cells from (x, y) along the unit vector (dx, dy) to a solid cell; inf beyond ``limit``.

    ``free`` is 0 in solid cells, else the chessboard distance to the nearest of them; its outermost
    cells are solid. Where much is free the ray leaps, else it goes cell by cell [Amanatides1987].
    """
    column, row = int(x), int(y)
    reach = 1.0 / max(abs(dx), abs(dy))
    inverse_x = 1.0 / dx if dx != 0.0 else math.inf
    inverse_y = 1.0 / dy if dy != 0.0 else math.inf
    step_x, ahead_x = (1, 1) if dx > 0.0 else (-1, 0)
    step_y, ahead_y = (1, 1) if dy > 0.0 else (-1, 0)
    t = 0.0
    while t <= limit:
        gap = free[row, column]
        if gap == 0:
            return t
        if gap > 2:
            t += (gap - 1) * reach
            column, row = int(x + t * dx), int(y + t * dy)
            continue
        tx = (column + ahead_x - x) * inverse_x if dx != 0.0 else math.inf
        ty = (row + ahead_y - y) * inverse_y if dy != 0.0 else math.inf
        if tx < ty:
            t = tx
            column += step_x
        else:
            t = ty
            row += step_y
    return math.inf


@inner
def edge_hit(x: float, y: float, dx: float, dy: float, edge: Floats) -> float:
    """Metres from (x, y) along (dx, dy) to the edge (x0, y0, x1, y1); inf for a miss."""
    ex, ey = edge[2] - edge[0], edge[3] - edge[1]
    px, py = edge[0] - x, edge[1] - y
    cross = dx * ey - dy * ex
    if cross == 0.0:
        return math.inf
    along = (px * dy - py * dx) / cross
    t = (px * ey - py * ex) / cross
    return t if t >= 0.0 and 0.0 <= along <= 1.0 else math.inf


@inner
def disc_hit(x: float, y: float, dx: float, dy: float, disc: Floats) -> float:
    """Metres from (x, y) along (dx, dy) to the disc (x, y, radius); 0 inside, inf for a miss."""
    px, py = disc[0] - x, disc[1] - y
    ahead = px * dx + py * dy
    outside = px * px + py * py - disc[2] * disc[2]
    if outside <= 0.0:
        return 0.0
    root = ahead * ahead - outside
    if ahead > 0.0 and root >= 0.0:
        return outside / (ahead + math.sqrt(root))
    return math.inf


@allocating
def near_edges(edges: Floats, x: float, y: float, range_max: float) -> npt.NDArray[np.int64]:
    """Numbers of the edges (k, 4) that a beam of ``range_max`` m from (x, y) may hit.

    Edges on the far side of their polygon, seen from (x, y), are left out.
    """
    near = np.empty(len(edges), np.int64)
    n = 0
    for k in range(len(edges)):
        x0, y0, x1, y1 = edges[k]
        if (x1 - x0) * (y - y0) > (y1 - y0) * (x - x0):
            continue
        reach = 0.5 * math.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2) + range_max
        if (0.5 * (x0 + x1) - x) ** 2 + (0.5 * (y0 + y1) - y) ** 2 <= reach * reach:
            near[n] = k
            n += 1
    return near[:n]


@allocating
def near_discs(discs: Floats, x: float, y: float, range_max: float) -> npt.NDArray[np.int64]:
    """Numbers of the discs (m, 3) that a beam of ``range_max`` m from (x, y) may hit."""
    near = np.empty(len(discs), np.int64)
    n = 0
    for k in range(len(discs)):
        if math.hypot(discs[k, 0] - x, discs[k, 1] - y) <= discs[k, 2] + range_max:
            near[n] = k
            n += 1
    return near[:n]


@inner
def cast_at_edge(
    edge: Floats,
    sensor: tuple[float, float, float],
    increment: float,
    dxs: Floats,
    dys: Floats,
    out: Floats,
) -> None:
    """Shortens the beams ``out`` (n,) m, in the directions (dxs, dys), that hit an edge.

    Only the beams within the angle that the edge takes up are tried, and one more on either side.
    """
    x, y, first = sensor
    begin = math.atan2(edge[1] - y, edge[0] - x)
    turn = math.atan2(edge[3] - y, edge[2] - x) - begin
    turn -= math.tau * math.floor(turn / math.tau + 0.5)
    low = (begin + min(turn, 0.0) - first) % math.tau
    for start in (low, low - math.tau):
        i0 = max(0, int(math.floor(start / increment)) - 1)
        i1 = min(len(out) - 1, int(math.ceil((start + abs(turn)) / increment)) + 1)
        for i in range(i0, i1 + 1):
            out[i] = min(out[i], edge_hit(x, y, dxs[i], dys[i], edge))


@njit(cache=True)
def cast(
    free: npt.NDArray[np.int32],
    frame: tuple[float, float, float, float],
    edges: Floats,
    discs: Floats,
    sensor: tuple[float, float, float],
    beams: tuple[float, float],
    out: Floats,
) -> None:
    """Writes metres to the nearest hit of every beam to ``out`` (n,), inf beyond the range.

    ``free`` as in ``grid_hit``, one cell wider on every side than the grid at ``frame``
    (resolution, x, y, yaw); ``edges`` (k, 4), anticlockwise round their polygons, and ``discs`` (m, 3)
    in the map frame, metres.
    ``sensor`` is x, y and the direction of beam 0, ``beams`` their increment (rad) and range (m); a
    sensor off the grid reads 0.
    """
    resolution, yaw = frame[0], frame[3]
    x, y, first = sensor
    increment, range_max = beams
    cos, sin = math.cos(yaw), math.sin(yaw)
    gx = 1.0 + (cos * (x - frame[1]) + sin * (y - frame[2])) / resolution
    gy = 1.0 + (cos * (y - frame[2]) - sin * (x - frame[1])) / resolution
    if not (1.0 <= gx < free.shape[1] - 1 and 1.0 <= gy < free.shape[0] - 1):
        out[:] = 0.0
        return
    discs_near = near_discs(discs, x, y, range_max)
    dxs, dys = np.empty(len(out)), np.empty(len(out))
    for i in range(len(out)):
        angle = first + i * increment
        dx, dy = math.cos(angle), math.sin(angle)
        dxs[i], dys[i] = dx, dy
        hit = resolution * grid_hit(
            free, gx, gy, cos * dx + sin * dy, cos * dy - sin * dx, range_max / resolution
        )
        for k in discs_near:
            hit = min(hit, disc_hit(x, y, dx, dy, discs[k]))
        out[i] = hit
    for k in near_edges(edges, x, y, range_max):
        cast_at_edge(edges[k], sensor, increment, dxs, dys, out)
    for i in range(len(out)):
        if not out[i] <= range_max:
            out[i] = math.inf
