"""Ways out when the robot is stuck, the gentlest first."""

import math

from dynastar.navigator.config import NavigatorConfig

STEPS = ("turn", "back off", "forget", "replan")
LASTING = {"turn": 4.0, "back off": 2.0}  # s that a step drives the robot


class Recovery:
    """Goes through turn, back off, forget, replan; starts over, and gives up after some rounds."""

    def __init__(self, config: NavigatorConfig) -> None:
        self.config = config
        self.reset()

    def reset(self) -> None:
        """As if nothing had been tried."""
        self.step = ""
        self.reason = ""
        self._tried = 0
        self._until = -math.inf
        self._forgot = self._replanned = -math.inf
        self._calm_since = math.inf

    def active(self, now: float) -> bool:
        """Whether a step is driving the robot."""
        return now < self._until

    def progressed(self, now: float) -> None:
        """The robot gets on; after a while of that the rounds count anew."""
        self._calm_since = min(self._calm_since, now)
        if now - self._calm_since > 10.0:
            self._tried = 0

    def give_up(self) -> bool:
        """Whether every round is used up."""
        return self._tried >= self.config.attempts * len(STEPS)

    def next(self, now: float, may_reverse: bool) -> str:
        """The next step to take, by name."""
        self._calm_since = math.inf
        self.step = STEPS[self._tried % len(STEPS)]
        self._tried += 1
        if self.step == "back off" and not may_reverse:
            self.step = STEPS[self._tried % len(STEPS)]
            self._tried += 1
        self._until = now + LASTING.get(self.step, 0.0)
        self.reason = f"recovery: {self.step}"
        return self.step

    def may_replan(self, now: float) -> bool:
        """Whether it is time for another plan that nothing blocked; every few seconds at most."""
        if now - self._replanned < 3.0:
            return False
        self._replanned = now
        return True

    def may_forget(self, now: float) -> bool:
        """Whether what was seen may be forgotten because no way is left; every few seconds at most."""
        if now - self._forgot < 3.0:
            return False
        self._forgot = now
        self._tried += len(STEPS)
        return True
