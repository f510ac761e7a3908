"""The dynamic window approach (IV.B, Eqs. 5-9): which speeds to command next, and why."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.config import shown, summary
from dynastar.dwa import admissible
from dynastar.dwa.config import DwaConfig
from dynastar.dwa.motion import STOP_START, state_at
from dynastar.dwa.nearest import nearest_admissible
from dynastar.dwa.rollout import ROW, Schedule, schedule_of
from dynastar.dwa.scene import AT_REST, Manoeuvre, Scene, Surroundings
from dynastar.dwa.search import CANDIDATE, SAMPLES, search
from dynastar.dwa.terms import LOOKUPS, Terms
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Limits, Robot

Floats = npt.NDArray[np.float64]


class StopStart(NamedTuple):
    """Pose and twist when a command may begin to act, and for how long (s) it may act."""

    pose: Pose2D
    twist: Twist
    hold: float


Stops = Sequence[StopStart]
TERMS = Terms._fields
REFUSALS = {
    admissible.NO_STOP: "no certified stop",
    admissible.MOVING: "moving obstacle",
    admissible.HIDDEN: "unseen space",
}
PROBES_APART = 0.3  # m between the points that stand for a polygon's outline, at most
SAMPLED = 50  # points from the centre to the rim of a footprint, for the error of its probes
LONGEST_STEP = 0.1  # s between the points of a roll-out, at most
LONG_HOLD = 1.5  # s that a sample is held for at the longest
FULL_SPEED = 0.95  # of a speed limit, from which on the robot drives at it


class Body(NamedTuple):
    """A footprint as the kernels take it; ``probes`` (k, 2) are points of a polygon's outline (m).

    ``probe_error`` (m) is the most by which the clearance at the probes exceeds the footprint's.
    """

    vertices: Floats
    probes: Floats
    inscribed: float
    circumscribed: float
    probe_error: float


class Rules(NamedTuple):
    """What does not change from tick to tick: robot, settings, and times.

    Samples are held as long as ``schedule`` says, or for ``long_hold`` (s). ``risk_radius`` (m) is
    that of the disc that stands for the robot in the risk, ``drive_error`` the fraction by which
    either speed may be off.
    """

    body: Body
    limits: Limits
    config: DwaConfig
    schedule: Schedule
    long_hold: float
    period: float
    risk_radius: float
    drive_error: float


def body_of(robot: Robot) -> Body:
    """A robot's footprint for the kernels."""
    shape = robot.footprint
    probes = _outline(shape.vertices, PROBES_APART)
    error = _probe_error(shape, probes)
    return Body(shape.vertices, probes, shape.inscribed, shape.circumscribed, error)


def _outline(corners: Floats, apart: float) -> Floats:
    """Corners (n, 2) of a polygon and points between them (m), no farther apart than ``apart``."""
    points = [corners]
    for corner, following in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        parts = max(2, math.ceil(math.dist(corner, following) / apart))
        inside = np.linspace(0.0, 1.0, parts + 1)[1:-1, None]
        points.append(corner + inside * (following - corner))
    return np.vstack(points)


def _probe_error(shape: Footprint, probes: Floats) -> float:
    """The error of a body's probes (m): the largest clearance that they show of a point inside.

    Outside, the clearance at the probes grows no faster than the true one. The points inside are
    sampled, to ``apart`` (m) from each other; that is added.
    """
    apart = shape.circumscribed / SAMPLED
    fractions = np.linspace(0.0, 1.0, SAMPLED + 1)[:, None, None]
    points = (fractions * _outline(shape.vertices, apart)).reshape(-1, 2)
    shown = np.hypot(*points.T) - shape.inscribed
    for probe in probes:
        np.minimum(shown, np.hypot(*(points - probe).T), out=shown)
    return max(0.0, float(shown.max(initial=-apart)) + apart)


def rules_of(robot: Robot, config: DwaConfig, period: float, drive_error: float = 0.0) -> Rules:
    """What the kernels need to know of a robot, its settings and the time between commands (s)."""
    step = min(LONGEST_STEP, config.arc_time / 4)
    held = max(4, round(config.arc_time / step))
    far = config.horizon + 0.5 * robot.limits.v_max / robot.limits.v_brake
    steps = LOOKUPS * max(2, round(far / step / LOOKUPS))
    shape = robot.footprint
    return Rules(
        body=body_of(robot),
        limits=robot.limits,
        config=config,
        schedule=schedule_of(step, held, steps, LOOKUPS),
        long_hold=step * max(round(LONG_HOLD / step), held),
        period=period,
        risk_radius=0.5 * (shape.inscribed + shape.circumscribed),
        drive_error=drive_error,
    )


