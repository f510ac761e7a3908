"""What a check says is what a simulated robot then does."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynastar import simulation
from dynastar.check.doors import ways_of
from dynastar.check.driving import braking
from dynastar.check.promise import hidden
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.navigator import configured
from dynastar.robot import ROBOTS
from dynastar.simulation import Scenario

PIONEER = ROBOTS["pioneer3dx"]


def walls(rows, columns):
    occupied = np.zeros((rows, columns), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    return occupied


@pytest.mark.slow
@pytest.mark.parametrize("name", ["pioneer3dx", "jackal"])
@pytest.mark.parametrize("fits", [True, False])
def test_a_robot_passes_a_door_that_is_surely_wide_enough_and_none_that_is_too_narrow(name, fits):
    ways = ways_of(ROBOTS[name], configured("default"))
    rows = math.floor((ways.surely if fits else ways.drive - 0.02) / 0.01 + 1e-6)
    occupied = walls(400, 600)
    occupied[:, 290:310] = True
    occupied[203 - rows // 2 : 203 - rows // 2 + rows, 290:310] = False
    scenario = Scenario(
        "door",
        OccupancyGrid.from_occupied(occupied, 0.01),
        ROBOTS[name],
        (1.5, 2.0, 0.0),
        (Goal(4.5, 2.0),),
        time_limit=40.0,
    )
    assert simulation.run(scenario).outcome == ("arrived" if fits else "blocked")


@pytest.mark.slow
@pytest.mark.parametrize("hidden_speed", [0.0, 0.5])
@pytest.mark.parametrize(
    ("limits", "lidar", "narrowest"),
    [
        ({"v_max": 1.5, "v_brake": 0.5}, {"range_max": 2.0}, 0.1),
        ({"v_max": 1.0, "v_brake": 1.0}, {"beams": 180}, 0.03),
    ],
)
def test_a_robot_that_sees_too_little_drives_about_as_fast_as_the_check_says(
    limits, lidar, narrowest, hidden_speed
):
    robot = replace(
        PIONEER,
        limits=PIONEER.limits._replace(**limits),
        lidar=PIONEER.lidar._replace(**lidar),
    )
    settings = {"local_map": {"narrowest": narrowest}, "hidden_speed": hidden_speed}
    config = configured("default", settings)
    seen, people = braking(robot, config), hidden(robot, config)
    assert seen.level == "problem"
    expected = seen.values["fastest"]
    if hidden_speed > 0.0:
        expected = min(expected, people.values["fastest"])
    scenario = Scenario(
        "hall",
        OccupancyGrid.from_occupied(walls(120, 250), 0.1),
        robot,
        (2.0, 6.0, 0.0),
        (Goal(22.0, 6.0),),
        time_limit=10.0,
        navigator=settings,
    )
    driven = simulation.run(scenario).trajectory.twists[:, 0].max()
    assert driven == pytest.approx(expected, rel=0.1)
