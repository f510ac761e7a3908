"""Where moving obstacles may be: the only place that says so.

A track has a mean position over time for each hypothesis (it goes on, stops, turns back), with a
spread that grows, and a hard bound on what it can reach with bounded acceleration.
"""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.config import Field, self_checking
from dynastar.perception.tracking import MovingObstacle

Floats = npt.NDArray[np.float64]

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
    spread: Annotated[float, Field("growth of that deviation with time", "m/s", 0.0, 5.0)] = 0.2
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
def positions(now, begin, step, speeds, mean):
    """Writes the mean positions of every hypothesis after ``begin`` + k ``step`` seconds to ``mean``."""
    for m in range(mean.shape[0]):
        for h in range(mean.shape[1]):
            for k in range(mean.shape[2]):
                t = begin + (k + 1) * step
                if speeds[h] == 0.0:
                    t = 0.5 * (1.0 - np.exp(-2.0 * t))
                    mean[m, h, k, 0] = now[m, 0] + now[m, 2] * t
                    mean[m, h, k, 1] = now[m, 1] + now[m, 3] * t
                else:
                    mean[m, h, k, 0] = now[m, 0] + speeds[h] * now[m, 2] * t
                    mean[m, h, k, 1] = now[m, 1] + speeds[h] * now[m, 3] * t


def predict(
    movers: Sequence[MovingObstacle],
    config: PredictionConfig,
    begin: float,
    step: float,
    steps: int,
) -> People:
    """Predictions from ``begin`` seconds on, every ``step`` seconds."""
    now = np.zeros((len(movers), 6))
    for row, mover in zip(now, movers, strict=True):
        row[:5] = mover[:5]
        row[5] = 0.05
    mean = np.empty((len(movers), len(SPEEDS), steps, 2))
    positions(now, begin, step, SPEEDS, mean)
    times = begin + step * np.arange(1.0, steps + 1.0)
    spread: Floats = np.asarray(config.error + config.spread * times, dtype=np.float64)
    return People(now, mean, spread, WEIGHTS, config.acceleration, config.memory)
