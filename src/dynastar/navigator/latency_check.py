"""How long commands take to act, estimated from the commands and the odometry's speeds."""

import math
from collections import deque
from typing import NamedTuple

import numpy as np

from dynastar.geometry import Twist
from dynastar.navigator.status import RobotState
from dynastar.robot import Limits

KEPT_FOR = 6.0  # s of commands and speeds that are compared
EVERY = 1.0  # s between two estimates
LATENCY_STEP, LONGEST_LATENCY = 0.02, 1.0  # s, of the latencies that are tried
LONGER = 0.05  # s by which a latency is longer than declared, at least, to be told
BETTER = 0.5  # of the error with the declared latency, below which another latency is the true one
CLEAR = 0.005  # of the highest speeds: the error that the declared latency leaves, at least


class Entry(NamedTuple):
    """The twist that was measured at a stamp (s), and the command given then."""

    stamp: float
    measured: Twist
    commanded: Twist


class LatencyCheck:
    """Compares the speeds of the last seconds with the commands before them.

    A command is within what the drive can change in a period. So it is reached at the time of the
    next one, later by the latency.
    """

    def __init__(self, limits: Limits, declared: float) -> None:
        self._highest, self._declared = np.array((limits.v_max, limits.omega_max)), declared
        self._log: deque[Entry] = deque()
        self._next = -math.inf
        self.longer: float | None = None  # the latency (s), if it is clearly longer than declared

    def note(self, state: RobotState, command: Twist) -> None:
        """Record a command given in a state."""
        log, now = self._log, state.stamp
        if log and now < log[-1].stamp:
            log.clear()
        elif log and now == log[-1].stamp:
            log.pop()
        log.append(Entry(now, state.twist, command))
        while now - log[0].stamp > KEPT_FOR:
            log.popleft()
        if now >= self._next and now - log[0].stamp > 0.5 * KEPT_FOR:
            self._next, self.longer = now + EVERY, self._estimate()

    def _estimate(self) -> float | None:
        """The latency that explains the speeds best, if it does far better than the declared one."""
        stamps = np.array([entry.stamp for entry in self._log])
        measured = np.array([entry.measured for entry in self._log]) / self._highest
        commanded = np.array([entry.commanded for entry in self._log]) / self._highest
        tried = np.arange(0.0, LONGEST_LATENCY, LATENCY_STEP)
        judged = stamps - stamps[0] > LONGEST_LATENCY
        at = stamps[judged] - tried[:, None]
        error = np.zeros(len(tried))
        for speed, command in zip(measured[judged].T, commanded[:-1].T, strict=True):
            expected = np.interp(at, stamps[1:], command)
            gain = (expected @ speed) / np.maximum((expected**2).sum(axis=1), 1e-9)  # of the drive
            error += np.abs(gain[:, None] * expected - speed).mean(axis=1)
        best, within = int(np.argmin(error)), error[tried <= self._declared + LONGER].min()
        clearly = within > CLEAR and error[best] < BETTER * within
        return float(tried[best]) if clearly else None
