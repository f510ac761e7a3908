"""Scripted walkers who notice the robot late: they stop in front of it, wait, and go round it."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.simulation.contact import RESTING
from dynastar.simulation.detour import Detour, encounter, find_detour
from dynastar.simulation.movers import Movers
from dynastar.simulation.scenario import Mover

Floats = npt.NDArray[np.float64]

STOP_GAP = 0.15  # m to the robot at which a walker stops
CLEAR_GAP = 0.5  # m to the robot at which a stopped walker walks on
WAIT = 2.0  # s for which the robot rests until a stopped walker goes round it
SPEEDS = (0.3, 2.0)  # m/s, slowest and fastest on a detour


class LateWalkers:
    """Walkers of a world with ``attention = "late"``; ``radii`` is (m,) metres.

    A walker is at its script's place for a clock of its own, which stands while it waits and while it
    goes round the robot. It stops where a robot that rests or moves away is within 0.15 m and the next
    step would lead nearer to it. It walks on once the robot is 0.5 m away. Once the robot has rested
    for 2 s beside it, it goes round on a circle, the shorter side first, to where its script leaves
    that circle; with walls on both sides it waits. ``stops`` counts the times that somebody stopped,
    ``bumps`` the touches of a robot that rests or moves away; ``bumping`` (m,) are those at present.
    """

    def __init__(
        self,
        movers: Sequence[Mover],
        footprint: Footprint,
        gaps: Callable[[Floats], Floats],
        time: float = 0.0,
    ) -> None:
        self._all, self._single = Movers(movers), [Movers([mover]) for mover in movers]
        self.radii = self._all.radii
        self._footprint, self._gaps = footprint, gaps
        self._time, self._places = time, self._all.at(time)
        self._lag = np.zeros(len(movers))  # s, of a walker's clock behind the world's
        self._waits: dict[int, float] = {}  # since when the robot rests, by stopped walker
        self._detours: dict[int, Detour] = {}
        self._speed = np.zeros(len(movers))  # m/s, at the last stop
        self.bumping = np.zeros(len(movers), np.bool_)
        self.bumps = self.stops = 0

    def at(self, time: float) -> Floats:
        """Centres (m, 2) in metres at ``time`` (s), the one advanced to last; NaN for the absent."""
        del time
        return self._places.copy()

    def advance(self, time: float, pose: Pose2D, twist: Twist) -> None:
        """Moves the walkers up to ``time`` (s), with the robot at ``pose`` and moving at ``twist``."""
        passed, self._time = time - self._time, time
        wanted = self._wanted(passed)
        away = np.hypot(wanted[:, 0] - pose.x, wanted[:, 1] - pose.y) - self.radii
        near = np.flatnonzero(away < self._footprint.circumscribed + CLEAR_GAP)
        for walker in self._waits.keys() - set(near.tolist()):
            del self._waits[walker]
        touched, self.bumping = self.bumping, np.zeros_like(self.bumping)
        for walker in near.tolist():
            self._meet(walker, wanted, passed, pose, twist)
        self._places = wanted
        self.bumps += int((self.bumping & ~touched).sum())

    def _wanted(self, passed: float) -> Floats:
        """The next places (m, 2) of all walkers, as if the robot were not there."""
        wanted = self._all.at(self._time)
        for walker in self._waits.keys() | self._detours.keys():
            self._lag[walker] += passed
        for walker, detour in list(self._detours.items()):
            if walker not in self._waits and detour.done and self._time >= detour.clock:
                self._lag[walker] = self._time - detour.clock
                del self._detours[walker]
        for walker in np.flatnonzero(self._lag).tolist():
            if walker in self._waits:
                wanted[walker] = self._places[walker]
            elif walker in self._detours:
                wanted[walker] = self._detours[walker].walk(passed)
            else:
                wanted[walker] = self._script(walker, self._time - self._lag[walker])
        return wanted

    def _script(self, walker: int, clock: float) -> Floats:
        """A walker's place (2,) by its script at a time of its own clock."""
        place: Floats = self._single[walker].at(clock)[0]
        return place

    def _meet(self, walker: int, wanted: Floats, passed: float, pose: Pose2D, twist: Twist) -> None:
        """Decides what a walker near the robot does; writes its place to ``wanted``."""
        here, radius = self._places[walker], float(self.radii[walker])
        now = encounter(pose, twist, self._footprint, here, radius)
        then = encounter(pose, twist, self._footprint, wanted[walker], radius)
        if walker in self._waits:
            self._wait(walker, now.gap, pose, twist)
        elif now.approach <= RESTING and now.gap < CLEAR_GAP and then.gap < min(STOP_GAP, now.gap):
            self._stop(walker, wanted[walker] - here, passed)
            wanted[walker], then = here, now
        self.bumping[walker] = then.gap <= 0.0 and then.approach <= RESTING

    def _stop(self, walker: int, step: Floats, passed: float) -> None:
        """Lets a walker stop before a step (2,) m that would have taken ``passed`` seconds."""
        self.stops += 1
        self._waits[walker] = self._time
        self._speed[walker] = np.clip(np.hypot(*step) / passed, *SPEEDS)
        if walker in self._detours:
            self._detours[walker].walk(-passed)
        else:
            self._lag[walker] += passed

    def _wait(self, walker: int, gap: float, pose: Pose2D, twist: Twist) -> None:
        """Decides whether a walker who stopped walks on or goes round; tries again after 2 s."""
        resting = abs(twist.v) < RESTING and abs(twist.omega) < RESTING
        if gap >= CLEAR_GAP:
            del self._waits[walker]
        elif not resting:
            self._waits[walker] = self._time
        elif self._time - self._waits[walker] >= WAIT:
            self._waits[walker] = self._time
            found = find_detour(
                self._places[walker],
                float(self.radii[walker]),
                (np.array(pose[:2]), self._footprint.circumscribed),
                (partial(self._script, walker), self._time - self._lag[walker]),
                self._gaps,
            )
            if found is not None:
                self._detours[walker] = Detour(*found, float(self._speed[walker]))
                del self._waits[walker]