@dataclass(frozen=True)
class Choice:
    """Result of a tick: the command, its manoeuvre and the rest of that manoeuvre.

    ``samples`` (n, 2), ``refused`` (n,) codes (0 not refused), ``terms`` (n, 6) and ``score`` (n,) are
    copies; candidates without an admissible manoeuvre score -inf. Below the best score no stop is
    certified. The first two are the rest of the last manoeuvre and following the cost-to-go at once.
    ``limited_by`` says what kept the command from being faster.
    """

    command: Twist | None
    manoeuvre: Manoeuvre | None
    left: Manoeuvre
    refusals: dict[str, int]
    samples: Floats
    refused: npt.NDArray[np.int64]
    terms: Floats
    score: Floats
    limited_by: str

    def __repr__(self) -> str:
        chosen = "stop"
        if self.command is not None:
            chosen = f"{self.command.v:.2f} m/s and {self.command.omega:.2f} rad/s"
        scored = f"{np.isfinite(self.score).sum()} of {len(self.score)} candidates scored"
        limited = f"limited by {shown(self.limited_by)}" if self.limited_by else ""
        return summary(self, chosen, scored, limited)


class DynamicWindow:
    """One robot's dynamic window; its arrays are made once."""

    def __init__(
        self, robot: Robot, config: DwaConfig, period: float, drive_error: float = 0.0
    ) -> None:
        self.rules = rules_of(robot, config, period, drive_error)
        n = (config.v_samples + 3) * (config.omega_samples + 3) + SAMPLES
        self._candidates = np.zeros(n, CANDIDATE)
        self._rows = np.zeros(len(self.rules.schedule.step), ROW)

    def set_period(self, period: float) -> None:
        """Commands are that far apart now (s)."""
        self.rules = self.rules._replace(period=period)

    def choose(self, pose: Pose2D, twist: Twist, scene: Scene, stops: Stops = ()) -> Choice:
        """The best admissible command from ``pose`` and ``twist``.

        Stops are certified from each of ``stops``, or from ``pose`` and ``twist`` if there are none.
        """
        stops_from = _records(stops or [StopStart(pose, twist, self.rules.period)])
        n, best = search(
            scene, self.rules, state_at(*pose, *twist), stops_from, self._candidates, self._rows
        )
        candidates = self._candidates[:n].copy()
        counts = np.bincount(candidates["refused"], minlength=max(REFUSALS) + 1)
        command, chosen, left = None, None, AT_REST
        if best >= 0:
            found = candidates[best]
            command = Twist(float(found["command_v"]), float(found["command_omega"]))
            v, omega, hold = (float(found[name]) for name in ("v", "omega", "hold"))
            chosen = Manoeuvre(v, omega, hold, int(found["tail"]))
            left = chosen._replace(hold=max(chosen.hold - self.rules.period, 0.0))
        return Choice(
            command,
            chosen,
            left,
            {words: int(counts[code]) for code, words in REFUSALS.items()},
            np.column_stack([candidates["v"], candidates["omega"]]),
            candidates["refused"],
            np.column_stack([candidates[name] for name in TERMS]),
            candidates["score"],
            self._limit(chosen, twist.v, candidates, scene.v_cap),
        )

    def _limit(
        self, chosen: Manoeuvre | None, v: float, candidates: npt.NDArray[np.void], v_cap: float
    ) -> str:
        """Name what limited the speed of a choice, "" at full speed."""
        full_speed = FULL_SPEED * self.rules.limits.v_max
        if chosen is None:
            return "no admissible command"
        if chosen.v >= full_speed:
            return "" if v >= full_speed else "acceleration"
        if chosen.v >= FULL_SPEED * v_cap:
            return "speed limit"
        codes = candidates["refused"][candidates["v"] > chosen.v + 1e-6]
        if len(codes) == 0:
            return "acceleration"
        return REFUSALS.get(int(np.bincount(codes).argmax()), "score")

    def admits(self, around: Surroundings, stops: Stops, command: Twist) -> bool:
        """Whether a command from outside the search is admissible; ``stops`` as in ``choose``."""
        asked = tuple(map(float, command))
        return bool(admissible.is_admissible(around, self.rules, _records(stops), asked))

    def nearest(
        self, around: Surroundings, stops: Stops, twist: Twist, asked: Twist, steady: float = 0.0
    ) -> tuple[Twist | None, str]:
        """The admissible command nearest to one ``asked`` for, and why it is not that one, "" if it is.

        It goes on from ``twist`` within the robot's limits: along the arc asked for, slower if need be,
        or else turning on the spot. None if only a stop is left. With ``steady`` (s) it speeds up only
        to what could be held for so long. ``stops`` as in ``choose``.
        """
        found, command, code = nearest_admissible(
            around, self.rules, _records(stops), tuple(twist), tuple(asked), steady
        )
        return (Twist(*command) if found else None), REFUSALS.get(code, "")


def _records(stops: Stops) -> npt.NDArray[np.void]:
    """Stops as STOP_START records."""
    states = [(state_at(*pose, *twist), hold) for pose, twist, hold in stops]
    return np.array([(*at.pose, at.v, at.omega, hold) for at, hold in states], STOP_START)
