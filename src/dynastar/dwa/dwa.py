"""The dynamic window approach (IV.B, Eqs. 5-9): which speeds to ask for next, and why."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.dwa import admissible
from dynastar.dwa.config import DwaConfig
from dynastar.dwa.rollout import LOOKS
from dynastar.dwa.scene import AT_REST, Manoeuvre, Scene
from dynastar.dwa.search import search
from dynastar.dwa.window import dynamic_window, sample_window
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Limits, Robot

LONG_TIME = 1.5  # s that a sample is held for at the longest

Floats = npt.NDArray[np.float64]
TERMS = ("heading", "dist", "vel", "simi", "risk")
REFUSALS = {
    admissible.NO_STOP: "no certified stop",
    admissible.MOVER: "moving obstacle",
    admissible.HIDDEN: "unseen space",
}


class Body(NamedTuple):
    """A footprint as the kernels take it; ``probes`` (k, 3) are discs x, y, radius that stand for it."""

    vertices: Floats
    probes: Floats
    inscribed: float
    circumscribed: float


class Span(NamedTuple):
    """Times of the roll-outs, in steps of ``step`` seconds.

    Held for ``steps`` or ``long_steps``, rolled out for ``horizon_steps``; risk is that of a disc of
    ``risk_radius`` (m). ``comfort`` (m) and ``hysteresis`` as in ``DwaConfig``.
    """

    step: float
    steps: int
    long_steps: int
    horizon_steps: int
    comfort: float
    hysteresis: float
    risk_radius: float


class Rules(NamedTuple):
    """Rules for evaluating candidates: shape, limits, span, weights (Eq. 9), period (s)."""

    body: Body
    limits: Limits
    span: Span
    weights: tuple[float, float, float, float, float]
    period: float


def body_of(robot: Robot) -> Body:
    """A robot's footprint for the kernels."""
    shape = robot.footprint
    corners = shape.vertices
    points = np.vstack([corners, 0.5 * (corners + np.roll(corners, 1, axis=0))])
    probes = np.vstack(
        [[[0.0, 0.0, shape.inscribed]], np.column_stack([points, np.zeros(len(points))])]
    )
    return Body(corners, probes, shape.inscribed, shape.circumscribed)


@dataclass(frozen=True)
class Choice:
    """Result of a tick: the command, its manoeuvre and the rest of that manoeuvre.

    ``samples`` (n, 2), ``refused`` (n,) codes (0 admissible), ``terms`` (n, 5) and ``score`` (n,) are
    copies; samples that were dropped early score -inf. ``limited_by`` says what kept it from being
    faster.
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


def _greater(twist: Twist, measured: Twist | None) -> tuple[float, float]:
    """The greater of two twists' speeds, each by its magnitude."""
    if measured is None:
        return twist.v, twist.omega
    v, omega = (max(pair, key=abs) for pair in zip(twist, measured, strict=True))
    return v, omega


