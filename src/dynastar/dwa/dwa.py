"""The dynamic window approach (IV.B, Eqs. 5-9): which speeds to ask for next, and why."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.dwa import stop_kernels, window_kernels
from dynastar.dwa.clearance_kernels import footprint_clearance, path_clearance
from dynastar.dwa.config import DwaConfig
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Robot, slew

Floats = npt.NDArray[np.float64]
LEAST_CAP = 0.03  # m, so that dist always tells nearer from farther
TERMS = ("heading", "dist", "vel", "simi")
REFUSALS = {
    stop_kernels.NO_STOP: "no certified stop",
    stop_kernels.CONTACT: "too fast for the next contact (Eq. 7)",
    stop_kernels.MOVER: "in the way of a mover",
    stop_kernels.RUN_OVER: "a mover would arrive where it stops",
}


class Surroundings(NamedTuple):
    """What the window is judged against.

    ``field`` (n, n) metres from each cell's centre to the nearest that is not observed free, its
    low corner (x0, y0) and resolution; ``movers`` (m, 6) x, y, vx, vy, radius, top speed as of now.
    """

    field: npt.NDArray[np.float32]
    x0: float
    y0: float
    resolution: float
    movers: Floats


class Body(NamedTuple):
    """A footprint as the kernels take it, see ``Footprint``."""

    vertices: Floats
    discs: Floats
    inscribed: float
    circumscribed: float


def body_of(robot: Robot) -> Body:
    """A robot's footprint for the kernels."""
    shape = robot.footprint
    return Body(shape.vertices, shape.discs, shape.inscribed, shape.circumscribed)


def clearance_at(around: Surroundings, body: Body, enough: float, pose: Pose2D) -> float:
    """Metres, exact up to ``enough``, from a footprint at a pose to the nearest closed cell's centre."""
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    return float(footprint_clearance(around, body, enough, pose.x, pose.y, cos, sin))


class Wish(NamedTuple):
    """Where the robot should go: the target, the path from here every ``spacing`` metres, a speed cap."""

    target: tuple[float, float]
    path: Floats
    spacing: float
    v_cap: float


class Margins(NamedTuple):
    """What a footprint is grown by: for what stands (m), for movers (m), and for these per second.

    Where the robot comes to rest, no mover should arrive for ``linger`` seconds.
    """

    standing: float
    movers: float
    spread: float
    linger: float = 0.0


class Span(NamedTuple):
    """How far a sample's trajectory is looked at: reached in ``reach`` s, scored over ``horizon`` s."""

    reach: float
    horizon: float
    steps: int


class Scoring(NamedTuple):
    """What the terms of Eq. 9 are measured by; see ``Wish`` and ``DwaConfig``."""

    target_x: float
    target_y: float
    path: Floats
    spacing: float
    clearance_cap: float
    path_cap: float
    at_end: bool
    v_cap: float
    v_best: float
    v_scale: float
    turning: bool


class Arcs(NamedTuple):
    """Trajectories of one turning rate after each step (steps,), see ``rollout_kernels``.

    What a speed of 1 held from the start drives (m per m/s) and what one that rises with ``share``
    does, in the map's axes; the angle turned (rad) and the share of the way to the sample's speeds.
    """

    held_x: Floats
    held_y: Floats
    rise_x: Floats
    rise_y: Floats
    turned: Floats
    share: Floats


class Tracks(NamedTuple):
    """What the samples of one speed share: where on the path each step would be, see ``follow``.

    ``along`` (speeds, 2, steps), how many steps the path lasts and which one heading is taken at.
    """

    along: Floats
    followed: npt.NDArray[np.int64]
    aim: npt.NDArray[np.int64]


class Buffers(NamedTuple):
    """A window's arrays: samples and commands (n, 2), terms (n, 4), refusals and scores (n,)."""

    samples: Floats
    commands: Floats
    terms: Floats
    refused: npt.NDArray[np.int64]
    score: Floats
    arcs: Arcs
    tracks: Tracks


