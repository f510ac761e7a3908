"""What a scenario is made of: cast as the navigator does, refused where it cannot be used."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from dynastar.errors import InputError
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.navigator import NavigatorConfig
from dynastar.robot import ROBOTS
from dynastar.simulation import Noise, Scenario

GRID = OccupancyGrid(np.zeros((10, 10), bool))
RING = [(1, 1), (2, 1), (2, 2)]


def scenario(**more):
    return Scenario(
        **{
            "name": "a",
            "grid": GRID,
            "robot": "jackal",
            "start": (5.0, 5.0, 0.0),
            "goals": (),
            **more,
        }
    )


def test_parts_are_cast():
    made = scenario(
        goals=((4.3, 4.0),), obstacles=(RING,), noise={"range_bound": 0.1}, time_limit=9
    )
    assert made.robot is ROBOTS["jackal"]
    assert made.goals == (Goal(4.3, 4.0),)
    assert scenario(goals=Goal(4.3, 4.0)).goals == made.goals
    assert made.obstacles[0].shape == (3, 2)
    assert made.noise == Noise(range_bound=0.1)
    assert repr(made.time_limit) == "9.0"
    assert scenario(start=(5.0, 5.0)).start == (5.0, 5.0, None)
    assert made != scenario()
    assert vars(replace(made)) == vars(made)
    assert pickle.loads(pickle.dumps(made)).goals == made.goals


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("robot", "jackel", "did you mean 'jackal'"),
        ("robot", 3, "a robot: got int, expected Robot"),
        ("grid", GRID.values, "a map: got ndarray, expected OccupancyGrid"),
        ("world", GRID.values, "a map: got ndarray"),
        ("start", "here", "the start is 'here'"),
        ("goals", ((4.3,),), "a goal is"),
        ("navigator", NavigatorConfig(), "expected a table of settings"),
        ("noise", {"range": 0.1}, "unknown key 'Scenario.noise.range'"),
        ("obstacles", (RING[:2],), "an obstacle is"),
        ("obstacles", ("abc",), "an obstacle is"),
        ("obstacles", 3, "expected a tuple of polygons"),
        ("movers", (3,), "expected a tuple of Mover"),
        ("seed", 1.5, "'Scenario.seed' is 1.5: expected a whole number"),
        ("time_limit", -1, "'Scenario.time_limit' is -1 s"),
        ("time_limit", math.nan, "'Scenario.time_limit' is nan s"),
        ("attention", "x", "expected one of 'none', 'late'"),
    ],
)
def test_a_part_that_cannot_be_used_is_refused(name, value, words):
    with pytest.raises(InputError, match=words):
        scenario(**{name: value})
