"""Where moving obstacles may be: the only place that says so.

A track has a mean position over time for each hypothesis (it goes on, stops, turns back), with a
spread, and a hard bound on what it can reach with bounded acceleration. Obstacles turn it back. The
spread grows for about a second only: what a moving obstacle does later, the robot sees in time.
"""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import FAR, DistanceField
from dynastar.compiled import njit
from dynastar.config import Field, self_checking
from dynastar.perception.tracking import MovingObstacle

Floats = npt.NDArray[np.float64]

OPEN_SPACE = DistanceField(np.full((1, 1), FAR, np.float32), 0.0, 0.0, 1.0)
SPEEDS = np.array([1.0, 0.0, -1.0])  # of a track's velocity, by hypothesis
WEIGHTS = np.array([0.7, 0.2, 0.1])


@self_checking
class PredictionConfig(NamedTuple):
    """Settings of the prediction of moving obstacles."""

    acceleration: Annotated[
        float, Field("largest acceleration of a moving obstacle", "m/s2", 0.0, 20.0)
    ] = 1.5
    error: Annotated[float, Field("deviation of a moving obstacle's position", "m", 0.0, 2.0)] = (
        0.08
    )
    spread: Annotated[
        float, Field("what is added to that deviation within a second or two", "m", 0.0, 5.0)
    ] = 0.2
    memory: Annotated[float, Field("time constant that discounts risk", "s", 0.1, 60.0)] = 2.0


class People(NamedTuple):
    """Predicted moving obstacles.

    ``now`` (m, 6): x, y, vx, vy, radius, position error as of now; ``mean`` (m, hypotheses, steps,
    2) m, ``spread`` (steps,) m.
    """

    now: Floats
    mean: Floats
    spread: Floats
    weights: Floats
    acceleration: float
    memory: float


@njit(cache=True)
def clearance_at(walls, x, y):
    """Metres from a point to the nearest obstacle's centre, bilinear; inf outside the field."""
    rows, columns = walls.distance.shape
    fx, fy = (x - walls.x0) / walls.resolution - 0.5, (y - walls.y0) / walls.resolution - 0.5
    if not (0.0 <= fx < columns - 1.0 and 0.0 <= fy < rows - 1.0):
        return np.inf
    c, r = int(fx), int(fy)
    a, b = fx - c, fy - r
    below, above = walls.distance[r], walls.distance[r + 1]
    return (1.0 - b) * ((1.0 - a) * below[c] + a * below[c + 1]) + b * (
        (1.0 - a) * above[c] + a * above[c + 1]
    )


@njit(cache=True)
def reflected(walls, x, y, vx, vy):
    """A velocity reflected by the nearest obstacle: turned back, where it is met head-on."""
    h = walls.resolution
    nx = clearance_at(walls, x + h, y) - clearance_at(walls, x - h, y)
    ny = clearance_at(walls, x, y + h) - clearance_at(walls, x, y - h)
    square = nx * nx + ny * ny
    if not 0.0 < square < np.inf:
        return -vx, -vy
    into = 2.0 * min(0.0, vx * nx + vy * ny) / square
    return vx - into * nx, vy - into * ny


@njit(cache=True)
def positions(now, begin, step, speeds, walls, mean):
    """Writes the mean positions of every hypothesis after ``begin`` + k ``step`` seconds to ``mean``.

    Nobody walks into an obstacle: where a disc would come nearer to one than its radius, its velocity
    is reflected.
    """
    for m in range(mean.shape[0]):
        x0, y0, radius = now[m, 0], now[m, 1], now[m, 4]
        for h in range(mean.shape[1]):
            sign = -1.0 if speeds[h] < 0.0 else 1.0
            x, y, vx, vy = x0, y0, sign * now[m, 2], sign * now[m, 3]
            before, gap = 0.0, clearance_at(walls, x, y)
            for k in range(mean.shape[2]):
                t = begin + (k + 1) * step
                if speeds[h] == 0.0:
                    t = 0.5 * (1.0 - np.exp(-2.0 * t))
                to_x, to_y = x + vx * (t - before), y + vy * (t - before)
                left = clearance_at(walls, to_x, to_y)
                if left < radius and left < gap:
                    vx, vy = reflected(walls, to_x, to_y, vx, vy)
                else:
                    x, y, gap = to_x, to_y, left
                before = t
                mean[m, h, k, 0], mean[m, h, k, 1] = x, y


def predict(
    movers: Sequence[MovingObstacle],
    config: PredictionConfig,
    times: tuple[float, float, int],
    walls: DistanceField = OPEN_SPACE,
) -> People:
    """Predictions at ``times`` (begin, step, steps): ``steps`` of ``step`` seconds from ``begin`` on.

    ``walls`` are distances to the obstacles at rest, which predicted positions do not enter.
    """
    begin, step, steps = times
    now = np.zeros((len(movers), 6))
    for row, mover in zip(now, movers, strict=True):
        row[:5] = mover[:5]
        row[5] = 0.05
    mean = np.empty((len(movers), len(SPEEDS), steps, 2))
    positions(now, begin, step, SPEEDS, walls, mean)
    ahead = begin + step * np.arange(1.0, steps + 1.0)
    spread: Floats = np.asarray(config.error + config.spread * (1.0 - np.exp(-ahead)))
    return People(now, mean, spread, WEIGHTS, config.acceleration, config.memory)
