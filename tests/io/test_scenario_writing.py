"""Scenarios that are written load back the same."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynastar import io
from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io.examples import example_scenarios
from dynastar.robot import Robot
from dynastar.simulation import (
    ControlLoop,
    Drivetrain,
    Fault,
    LidarDriver,
    Mover,
    Noise,
    Odometry,
    Pedestrian,
    Post,
)
from dynastar.simulation.movers import Movers

SCENES = example_scenarios()


@pytest.mark.parametrize("name", sorted(SCENES.keys() - {"depot", "willow"}))  # these need data
def test_each_example_comes_back(name, tmp_path):
    first = io.load_scenario(SCENES[name])
    second = io.load_scenario(io.save_scenario(first, tmp_path))
    same(first, second)


def same(first, second):
    for key in ("name", "noise", "latency", "goal_tolerance", "heading_tolerance", "seed"):
        assert getattr(first, key) == getattr(second, key), key
    for key in ("drive", "odometry", "lidar", "loop"):
        assert repr(getattr(first, key)) == repr(getattr(second, key)), key  # NaN is NaN
    for key in (
        "time_limit",
        "unknown",
        "preset",
        "navigator",
        "start",
        "goals",
        "attention",
        "legs",
    ):
        assert getattr(first, key) == getattr(second, key), key
    assert first.robot.limits == second.robot.limits
    assert first.robot.lidar == second.robot.lidar
    assert np.array_equal(first.robot.footprint.vertices, second.robot.footprint.vertices)
    for a, b in ((first.grid, second.grid), (first.world, second.world)):
        assert (a is None) == (b is None)
        if a is not None:
            assert np.array_equal(a.values, b.values)
            assert a.frame == pytest.approx(b.frame)
            assert (a.keepout is None) == (b.keepout is None)
            assert a.keepout is None or np.array_equal(a.keepout, b.keepout)
    if first.grid.speed_limit is not None:
        step = 0.006 * first.robot.limits.v_max
        assert np.allclose(first.grid.speed_limit, second.grid.speed_limit, atol=step)
    assert all(map(np.array_equal, first.obstacles, second.obstacles))
    assert len(first.obstacles) == len(second.obstacles)
    for time in np.linspace(0.0, 60.0, 61):
        places = (Movers(one.movers).at(time) for one in (first, second))
        assert np.array_equal(*places, equal_nan=True)


def test_what_python_alone_can_make_comes_back(tmp_path):
    made = io.load_scenario(SCENES["u_trap"])
    values = np.full((30, 20), -1, np.int8)
    values[1:-1, 1:-1] = 0
    robot = replace(made.robot, name="of my own", footprint=Footprint.polygon(
        [(0.3, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.3, -0.2)]))  # fmt: skip
    scenario = replace(
        made,
        name='a "quoted" \\ name, ä',
        grid=OccupancyGrid(values, GridFrame(0.25, -1.0, 2.0, 0.4)),
        world=OccupancyGrid(np.zeros((30, 20), np.int8), GridFrame(0.25, -1.0, 2.0, 0.4)),
        robot=robot,
        start=(-1.0, 4.0, 7.5 * math.pi),
        goals=(Goal(0.0, 5.0, None), Goal(-1.0, 5.0, -0.5)),
        obstacles=(np.array([[1.0, 6.0], [1.2, 6.0], [1.1, 6.3]]),),
        movers=(Mover(0.2, np.array([0.0, 2.0]), np.array([[0.0, 3.0], [0.0, 4.0]]), "loop"),),
        attention="late",
        legs=True,
        noise=Noise(0.01, 0.02, 0.03),
        navigator={"dwa": {"weights": {"vel": 0.4}}, "reverse": False},
    )
    found = io.load_scenario(io.save_scenario(scenario, tmp_path / "new"))
    same(replace(scenario, start=(-1.0, 4.0, found.start[2])), found)
    assert math.remainder(found.start[2] - 7.5 * math.pi, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert isinstance(robot, Robot)


def test_what_hardware_does_comes_back(tmp_path):
    scenario = replace(
        io.load_scenario(SCENES["u_trap"]),
        drive=Drivetrain(1.05, 0.9, 0.1, 0.02, 0.1, 0.03, 0.05),
        odometry=Odometry(gain_omega=1.03),
        lidar=LidarDriver(math.nan, (447, 461), 0.001, (Post(0.7, 0.16, 2), Post(-0.7, 0.2))),
        loop=ControlLoop(0.25, 0.02),
    )
    same(scenario, io.load_scenario(io.save_scenario(scenario, tmp_path)))


def test_a_name_that_is_not_utf_8_is_written_with_question_marks(tmp_path):
    scenario = replace(io.load_scenario(SCENES["u_trap"]), name="q\udcff")
    assert io.load_scenario(io.save_scenario(scenario, tmp_path)).name == "q?"


def test_what_no_file_can_hold_is_refused_and_nothing_is_written(tmp_path):
    made = io.load_scenario(SCENES["u_trap"])
    somebody = Pedestrian(0.2, 1.0, (3.0, 3.0), np.array([[3.0, 3.0], [5.0, 3.0]]))
    for scenario in (
        replace(made, crowd=(somebody,)),
        replace(made, faults=(Fault("scans_lost", 1.0),)),
    ):
        with pytest.raises(ScenarioError, match="cannot have"):
            io.save_scenario(scenario, tmp_path)
    long = Mover(0.2, np.arange(9000.0), np.random.default_rng(0).uniform(1.0, 2.0, (9000, 2)))
    with pytest.raises(ScenarioError, match="at most 262144 are read"):
        io.save_scenario(replace(made, movers=(long,)), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_movers_who_walked_before_the_start_and_those_with_one_key_come_back(tmp_path):
    made = io.load_scenario(SCENES["u_trap"])
    begun = Mover(0.2, np.array([-1.5, 2.0]), np.array([[3.0, 3.0], [5.0, 3.0]]), "loop")
    stands = Mover(0.2, np.array([0.0]), np.array([[4.0, 4.0]]), "back_and_forth")
    given = replace(made, movers=(begun, stands))
    read = io.load_scenario(io.save_scenario(given, tmp_path))
    for time in (0.0, 1.0, 7.3):
        places = (Movers(one.movers).at(time) for one in (given, read))
        np.testing.assert_allclose(*places)
    gone = replace(stands, after="vanish")
    with pytest.raises(ScenarioError, match=r"a mover at \(4, 4\) is there for no time"):
        io.save_scenario(replace(made, movers=(gone,)), tmp_path / "other")
