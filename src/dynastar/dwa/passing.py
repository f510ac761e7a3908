"""Past movers: going on where the robot could not rest, and getting out of their way."""

import math
from itertools import product
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.dwa import manoeuvre_kernels
from dynastar.dwa.dwa import Body, Margins, Surroundings, body_of, clearance_at
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Limits, Robot

Floats = npt.NDArray[np.float64]
AHEAD = 12.0  # s that a way past movers looks ahead
GOING = 0.1  # m of gap more than the margin, to set out past movers
TURNS = np.array([math.inf, 0.0, 2.0, 4.0])  # s from now in which movers may turn back
ALONG = np.array([1.0, 0.75, 0.5, 0.375, 0.25, 0.125])  # of the top speed, along the path
SHARES = (0.25, 0.5, 1.0)  # of the top speed, on a way aside
RATES = (0.0, -0.5, 0.5, -1.0, 1.0)  # of the largest
HELD = (1.0, 2.0)  # s that a turning rate is held
BACKED = (1.0, 2.0, 4.0)  # s that the robot backs, where it may
REACHES = (2.0, 4.0, 8.0)  # radii of the footprint that a way aside leads
ANGLES = np.linspace(-math.pi, math.pi, 16, endpoint=False)  # rad


class Start(NamedTuple):
    """Where a way past movers begins, ``ahead`` seconds from now, and the path (n, 3) from there.

    Its columns are x and y (m) and the speed (m/s) at which it can be driven there.
    """

    pose: Pose2D
    twist: Twist
    around: Surroundings
    path: Floats
    margins: Margins
    ahead: float = 0.0


class Scene(NamedTuple):
    """What a way past movers is driven in: all that is known, that without movers, what is hoped.

    ``allowed`` (m) is the clearance at the start, which is ``ahead`` seconds from now.
    """

    around: Surroundings
    nobody: Surroundings
    hoped: Surroundings
    body: Body
    margins: Margins
    allowed: float
    ahead: float
    limits: Limits
    period: float


class Passing:
    """Ways past movers for one robot, simulated some seconds ahead; it keeps the one being taken."""

    def __init__(self, robot: Robot, period: float) -> None:
        self.robot, self.period = robot, period
        self._body = body_of(robot)
        self._way: list[Floats] = []

    def go_on(
        self,
        start: Start,
        faster_than: float = -math.inf,
        v_limit: float = math.inf,
        hoped: Surroundings | None = None,
    ) -> Twist | None:
        """A command to go on along the path, faster than ``faster_than``, that movers leave clear.

        The robot may not be able to rest where that leads, but to drive on. With ``hoped``, what is
        out of sight is as that has it, and movers keep their velocities and do not turn back; the
        command itself can stop for what is known all the same.
        """
        turns = TURNS[:2] if hoped is None else TURNS[:1]
        spare = GOING if faster_than > -math.inf else 0.0  # to begin with, not to carry on
        found, v, omega = manoeuvre_kernels.along(
            min(v_limit, self.robot.limits.v_max) * ALONG,
            faster_than,
            start.margins.movers + spare,
            (*start.pose, *start.twist),
            start.path,
            AHEAD,
            self._scene(start, hoped or start.around),
            turns,
            np.empty(len(turns)),
            np.empty(len(turns)),
        )
        return Twist(v, omega) if found else None

    def evade(self, start: Start, v_limit: float = math.inf) -> Twist | None:
        """The first step of a way that movers leave clear, or clearer than braking; or None.

        Whatever it is, the robot could stop for everything that stands. A way once taken is among
        those that the next call looks at.
        """
        top = min(v_limit, self.robot.limits.v_max)
        ways = np.array([*self._way, *self._ways(start.pose, top)])
        found, v, omega, braked = manoeuvre_kernels.aside(
            ways,
            2.0 * start.margins.movers,
            (*start.pose, *start.twist),
            start.path,
            AHEAD,
            self._scene(start, start.around),
            TURNS,
            np.empty(len(TURNS)),
            np.empty(len(TURNS)),
        )
        if found < 0 or braked > start.margins.movers:
            self._way = []
            return None
        self._way = [ways[found]]
        self._way[0][2] = max(0.0, ways[found, 2] - self.period)  # so long is still held
        return Twist(v, omega)

    def _ways(self, pose: Pose2D, top: float) -> list[tuple[float, ...]]:
        """Ways past movers, as ``manoeuvre_kernels.asked`` takes them; ``top`` speed m/s."""
        ways: list[tuple[float, ...]] = [
            (0.0, 0.0, 0.0, top * share, math.nan, math.nan) for share in ALONG
        ]
        for reach, share, angle in product(REACHES, SHARES, ANGLES):
            d = reach * self._body.circumscribed
            aim = pose.x + d * math.cos(angle), pose.y + d * math.sin(angle)
            ways.append((0.0, 0.0, 0.0, top * share, *aim))
        for share, rate, held, then in product((0.0, *SHARES), RATES, HELD, (0.0, *SHARES)):
            omega = rate * self.robot.limits.omega_max
            ways.append((top * share, omega, held, top * then, math.inf, math.inf))
        if self.robot.limits.v_min < 0.0:
            back = max(-top, self.robot.limits.v_min)
            for rate, held in product(RATES, BACKED):
                omega = rate * self.robot.limits.omega_max
                ways.append((back, omega, held, 0.0, math.inf, math.inf))
        return ways

    def _scene(self, start: Start, hoped: Surroundings) -> Scene:
        around, margins = start.around, start.margins
        return Scene(
            around,
            around._replace(movers=around.movers[:0]),
            hoped,
            self._body,
            margins,
            clearance_at(around, self._body, margins.standing + 0.1, start.pose),
            float(start.ahead),
            self.robot.limits,
            self.period,
        )