class DynamicWindow:
    """One robot's dynamic window; its buffers are made once."""

    def __init__(self, robot: Robot, config: DwaConfig, period: float) -> None:
        self.robot, self.config, self.period = robot, config, period
        limits = robot.limits
        self.body = body_of(robot)
        step = min(config.step, config.arc_time / 4)
        steps = max(4, round(config.arc_time / step))
        far = config.horizon + 0.5 * limits.v_max / limits.v_brake
        self.span = Span(
            step,
            steps,
            max(round(LONG_TIME / step), steps),
            LOOKS * max(2, round(far / step / LOOKS)),
            config.comfort,
            config.hysteresis,
            0.5 * (robot.footprint.inscribed + robot.footprint.circumscribed),
        )
        n_v, n_omega = config.v_samples, config.omega_samples
        n = (n_v + 3) * (n_omega + 3) + 2
        self._speeds, self._rates = np.empty(n_v + 3), np.empty(n_omega + 3)
        self._reach = max(period, config.reach)
        self._buffers = (
            np.empty((n, 2)),
            np.empty((n, 2)),
            np.zeros(n),
            np.zeros(n, np.int64),
            np.zeros((n, 5)),
            np.zeros(n, np.int64),
            np.empty(n),
        )
        self.complete = False  # whether ``choose`` scores all, as ``survey`` does
        alpha, beta, gamma, sigma, rho = map(float, config.weights)
        weights = alpha, beta, gamma, sigma, rho
        self._rules = Rules(self.body, limits, self.span, weights, period)

    def choose(
        self, pose: Pose2D, twist: Twist, scene: Scene, measured: Twist | None = None
    ) -> Choice:
        """The best admissible command from ``pose`` and ``twist``.

        Stops are certified from the greater of ``twist`` and the ``measured`` twist, if there is one.
        """
        config, limits = self.config, self.robot.limits
        window = dynamic_window(*twist, limits, min(scene.v_cap, limits.v_max), self._reach)
        samples, speeds, rates = self._buffers[0], self._speeds, self._rates
        most = config.v_samples, config.omega_samples
        n = sample_window(window, speeds, rates, *most, samples)
        return self._search(pose, twist, _greater(twist, measured), scene, n)

    def survey(
        self, pose: Pose2D, twist: Twist, scene: Scene, measured: Twist | None = None
    ) -> Choice:
        """As ``choose``, with the scores of all admissible samples, also of those that cannot win."""
        before, self.complete = self.complete, True
        try:
            return self.choose(pose, twist, scene, measured)
        finally:
            self.complete = before

    def _search(
        self, pose: Pose2D, twist: Twist, stop_from: tuple[float, float], scene: Scene, n: int
    ) -> Choice:
        """The best of the ``n`` samples in the buffers."""
        samples, commands, holds, tails, terms, refused, score = self._buffers
        state = ((pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta)), *twist)
        best = search(scene, self._rules, state, stop_from, n, self._buffers, not self.complete)
        n += 2
        refused = refused[:n].copy()
        counts = np.bincount(refused, minlength=max(REFUSALS) + 1)
        command = Twist(*commands[best].tolist()) if best >= 0 else None
        left, chosen = AT_REST, None
        if best >= 0:
            v, omega = samples[best].tolist()
            chosen = Manoeuvre(v, omega, float(holds[best]), int(tails[best]))
            left = chosen._replace(hold=max(chosen.hold - self.period, 0.0))
        return Choice(
            command,
            chosen,
            left,
            {words: int(counts[code]) for code, words in REFUSALS.items()},
            samples[:n].copy(),
            refused,
            terms[:n].copy(),
            score[:n].copy(),
            self._limit(chosen, twist.v, samples[:n], refused, scene.v_cap),
        )

    def _limit(
        self,
        chosen: Manoeuvre | None,
        v: float,
        samples: Floats,
        refused: npt.NDArray[np.int64],
        v_cap: float,
    ) -> str:
        """Name what limited the speed of a choice, "" at full speed."""
        limits = self.robot.limits
        if chosen is None:
            return "no admissible command"
        if chosen.v >= 0.95 * limits.v_max:
            return "" if v >= 0.95 * limits.v_max else "acceleration"
        if chosen.v >= 0.95 * v_cap:
            return "speed limit"
        codes = refused[samples[:, 0] > chosen.v + 1e-6]
        if len(codes) == 0:
            return "acceleration"
        most = int(np.bincount(codes).argmax())
        return REFUSALS.get(most, "score")

    def admits(
        self,
        pose: Pose2D,
        twist: Twist,
        scene: Scene,
        command: Twist,
        measured: Twist | None = None,
    ) -> bool:
        """Whether a command from outside the search is admissible; twists as in ``choose``."""
        stop_from = _greater(twist, measured)
        state = ((pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta)), *stop_from)
        rest = self.robot.limits, state, (float(command.v), float(command.omega)), self.period
        for check in (admissible.certified_stop, admissible.rests_in_time):
            if check(scene, self.body, *rest) != admissible.ADMISSIBLE:
                return False
        return True
