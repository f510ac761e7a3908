"""Whether the robot gets on: the cost-to-go has to fall."""

import math

STEP = 0.1  # m by which the cost-to-go has to fall to count
LEAP = 1.0  # m by which it has to fall for the rounds of recovery to start over


class Progress:
    """Remembers the smallest cost-to-go, when it was reached, and the rounds of recovery since."""

    def __init__(self, patience: float) -> None:
        self.patience = patience  # s
        self.reset()

    def reset(self) -> None:
        """A new goal: nothing has been reached yet."""
        self.rounds = 0
        self._least = self._best = math.inf
        self._since: float | None = None

    def restart(self, now: float) -> None:
        """A new path: what it costs is compared with itself only."""
        self._best, self._since = math.inf, now

    def stuck(self, now: float, value: float) -> bool:
        """Takes in the cost-to-go (m) at ``now`` (s); whether it has not fallen for too long."""
        if value < self._best - STEP:
            self._best, self._since = value, now
        if value < self._least - LEAP:
            self._least, self.rounds = value, 0
        if self._since is None:
            self._since = now
        if now - self._since <= self.patience:
            return False
        self.rounds += 1
        self.restart(now)
        return True
