"""Where moving obstacles can be: the only place that says so.

For each hypothesis (it continues, stops, turns back) a moving obstacle has a mean position over time,
with a standard deviation; and there is a hard bound on what it can reach with bounded acceleration.
The deviation grows for about a second only: later changes of the motion are seen in time.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner
from dynastar.config import Field, self_checking
from dynastar.perception.tracking import MovingObstacle
from dynastar.perception.tracking_kernels import REST_SPEED

Floats = npt.NDArray[np.float64]

CONTINUES = 0  # the first hypothesis
WEIGHTS = np.array([0.9, 0.08, 0.02])  # to continue, stop, turn back: see docs/prediction.md
DISCOUNTED = 2.0  # s, least time constant with which a later contact counts for less
STOPPING_RATE = 2.0  # 1/s at which the speed of a moving obstacle that stops decays
OBSTACLE = np.dtype([(name, np.float64) for name in MovingObstacle._fields])
TRACKING_ERROR = 0.05  # m, bound of the error of a tracked position


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


class Times(NamedTuple):
    """The times of a prediction: step k of ``steps`` is ``begin`` + (k + 1) ``step`` seconds from now.

    ``begin`` is when a command acts, ``discounted`` (s) the time constant with which a later contact
    counts for less.
    """

    begin: float
    step: float
    steps: int
    discounted: float = DISCOUNTED


class Prediction(NamedTuple):
    """Predicted moving obstacles at equal steps of time, for kernels.

    ``obstacles`` (m,) has x, y, vx, vy and radius of each as of now. Under hypothesis h and at step k
    obstacle m is at its position plus its velocity times ``travel[h, k]`` (s), with the standard
    deviation ``deviation[m, k]`` (m). ``discount[k]`` is what a contact at step k counts. The hard
    bound: within t seconds an obstacle is no further from its constant-velocity position than
    TRACKING_ERROR + ``acceleration`` t^2 / 2 (m).
    """

    obstacles: npt.NDArray[np.void]
    travel: Floats
    deviation: Floats
    discount: Floats
    acceleration: float


def predict(moving: Sequence[MovingObstacle], config: PredictionConfig, times: Times) -> Prediction:
    """Predict moving obstacles at ``times``."""
    begin, step, steps, _ = times
    after = step * np.arange(1.0, steps + 1.0)
    ahead = begin + after
    stopping = (1.0 - np.exp(-STOPPING_RATE * ahead)) / STOPPING_RATE
    obstacles = np.array([tuple(obstacle[:5]) for obstacle in moving], OBSTACLE)
    speed = np.hypot(obstacles["vx"], obstacles["vy"])
    spread = config.spread * np.minimum(speed / REST_SPEED, 1.0)
    return Prediction(
        obstacles=obstacles,
        travel=np.stack([ahead, stopping, -ahead]),
        deviation=config.error + np.outer(spread, 1.0 - np.exp(-ahead)),
        discount=np.exp(-after / times.discounted),
        acceleration=config.acceleration,
    )


@inner
def contact_probability(gap, deviation):
    """Probability that two discs touch whose predicted gap (m) has a standard deviation (m).

    The normal distribution's tail, by its logistic approximation.
    """
    return 1.0 / (1.0 + math.exp(1.702 * gap / deviation))
