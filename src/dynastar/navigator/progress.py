"""Is the robot getting anywhere?"""

import math

DWELLING = 1.0  # m from where it was first that a robot stays


class Progress:
    """Notes when the robot last came nearer to its goal, along the path or by turning to the target."""

    def __init__(self) -> None:
        self.since = self._seen = -math.inf
        self._left = self._off = math.inf
        self._anchor, self._anchored = (math.inf, math.inf), -math.inf

    def restart(self, now: float) -> None:
        """Counts from ``now``, whatever was reached before."""
        self.since = now
        self._left = self._off = math.inf
        self._seen = now

    def rebase(self) -> None:
        """Another path: what is left is measured along that, the clock goes on."""
        self._left = self._off = math.inf

    def note_sight(self, now: float, seen: bool) -> None:
        """Takes in whether the path can be seen."""
        if seen:
            self._seen = now

    def unseen(self, now: float, patience: float) -> bool:
        """Whether the path was out of sight for longer than ``patience`` seconds."""
        return now - self._seen > patience

    def note(self, now: float, left: float, off: float) -> bool:
        """Takes in metres ``left`` and radians ``off`` the target; whether either got better."""
        if self._left == math.inf:
            self._left, self._off = left, abs(off)
        if left < self._left - 0.1:
            self._left, self._off = left, abs(off)
            self.since = now
            return True
        if abs(off) < self._off - 0.2:
            self._off = abs(off)
            self.since = now
        return False

    def dwells(self, now: float, position: tuple[float, float], patience: float) -> bool:
        """Whether the robot stays within a metre for longer than ``patience`` seconds."""
        if math.dist(position, self._anchor) > DWELLING:
            self._anchor, self._anchored = position, now
        return now - self._anchored > patience

    def stuck(self, now: float, patience: float) -> bool:
        """Whether nothing got better for longer than ``patience`` seconds."""
        return now - self.since > patience
