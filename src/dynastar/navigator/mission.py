"""The mission: its goals in order, and its state machine."""

import logging
from collections.abc import Sequence

from dynastar.dwa.dwa import Choice
from dynastar.errors import PlanningError
from dynastar.geometry import Goal
from dynastar.navigator.status import State

log = logging.getLogger("dynastar")

STANDING = 0.02  # m/s up to which the robot is said to wait
OVER = ("idle", "arrived", "blocked")


class Mission:
    """The goals, the state of the mission and its reason.

    A mission is under way ("following", "avoiding", "waiting", "turning", "recovering") until it is
    over ("arrived", "blocked", or "idle" without a goal), and then stays so until the next begins.
    "sensor_lost" lies on top of either: when data are back, it is what it was before.
    """

    def __init__(self) -> None:
        self.recoveries = 0
        self.begin([], "no goal")

    @property
    def under_way(self) -> bool:
        """Whether there is a goal to drive to."""
        return self.state not in OVER and bool(self.goals)

    def is_under_way_to(self, goals: Sequence[Goal]) -> bool:
        """Whether the mission is under way to just these goals."""
        return self.under_way and not self.is_blocked and list(goals) == self.goals

    def begin(self, goals: Sequence[Goal], reason: str) -> None:
        """Begin a mission to ``goals``; without goals it is idle."""
        self.goals, self.reason = list(goals), reason
        self.state: State = "following" if goals else "idle"
        self.error: PlanningError | None = None
        self._before: tuple[State, str] | None = None  # what it was when data were lost

    def say(self, state: State, reason: str) -> None:
        """Set the state while the mission is under way."""
        if self.state not in OVER:
            self.state, self.reason = state, reason

    def say_driving(self, choice: Choice, moving: bool, waits_because: str) -> None:
        """Set the state of a robot that drives, or waits: for a path if ``waits_because`` says so.

        ``moving`` tells whether there are moving obstacles.
        """
        standing = choice.command is None or abs(choice.command.v) < STANDING
        if waits_because:
            self.say("waiting", waits_because)
        elif moving and standing:
            self.say("waiting", "a moving obstacle passes")
        elif choice.refusals["moving obstacle"]:
            self.say("avoiding", "a moving obstacle is near")
        else:
            self.say("following", "the path")

    def reach(self) -> None:
        """Drop the first goal, which is reached; without another the mission is over."""
        self.goals.pop(0)
        if not self.goals:
            self.state, self.reason = "arrived", "the goal is reached"

    def block(self, reason: str, error: PlanningError | None = None) -> None:
        """End the mission short of its goal."""
        self.state, self.reason, self.error = "blocked", reason, error

    def recover(self, now: float, detail: str) -> None:
        """Count a recovery at ``now`` (s)."""
        log.info("recovery at %.1f s: %s", now, detail)
        self.recoveries += 1
        self.say("recovering", detail)

    @property
    def is_blocked(self) -> bool:
        """Whether the mission is over without its goal, also while data are lost."""
        before, _ = self._before or (self.state, self.reason)
        return "blocked" in (self.state, before)

    def lose(self, fault: str) -> None:
        """Enter "sensor_lost" because of a ``fault``, until ``regain``."""
        if self._before is None:
            self._before = self.state, self.reason
        self.state, self.reason = "sensor_lost", fault

    def regain(self) -> bool:
        """Restore the state saved by ``lose``. Returns True if data had been lost."""
        if self._before is None:
            return False
        (self.state, self.reason), self._before = self._before, None
        return True
