"""What goes into a navigator and what it tells: the robot's state, and the status of a tick."""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from dynastar.config import counted, shown, summary
from dynastar.dwa.dwa import Choice
from dynastar.errors import PlanningError
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame
from dynastar.perception import Track
from dynastar.planning import Plan
from dynastar.robot import Limits

State = Literal[
    "idle", "following", "avoiding", "waiting", "turning", "recovering", "arrived", "blocked",
    "sensor_lost",
]  # fmt: skip
STATES: tuple[State, ...] = get_args(State)


class RobotState(NamedTuple):
    """Where the robot is in the map frame and how it moves, at ``stamp`` seconds."""

    stamp: float
    pose: Pose2D
    twist: Twist


def as_state(state: RobotState, limits: Limits) -> RobotState:
    """The state with every number a float; pose and twist are NaN unless all numbers are finite.

    Kernels would be compiled again for an int: ``Twist(0.1, 0)``. Speeds that the robot cannot have, as
    a glitch of the odometry reports, count as those it can.
    """
    try:
        stamp, (x, y, theta), (v, omega) = state
        numbers = np.array((stamp, x, y, theta, v, omega), dtype=np.float64).reshape(6)
    except (TypeError, ValueError, OverflowError):
        numbers = np.full(6, math.nan)
    if not np.isfinite(numbers).all():
        numbers[1:] = math.nan
    stamp, x, y, theta, v, omega = numbers.tolist()
    v = min(max(v, limits.v_min), limits.v_max)
    omega = min(max(omega, -limits.omega_max), limits.omega_max)
    return RobotState(stamp, Pose2D(x, y, theta), Twist(v, omega))


def is_finite(state: RobotState) -> bool:
    """Whether every number of a state is finite."""
    return all(math.isfinite(number) for number in (state.stamp, *state.pose, *state.twist))


def slowed(command: Twist, most: Twist) -> Twist:
    """A command along the same arc, at no more than the speeds ``most`` either way."""
    v, omega = command
    factor = min(1.0, most.v / max(abs(v), 1e-9), most.omega / max(abs(omega), 1e-9))
    return Twist(factor * v, factor * omega)


@dataclass(frozen=True)
class Status:
    """State of the navigator, its reason, and the result of its last tick.

    ``plan_id`` rises with every new plan; the plan's cells belong to ``planning_frame``. ``replans``
    counts plans after the first for a goal. ``limited_by`` says what kept the last command from being
    faster, ``error`` why no plan could be made, if that is what stopped it.
    """

    state: State = "idle"
    reason: str = "no goal"
    replans: int = 0
    recoveries: int = 0
    plan: Plan | None = None
    plan_id: int = 0
    plan_reason: str = ""
    planning_frame: GridFrame = GridFrame(1.0)
    tracks: tuple[Track, ...] = ()
    limited_by: str = ""
    goals_left: int = 0
    error: PlanningError | None = None
    choice: Choice | None = None

    def __repr__(self) -> str:
        return summary(
            self,
            f"{self.state} ({shown(self.reason)})",
            counted(self.goals_left, "goal") and f"{counted(self.goals_left, 'goal')} left",
            "" if self.plan is None else f"plan {self.plan_id} of {self.plan.path.length:.2f} m",
            counted(self.replans, "replan"),
            counted(self.recoveries, "recover").replace("recovers", "recoveries"),
            counted(len(self.tracks), "track"),
            f"limited by {shown(self.limited_by)}" if self.limited_by else "",
        )
