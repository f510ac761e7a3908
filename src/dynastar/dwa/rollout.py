"""Roll-outs: what the robot would do if it held a sample for a while and then followed a tail.

The tail follows the cost-to-go, brakes to rest, or reverses. A roll-out says where the robot would
be; ``terms`` says what that is worth.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import inner
from dynastar.dwa.clearance import ROUNDING, Closed, clearance_slack, least_clearance
from dynastar.dwa.motion import State, driven
from dynastar.dwa.scene import BACK, FOLLOW
from dynastar.guidance.cost_to_go import turn_to_descent, value_at

RIM = 2.0  # cells of the cost-to-go at its border that count as outside of it
STRIDE = 2  # steps to a row after the sample is no longer held
STEER_GAIN = 3.0  # 1/s, turning rate over the angle to the descent
BEND_GAIN = 1.5  # 1/rad, by which the speed falls with the angle to the descent
SLOWEST_NEAR = 0.2  # of the speed, that is kept right beside an obstacle
NEAR_END = 0.02  # m to the end of the descent, within which the robot turns more slowly
GENTLE = 0.8  # of the braking limits that a roll-out plans with


# Where a roll-out is at one time: pose, speed, clearance beyond the margin (m), on the local map.
ROW = np.dtype(
    [(name, np.float64) for name in ("x", "y", "cos", "sin", "v", "gap")] + [("on_map", np.bool_)]
)


class Start(NamedTuple):
    """Where roll-outs begin: the state, its clearance beyond the margin (m), and its cost-to-go (m).

    ``most`` (m) is the most that the cost-to-go can fall by on average over the times of a roll-out.
    """

    state: State
    gap: float
    cost_to_go: float
    most: float


class Schedule(NamedTuple):
    """Times of a roll-out's rows: every step while a sample is held, then every second one.

    ``step`` (n,) is the number of each row's time in steps of ``period`` (s), ``duration`` (n,) the
    seconds since the row before. ``held`` is the number of rows for which a sample is held, ``lookups``
    (8,) are the rows at which the cost-to-go is looked up.
    """

    step: npt.NDArray[np.int64]
    duration: npt.NDArray[np.float64]
    lookups: npt.NDArray[np.int64]
    held: int
    period: float


def schedule_of(period: float, held: int, steps: int, lookups: int) -> Schedule:
    """The schedule of roll-outs of ``steps`` of ``period`` (s), of which ``held`` are held."""
    at = [*range(1, held + 1), *range(held + STRIDE, steps + 1, STRIDE)]
    if at[-1] < steps:
        at.append(steps)
    step = np.array(at)
    between = steps // lookups
    rows = np.searchsorted(step, between * np.arange(1, lookups + 1))
    return Schedule(step, period * np.diff(step, prepend=0), rows, held, period)


@inner
def is_on_map(field, x, y):
    """Whether a point lies where the cost-to-go is known: inside the local map but for its rim."""
    rows, columns = field.values.shape
    column, row = (x - field.x0) / field.resolution, (y - field.y0) / field.resolution
    return RIM <= column <= columns - RIM and RIM <= row <= rows - RIM


@inner
def stopping_speed(left, brake, step):
    """The speed that may be held for ``step`` s so that braking then ends within what is ``left``."""
    held = brake * step
    return math.sqrt(held * held + 2.0 * brake * left) - held


@inner
def follow(cost_to_go, limits, comfort, state, gap, step):
    """Speeds that follow the descent of the cost-to-go from a state with clearance ``gap`` (m).

    The robot steers by the descent where it will be once its turning rate has changed, and slows
    down for the bend where it could stop. At its end the descent has no direction, and the
    robot does not turn. The speeds are held for ``step`` s.
    """
    pose, v = state.pose, state.v
    off = turn_to_descent(cost_to_go, pose, 0.5 * v * limits.omega_max / limits.omega_accel)
    bend = turn_to_descent(cost_to_go, pose, 0.5 * v * abs(v) / limits.v_brake)
    rate = min(STEER_GAIN * abs(off), stopping_speed(abs(off), GENTLE * limits.omega_brake, step))
    left = max(value_at(cost_to_go, pose.x, pose.y), 0.0)
    rate = min(limits.omega_max, rate) * min(1.0, left / NEAR_END)
    wanted = limits.v_max * max(0.0, 1.0 - BEND_GAIN * max(abs(off), abs(bend)))
    wanted *= min(1.0, max(SLOWEST_NEAR, gap / comfort))
    v_stop = stopping_speed(left, GENTLE * limits.v_brake, step)
    return min(wanted, v_stop), math.copysign(rate, off)


@inner
def tail_speeds(cost_to_go, rules, state, gap, tail):
    """The speeds (v, omega) that a tail asks for at a state with clearance ``gap`` (m)."""
    if tail == FOLLOW:
        step = STRIDE * rules.schedule.period  # the longest of a roll-out
        return follow(cost_to_go, rules.limits, rules.config.comfort, state, gap, step)
    if tail == BACK:
        return rules.limits.v_min, 0.0
    return 0.0, 0.0


@inner
def roll_out(scene, rules, start, manoeuvre, rows):
    """Write where the robot would be to ``rows``.

    The sample is held for a step at least. The robot stays where it would touch an obstacle, and where
    it leaves the map.
    """
    schedule, limits = rules.schedule, rules.limits
    obstacles, cost_to_go = scene.distance_to_obstacle, scene.cost_to_go
    state, gap = start.state, start.gap
    near = obstacles.resolution + rules.body.probe_error  # m, a gap beyond which nothing is touched
    held = max(1, round(manoeuvre.hold / schedule.period))
    on_map, blocked, k = True, False, 0
    for i in range(len(rows)):
        v, omega = manoeuvre.v, manoeuvre.omega
        if k >= held:
            v, omega = tail_speeds(cost_to_go, rules, state, gap, manoeuvre.tail)
        moves = state.v != 0.0 or state.omega != 0.0 or v != 0.0 or omega != 0.0
        if moves and on_map and not blocked:
            state = driven(state, v, omega, limits, schedule.duration[i])
            on_map = is_on_map(cost_to_go.value, state.pose.x, state.pose.y)
            gap = least_clearance(obstacles, rules.body, state.pose) - scene.margin
            if on_map and gap < near and touches(scene, rules, start, state.pose):
                blocked = True
        k = schedule.step[i]
        write(rows[i], state, gap, on_map)


@inner
def touches(scene, rules, start, pose):
    """Whether a footprint at ``pose`` is nearer to an obstacle than a certified stop may come."""
    closed, margin = scene.around.closed, scene.around.margin_to_closed
    obstacles = Closed(scene.distance_to_obstacle, closed.occupied, closed.hits)
    at_start = start.state.pose
    return clearance_slack(obstacles, rules.body, margin, at_start, pose) < -ROUNDING


@inner
def write(row, state, gap, on_map):
    """Write a state to a row of a roll-out."""
    row.x, row.y, row.cos, row.sin = state.pose.x, state.pose.y, state.pose.cos, state.pose.sin
    row.v, row.gap, row.on_map = state.v, gap, on_map
