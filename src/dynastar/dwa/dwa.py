"""The dynamic window approach (IV.B, Eqs. 5-9): which speeds to ask for next, and why."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.dwa import admissible
from dynastar.dwa.config import DwaConfig
from dynastar.dwa.scene import Scene
from dynastar.dwa.search import search
from dynastar.dwa.window import dynamic_window, sample_window
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Robot

LONG_TIME = 1.5  # s that a sample is held for at the longest
VALUE_TIME = 2.0  # s after which progress is taken

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
    """How long samples are held and looked ahead, in steps of ``step`` seconds.

    Held for ``steps`` or ``long_steps``, progress taken after ``value_steps``, risk looked for up to
    ``horizon_steps`` with a disc of ``risk_radius`` (m). ``comfort`` (m) and ``hysteresis`` as in
    ``DwaConfig``.
    """

    step: float
    steps: int
    long_steps: int
    value_steps: int
    horizon_steps: int
    comfort: float
    hysteresis: float
    risk_radius: float


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
    """What a tick considered: the command, the sample behind it, terms, refusals and scores.

    ``samples`` (n, 2), ``refused`` (n,) codes (0 admissible), ``terms`` (n, 5) and ``score`` (n,) are
    copies; samples that were dropped early score -inf. ``limited_by`` says what kept it from being
    faster.
    """

    command: Twist | None
    sample: Twist | None
    refusals: dict[str, int]
    samples: Floats
    refused: npt.NDArray[np.int64]
    terms: Floats
    score: Floats
    limited_by: str


class DynamicWindow:
    """One robot's dynamic window; its buffers are made once."""

    def __init__(self, robot: Robot, config: DwaConfig, period: float) -> None:
        self.robot, self.config, self.period = robot, config, period
        limits = robot.limits
        self.body = body_of(robot)
        arc_time = max(config.arc_time, 0.5 * limits.v_max / limits.v_brake)
        step = min(config.step, arc_time / 4)
        steps = max(4, round(arc_time / step))
        value_steps = max(round(VALUE_TIME / step), steps)
        horizon_steps = max(value_steps, round(config.horizon / step))
        self.span = Span(
            step,
            steps,
            max(round(LONG_TIME / step), steps),
            value_steps,
            horizon_steps + (horizon_steps - value_steps) % 2,
            config.comfort,
            config.hysteresis,
            0.5 * (robot.footprint.inscribed + robot.footprint.circumscribed),
        )
        n_v, n_omega = config.v_samples, config.omega_samples
        n = (n_v + 3) * (n_omega + 3) + 1
        self._speeds, self._rates = np.empty(n_v + 3), np.empty(n_omega + 3)
        self._reach = max(period, config.reach)
        self._buffers = (
            np.empty((n, 2)),
            np.empty((n, 2)),
            np.zeros((n, 5)),
            np.zeros(n, np.int64),
            np.empty(n),
        )
        self._weights = tuple(map(float, config.weights))

    def choose(self, pose: Pose2D, twist: Twist, scene: Scene, v_cap: float) -> Choice:
        """The best admissible command from ``pose`` and ``twist``."""
        config, limits = self.config, self.robot.limits
        window = dynamic_window(*twist, limits, float(min(v_cap, limits.v_max)), self._reach)
        last_v = min(max(scene.last_v, window[0]), window[1])
        last_omega = min(max(scene.last_omega, window[2]), window[3])
        scene = scene._replace(last_v=last_v, last_omega=last_omega)
        samples, commands, terms, refused, score = self._buffers
        n = sample_window(
            window, self._speeds, self._rates, config.v_samples, config.omega_samples, samples
        )
        state = ((pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta)), *twist)
        best = search(
            scene, self.body, limits, self.span, self._weights, state, n, self._buffers, self.period
        )
        n += 1
        refused = refused[:n].copy()
        counts = np.bincount(refused, minlength=max(REFUSALS) + 1)
        command = Twist(*commands[best].tolist()) if best >= 0 else None
        sample = Twist(*samples[best].tolist()) if best >= 0 else None
        return Choice(
            command,
            sample,
            {words: int(counts[code]) for code, words in REFUSALS.items()},
            samples[:n].copy(),
            refused,
            terms[:n].copy(),
            score[:n].copy(),
            self._limit(sample, samples[:n], refused, v_cap),
        )

    def _limit(
        self, sample: Twist | None, samples: Floats, refused: npt.NDArray[np.int64], v_cap: float
    ) -> str:
        """What kept a choice from being faster, in words, or "" at full speed."""
        limits = self.robot.limits
        if sample is None:
            return "no admissible command"
        if sample.v >= 0.95 * limits.v_max:
            return ""
        if sample.v >= 0.95 * v_cap:
            return "speed limit"
        codes = refused[samples[:, 0] > sample.v + 1e-6]
        if len(codes) == 0:
            return "acceleration"
        most = int(np.bincount(codes).argmax())
        return REFUSALS.get(most, "score")

    def admits(self, pose: Pose2D, twist: Twist, scene: Scene, command: Twist) -> bool:
        """Whether a command from outside the search is admissible."""
        state = ((pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta)), *twist)
        rest = self.robot.limits, state, (float(command.v), float(command.omega)), self.period
        for check in (admissible.certified_stop, admissible.rests_in_time):
            if check(scene, self.body, *rest) != admissible.ADMISSIBLE:
                return False
        return True
