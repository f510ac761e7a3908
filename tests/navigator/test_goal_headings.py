"""Every built-in robot turns to every heading in a free room: with noise, without recovery, in time."""

import math

import numpy as np
import pytest

from dynastar.geometry import Goal
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.metrics import measure
from dynastar.robot import ROBOTS
from dynastar.simulation import Noise, Scenario, run

SIDE, CELL, PERIOD = 8.0, 0.05, 0.05
TICKS = 6  # of latency, of the first command, and until rest is seen
HEADINGS = [k * math.pi / 4 for k in range(8)]


def least_time(turn, limits):
    """Seconds to turn by an angle from rest to rest."""
    ramps = limits.omega_accel * limits.omega_brake / (limits.omega_accel + limits.omega_brake)
    top = min(limits.omega_max, math.sqrt(2.0 * turn * ramps))
    ramped = 0.5 * top * top / ramps
    return top / limits.omega_accel + top / limits.omega_brake + (turn - ramped) / top


def turned(robot, heading, seed):
    occupied = np.zeros((round(SIDE / CELL),) * 2, bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    middle = 0.5 * SIDE
    scenario = Scenario(
        "turn",
        OccupancyGrid(occupied, GridFrame(CELL)),
        robot,
        (middle, middle, 0.3),
        (Goal(middle, middle, heading),),
        noise=Noise(0.01, 0.01, 0.01),
        latency=PERIOD,
        time_limit=60.0,
        navigator={"period": PERIOD},
    )
    return run(scenario, seed=seed)


@pytest.mark.parametrize("name", sorted(ROBOTS))
@pytest.mark.parametrize("heading", HEADINGS)
def test_a_robot_turns_on_the_spot_to_any_heading_without_much_ado(name, heading):
    robot = ROBOTS[name]
    result = measure(turned(robot, heading, seed=round(10 * heading)))
    assert (result.outcome, result.recoveries) == ("arrived", 0), result.reason
    turn = abs(math.remainder(heading - 0.3, math.tau))
    assert result.time <= 1.5 * least_time(turn, robot.limits) + TICKS * PERIOD
    assert result.contacts_moving == result.contacts_resting == 0
