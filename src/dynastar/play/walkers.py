"""People who are put into a live world: they walk to and fro on a line, and can be sent another way."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from dynastar.simulation import Mover
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]
Gaps = Callable[[Floats], Floats]  # metres from points (n, 2) to what stands

RADIUS = 0.25  # m, of a walker who is put in
FAR = 30.0  # m that a walker goes at most before they turn back
STEP = 0.05  # m between the places at which a walker's way is checked
SLOWEST = 0.01  # m/s
SHORT = 0.2  # m of way under which a walker stands
JUMP = 1e-6  # s within which rounding may put a time on either side of a jump


def walker(place: Floats, velocity: Floats, radius: float, now: float, gaps: Gaps) -> Mover:
    """A mover at ``place`` (2,) m who walks with ``velocity`` (2,) m/s as far as there is room.

    They turn back there, walk as far to the other side, and so on. Without room, or slower than
    ``SLOWEST``, they stand.
    """
    speed = math.hypot(*velocity)
    if speed >= SLOWEST:
        onward, back = (_free_way(place, side * velocity / speed, radius, gaps) for side in (1, -1))
        if onward + back >= SHORT:
            ends = [place + onward * velocity / speed, place - back * velocity / speed]
            points = [
                place,
                *(e for e, way in zip(ends, (onward, back), strict=True) if way),
                place,
            ]
            ways = np.hypot(*np.diff(points, axis=0).T)
            times = now + np.concatenate([[0.0], np.cumsum(ways)]) / speed
            return Mover(radius, times, np.array(points), "loop")
    return Mover(radius, np.array([now]), np.array([place]), "stay")


def gone(radius: float) -> Mover:
    """A mover who is not there any more."""
    return Mover(radius, np.array([-1.0]), np.zeros((1, 2)), "vanish")


def from_now(mover: Mover, now: float, rest: float) -> Mover | None:
    """The mover as it goes on from ``now`` (s), which becomes 0; None if it is gone.

    One that goes round and round does so from there; of others the next ``rest`` s are kept.
    """
    movers = Movers([mover])
    times, points = np.asarray(mover.times, np.float64), np.asarray(mover.points, np.float64)
    span, after = times[-1] - times[0], mover.after
    if now <= times[0]:
        return replace(mover, times=times - now)
    if mover.after in ("loop", "back_and_forth") and span > 0.0:
        if mover.after == "back_and_forth":
            times, span = np.concatenate([times, 2.0 * times[-1] - times[-2:0:-1]]), 2.0 * span
            points = np.vstack([points, points[-2:0:-1]])
        else:  # it jumps from the last key to the first
            times = np.append(times[:-1], times[-1] - min(JUMP, 0.5 * (times[-1] - times[-2])))
        rest, after = span, "loop"
        rounds = (now - times[0]) // span + np.arange(2.0)
        times = (times + span * rounds[:, None]).ravel()
        points = np.tile(points, (len(rounds), 1))
    # A jump at ``now`` is over, on whichever side rounding puts it.
    later = (times > now + JUMP) & (times < now + rest)
    times = np.concatenate([[now], times[later], [now + rest]])
    points = np.vstack([movers.at(now + JUMP), points[later], movers.at(now + rest)])
    there = np.isfinite(points[:, 0])
    if not there.any():
        return None
    return Mover(mover.radius, times[there] - now, points[there], after)


def _free_way(place: Floats, along: Floats, radius: float, gaps: Gaps) -> float:
    """Metres from ``place`` in a direction until a disc would touch an obstacle."""
    ways = np.arange(0.0, FAR + STEP, STEP)
    touching = gaps(place + ways[:, None] * along) <= radius
    return float(ways[max(int(touching.argmax()) - 1, 0)] if touching.any() else ways[-1])
