"""When the commands of a simulated control loop are given."""

import numpy as np

from dynastar.simulation.imperfections import ControlLoop


class LoopTimer:
    """Counts the periods of a loop that is told to run every ``period`` seconds."""

    def __init__(self, loop: ControlLoop, period: float, seed: int) -> None:
        self._period, self._jitter = loop.period or period, loop.jitter
        self._random = np.random.default_rng([seed, 1])
        self._ticks, self._late = 0, 0.0

    def next(self) -> float:
        """Time (s) of the next command; the first is given at 0."""
        self._ticks += 1
        if self._jitter > 0.0:
            self._late += self._random.uniform(0.0, self._jitter)
        return self._ticks * self._period + self._late
