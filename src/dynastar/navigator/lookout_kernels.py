"""Kernels of the lookout: lanes that lead out of hiding, and speeds that leave a way out."""

import math

import numpy as np

from dynastar.compiled import njit
from dynastar.obstacles.tracker_kernels import hidden

SIDES = 16  # directions that somebody may come from
PACE = 0.1  # m between the looks along a lane
STEP = 0.2  # s between the looks at who is where


@njit(cache=True)
def across(view, x, y, ux, uy, radius):
    """Whether somebody at (x, y) would be out of sight, and whether something stands there.

    That is asked of the middle and of both sides, ``radius`` (m) across the direction (ux, uy).
    ``view`` is a ``View``.
    """
    free_at, solid, x0, y0, resolution, since = view
    rows, columns = free_at.shape
    unseen, shut = True, False
    for off in (-radius, 0.0, radius):
        row, column = (y + off * ux - y0) / resolution, (x - off * uy - x0) / resolution
        inside = (row >= 0.0) & (row < rows) & (column >= 0.0) & (column < columns)  # one branch
        if not inside:
            return True, True
        r, c = np.uint64(row), np.uint64(column)
        unseen &= free_at[r, c] < since
        shut |= solid[r, c]
    return unseen, shut


@njit(cache=True)
def lanes(path, view, radius, length, farthest):
    """Straight ways (k, 4) out of hiding onto the path's points (n, 2): x, y, and the direction.

    Of each point and side it is the nearest place up to ``farthest`` metres away that hides
    somebody of that ``radius``, who has come straight for ``length`` metres.
    """
    where = (view.free_at, view.x0, view.y0, view.resolution, view.since)
    found = np.empty((SIDES * len(path), 4))
    k = 0
    for i in range(len(path)):
        for side in range(SIDES):
            angle = math.tau * side / SIDES
            ux, uy = math.cos(angle), math.sin(angle)
            d, behind = PACE, -1.0  # m from the path; how much of the lane is known to lie behind
            x = y = 0.0
            while d <= farthest or behind >= 0.0:
                px, py = path[i, 0] + d * ux, path[i, 1] + d * uy
                unseen, shut = across(view, px, py, ux, uy, radius)
                if shut:
                    break
                if behind >= 0.0:
                    behind += PACE
                elif unseen and hidden(px - radius * ux, py - radius * uy, *where):
                    x, y, behind = px, py, 0.0
                if behind >= length:
                    found[k] = x, y, -ux, -uy
                    k += 1
                    break
                d += PACE
    return found[:k]


@njit(cache=True)
def shut_discs(discs, view):
    """Marks the cells under discs (k, 3) x, y, radius as solid."""
    rows, columns = view.solid.shape
    for k in range(len(discs)):
        x, y = (discs[k, 0] - view.x0) / view.resolution, (discs[k, 1] - view.y0) / view.resolution
        reach = discs[k, 2] / view.resolution
        for r in range(max(int(y - reach), 0), min(int(y + reach) + 1, rows)):
            for c in range(max(int(x - reach), 0), min(int(x + reach) + 1, columns)):
                if (r + 0.5 - y) ** 2 + (c + 0.5 - x) ** 2 <= reach * reach:
                    view.solid[r, c] = True


@njit(cache=True)
def lanes_of(newcomers, path, view, radius, farthest):
    """Straight ways (k, 4) as of ``lanes``, of the discs (m, 3) x, y, radius onto the path.

    A way is free from the path to the surface of whoever comes.
    """
    found = np.empty((len(newcomers) * len(path), 4))
    k = 0
    for j in range(len(newcomers)):
        x, y, own = newcomers[j]
        for i in range(len(path)):
            dx, dy = x - path[i, 0], y - path[i, 1]
            length = math.hypot(dx, dy)
            if length > farthest or length < PACE:
                continue
            ux, uy = dx / length, dy / length
            d, shut = PACE, False
            while d < length - max(radius, own) - 2.0 * PACE and not shut:
                _, shut = across(view, path[i, 0] + d * ux, path[i, 1] + d * uy, ux, uy, radius)
                d += PACE
            if not shut:
                found[k] = x, y, -ux, -uy
                k += 1
    return found[:k]


@njit(cache=True)
def touches(lane, path, spacing, v, aim, last, apart, rates, reaction, tail, speed, seconds):
    """Whether who comes down a lane touches a robot that drives along a path from ``v`` (m/s).

    They may be anywhere from the lane's begin to ``tail`` metres behind it, and go at ``speed``.

    At ``rates`` (m/s2, of getting slower and faster) it goes over to ``aim`` (m/s), and after the
    ``reaction`` (s) to ``last``; below 0 it backs, straight, and 0 is the end of it. They touch when
    their centres are less than ``apart`` (m) from each other.
    """
    x, y, ux, uy = lane
    back_x, back_y = path[0, 0] - path[1, 0], path[0, 1] - path[1, 1]
    slower, faster = rates[0] * STEP, rates[1] * STEP
    fastest = max(v, aim, abs(last))
    s = t = 0.0
    while t < seconds:
        t += STEP
        to = aim if t <= reaction else last
        before = v
        v = max(v - slower, to) if v > to else min(v + faster, to)
        if before == v == last == 0.0:
            return False
        s += 0.5 * (before + v) * STEP
        i = int(s / spacing + 0.5)
        if i >= len(path):
            return False
        px, py = path[max(i, 0)]
        if s < 0.0:
            px, py = px - s / spacing * back_x, py - s / spacing * back_y
        dx, dy = px - x, py - y
        ahead = dx * ux + dy * uy - speed * t  # of whoever comes first
        beyond = max(ahead, -tail - ahead, 0.0)
        aside = dx * uy - dy * ux
        square = beyond * beyond + aside * aside
        if square < apart * apart:
            return True
        within = apart + (speed + fastest) * (seconds - t)
        if square > within * within:
            return False
    return False


@njit(cache=True)
def careful(
    found, path, spacing, v, speeds, back, top, apart, spare, rates, reaction, tail, speed, seconds
):
    """The first of ``speeds`` that leaves the robot able to stop or go on, whoever comes; or the last.

    It drives at ``v`` (m/s). Where it may back, at up to ``back`` (m/s), it stops in time if it can
    also back out of their way; to go on it needs ``spare`` metres more. Who would be nearer than
    ``apart`` (m) already, behind a robot that does not see there, say, is so at any speed and is
    left out.
    """
    first = 0  # who could not be avoided at the last speed is asked first about the next
    for aim in speeds:
        fine = True
        for j in range(len(found)):
            k = (first + j) % len(found)
            if math.hypot(found[k, 0] - path[0, 0], found[k, 1] - path[0, 1]) < apart:
                continue
            how = rates, reaction, tail, speed, seconds
            if touches(found[k], path, spacing, v, aim, -back, apart, *how) and touches(
                found[k], path, spacing, v, aim, max(top, aim), apart + spare, *how
            ):
                first, fine = k, False
                break
        if fine:
            return aim
    return speeds[-1]