@dataclass(frozen=True)
class Choice:
    """What a tick considered: the command, the sample behind it, each term's share, the refusals.

    ``samples`` (n, 2), ``refused`` (n,) codes (0 admissible), ``terms`` (n, 4) raw and ``score``
    (n,) are views of the window's buffers, valid until the next call.
    """

    command: Twist | None
    sample: Twist | None
    shares: dict[str, float]
    refusals: dict[str, int]
    samples: Floats
    refused: npt.NDArray[np.int64]
    terms: Floats
    score: Floats

    @property
    def refused_for_movers(self) -> int:
        """How many samples were refused because of movers."""
        codes = stop_kernels.MOVER, stop_kernels.RUN_OVER
        return sum(self.refusals[REFUSALS[code]] for code in codes)


class DynamicWindow:
    """One robot's dynamic window; its buffers are made once."""

    def __init__(self, robot: Robot, config: DwaConfig, period: float) -> None:
        self.robot, self.config, self.period = robot, config, period
        limits = robot.limits
        slowest = max(limits.v_max / limits.v_accel, limits.omega_max / limits.omega_accel)
        self.reach = max(period, min(config.reach, slowest))
        n_v, n_w = config.v_samples, config.omega_samples
        if config.v_resolution > 0:
            widest = min(
                (limits.v_accel + limits.v_brake) * self.reach, limits.v_max - limits.v_min
            )
            n_v = max(2, math.ceil(widest / config.v_resolution) + 1)
        if config.omega_resolution > 0:
            widest = min(
                (limits.omega_accel + limits.omega_brake) * self.reach, 2 * limits.omega_max
            )
            n_w = max(2, math.ceil(widest / config.omega_resolution) + 1)
        self._counts = n_v, n_w
        n = (n_v + 1) * (n_w + 1) + 1
        self._speeds, self._rates = np.empty(n_v + 1), np.empty(n_w + 1)
        self._body = body_of(robot)
        self._span = Span(self.reach, float(config.horizon), int(config.steps))
        self._buffers = Buffers(
            np.empty((n, 2)),
            np.empty((n, 2)),
            np.zeros((n, 4)),
            np.zeros(n, np.int64),
            np.empty(n),
            self._arcs_for(Twist(0.0, 0.0)),
            Tracks(
                np.empty((n_v + 2, 2, self._span.steps)),
                np.zeros(n_v + 2, np.int64),
                np.zeros(n_v + 2, np.int64),
            ),
        )
        self._weights = np.array(config.weights, dtype=np.float64)

    def _arcs_for(self, twist: Twist) -> Arcs:
        """Room for the longest look ahead: over the horizon, and over a stop from the top speeds."""
        limits = self.robot.limits
        v, omega = (
            max(limits.v_max, -limits.v_min, abs(twist.v)),
            max(limits.omega_max, abs(twist.omega)),
        )
        must = self.reach + 0.5 * max(v / limits.v_brake, omega / limits.omega_brake)
        steps = max(self._span.steps, math.ceil(must * self._span.steps / self._span.horizon) + 1)
        return Arcs(*np.empty((len(Arcs._fields), steps)))

    def clearance(self, around: Surroundings, pose: Pose2D, enough: float = 0.5) -> float:
        """Metres, up to ``enough``, from the footprint to the nearest centre of a closed cell."""
        return clearance_at(around, self._body, enough, pose)

    def choose(
        self,
        pose: Pose2D,
        twist: Twist,
        around: Surroundings,
        wish: Wish,
        margins: Margins,
        ahead: float = 0.0,
        may_reverse: bool = False,
        turn_only: bool = False,
    ) -> Choice:
        """The best admissible command from ``pose`` and ``twist``, ``ahead`` seconds from now.

        ``command`` is None if no sample is admissible. ``turn_only`` asks for turning in place;
        without ``may_reverse`` the speed stays >= 0.
        """
        config, limits = self.config, self.robot.limits
        samples = self._buffers.samples
        bearing = math.atan2(wish.target[1] - pose.y, wish.target[0] - pose.x) - pose.theta
        turning = turn_only or abs(math.remainder(bearing, math.tau)) > config.turn_in_place
        v_min = limits.v_min if may_reverse else 0.0
        v_cap = 0.0 if turning else min(wish.v_cap, limits.v_max)
        n, n_speeds = window_kernels.sample_window(
            *twist,
            v_min,
            v_cap,
            limits.omega_max,
            limits,
            self.reach,
            *self._counts,
            self._speeds,
            self._rates,
            samples,
        )
        v_best, v_scale = 0.0 if turning else limits.v_max, limits.v_max  # vel is v / v_max
        if config.normalisation == "window":
            low, high = float(samples[: n - 1, 0].min()), float(samples[: n - 1, 0].max())
            v_cap, v_scale = min(max(v_cap, low), high), max(high - low, 1e-6)
            v_best = v_cap
        cap = config.clearance_cap
        if config.clearance_of_path:
            free = path_clearance(around.field, around.x0, around.y0, around.resolution, wish.path)
            cap = min(cap, max(free - self._body.inscribed - margins.standing, LEAST_CAP))
        scoring = Scoring(
            float(wish.target[0]),
            float(wish.target[1]),
            wish.path,
            wish.spacing,
            float(cap),
            config.path_cap,
            config.dist == "end",
            float(v_cap),
            float(v_best),
            float(v_scale),
            turning,
        )
        state = (*pose, *twist)
        if abs(twist.v) > limits.v_max or abs(twist.omega) > limits.omega_max:  # as measured
            self._buffers = self._buffers._replace(arcs=self._arcs_for(twist))
        allowed = self.clearance(around, pose, margins.standing + 0.5)
        best = window_kernels.evaluate(
            self._buffers,
            n,
            n_speeds,
            state,
            self._span,
            around,
            self._body,
            margins,
            allowed,
            ahead,
            scoring,
            limits,
            self.period,
            self._weights,
            config.normalisation == "sum",
        )
        return self._explain(best, n)

    def back_off(
        self,
        pose: Pose2D,
        twist: Twist,
        around: Surroundings,
        margins: Margins,
        ahead: float = 0.0,
        speed: float = 0.2,
    ) -> Twist | None:
        """A step towards driving back at up to ``speed`` m/s, as straight as has a certified stop."""
        limits = self.robot.limits
        v = slew(twist.v, max(limits.v_min, -speed), limits.v_accel, limits.v_brake, self.period)
        allowed = self.clearance(around, pose, margins.standing + 0.1)
        for wanted in (0.0, 0.15, -0.15, 0.4, -0.4):  # rad/s, straight first
            omega = slew(twist.omega, wanted, limits.omega_accel, limits.omega_brake, self.period)
            code = stop_kernels.certify(
                around,
                self._body,
                margins,
                allowed,
                ahead,
                (*pose, *twist),
                v,
                omega,
                limits,
                self.period,
            )
            if code == stop_kernels.ADMISSIBLE:
                return Twist(v, omega)
        return None

    def _explain(self, best: int, n: int) -> Choice:
        samples, commands, all_terms, all_refused, score, *_ = self._buffers
        refused = all_refused[:n]
        counts = np.bincount(refused, minlength=max(REFUSALS) + 1)
        shares = dict.fromkeys(TERMS, 0.0)
        command = sample = None
        if best >= 0:
            command, sample = (
                Twist(*commands[best].tolist()),
                Twist(*samples[best].tolist()),
            )
            terms = all_terms[best]
            if self.config.normalisation == "sum":
                total = all_terms[:n][refused == 0].sum(axis=0)
                terms = np.divide(terms, total, out=np.zeros(4), where=total > 1e-9)
            shares = dict(zip(TERMS, (self._weights * terms).tolist(), strict=True))
        return Choice(
            command,
            sample,
            shares,
            {words: int(counts[code]) for code, words in REFUSALS.items()},
            samples[:n],
            refused,
            all_terms[:n],
            score[:n],
        )
