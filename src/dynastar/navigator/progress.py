"""Whether the robot makes progress: it has to come to where the cost-to-go is lower."""

import math
from collections.abc import Callable

ADVANCE = (
    0.1  # m by which the robot has to move, and the cost-to-go has to be lower there, to count
)
RESTART = 1.0  # m by which it has to be lower for the rounds of recovery to start over

Point = tuple[float, float]
CostToGoAt = Callable[[float, float], float]


class Progress:
    """Remembers where the robot last made progress, when that was, and the rounds of recovery since.

    Places are compared by the cost-to-go of the moment, because it rises and falls everywhere with
    a new path or a moving obstacle.
    """

    def __init__(self, patience: float) -> None:
        self.patience = patience  # s
        self.reset()

    def reset(self) -> None:
        """A new goal: nothing has been reached yet."""
        self.rounds = self.pathless_rounds = 0
        self._stuck_at: Point | None = None
        self.restart(-math.inf)

    def restart(self, now: float) -> None:
        """Measure from ``now`` on (s), wherever the robot is."""
        self.stops_until: float | None = None  # s, to plan anew then
        self._anchor: Point | None = None
        self._since, self._is_new_path = now, False

    def measure_anew(self) -> None:
        """Another path: the place to compare with may be nearer to the goal now than the robot is.

        The time goes on, so that a robot whose paths replace each other is stuck as well.
        """
        self._is_new_path = True

    def stuck(self, now: float, here: Point, cost_to_go: CostToGoAt | None) -> bool:
        """Whether the robot, ``here`` (m) at ``now`` (s), made no progress for longer than its patience.

        Without a path there is no ``cost_to_go``, and no progress. ``pathless_rounds`` count until the next
        goal: a robot that goes from one closed way to another and back makes no progress.
        """
        if cost_to_go is not None:
            self._compare(now, here, cost_to_go)
        elif self._since == -math.inf:
            self._since = now
        if now - self._since <= self.patience:
            return False
        self.rounds += 1
        self.pathless_rounds += cost_to_go is None
        self._stuck_at = self._stuck_at or here
        self.restart(now)
        return True

    def _compare(self, now: float, here: Point, cost_to_go: CostToGoAt) -> None:
        """Take note of progress since the robot was at the place it is measured from."""
        value = cost_to_go(*here)

        def is_nearer_than(place: Point, by: float) -> bool:
            return math.dist(here, place) > ADVANCE and cost_to_go(*place) - value > by

        if self._stuck_at is not None and is_nearer_than(self._stuck_at, RESTART):
            self._stuck_at, self.rounds = None, 0
        if self._is_new_path and self._anchor is not None:
            self._anchor = here if cost_to_go(*self._anchor) < value else self._anchor
        self._is_new_path = False
        if self._anchor is None or is_nearer_than(self._anchor, ADVANCE):
            if self._anchor is not None or self._since == -math.inf:
                self._since = now
            self._anchor = here
