"""What a newcomer types in the first hour: taken where its meaning is clear, else refused in a sentence."""

import subprocess
import sys

import numpy as np
import pytest

import dynastar
from dynastar import (
    ROBOTS,
    DynastarWarning,
    Footprint,
    Goal,
    GridFrame,
    InputError,
    Lidar,
    Limits,
    Navigator,
    NavigatorConfig,
    OccupancyGrid,
    Path,
    PlannerConfig,
    Pose2D,
    Robot,
    Scenario,
    World,
    plan,
)
from dynastar.config import self_checking
from dynastar.dwa.config import DwaConfig, Weights
from dynastar.errors import ConfigError

GRID = OccupancyGrid(np.zeros((80, 80), bool), GridFrame(0.1))
LIMITS = Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: NavigatorConfig(latency=-5), "'NavigatorConfig.latency' is -5 s: legal is from 0"),
        (lambda: NavigatorConfig(period=0.0), "'NavigatorConfig.period' is 0.0 s: legal is from 0.01"),
        (lambda: NavigatorConfig(comfort="2"), "'NavigatorConfig.comfort' is '2': expected a number"),
        (lambda: NavigatorConfig(latncy=0.1), "did you mean 'latency'"),
        (lambda: NavigatorConfig(period=float("nan")), "'NavigatorConfig.period' is nan"),
        (lambda: NavigatorConfig()._replace(period=9), "'NavigatorConfig.period' is 9 s"),
        (lambda: NavigatorConfig(0.1, period=0.1), "'NavigatorConfig.period' is given twice"),
        (lambda: NavigatorConfig(dwa=DwaConfig(v_samples=2.5)), "'DwaConfig.v_samples' is 2.5"),
        (lambda: NavigatorConfig(dwa={"v_samples": 1}), "'NavigatorConfig.dwa.v_samples' is 1"),
        (lambda: NavigatorConfig(unknown="fre"), "expected one of 'free', 'blocked'"),
        (lambda: Weights(*range(7)), "Weights has 6 values, got 7"),
        (lambda: Limits(-1, 1, 1, 1, 1, 1), "'Limits.v_max' is -1 m/s"),
        (lambda: LIMITS._replace(v_accel=0), "'Limits.v_accel' is 0 m/s2"),
        (lambda: Limits(1.0), "missing key 'Limits.omega_max'"),
        (lambda: Lidar(beams=0), "'Lidar.beams' is 0"),
        (lambda: PlannerConfig(rounding=-1), "'PlannerConfig.rounding' is -1 m"),
        (lambda: OccupancyGrid(np.zeros((3, 3), bool), "0.05"), "'0.05': expected a GridFrame"),
        (lambda: OccupancyGrid(np.zeros((3, 3), bool), -1), "a GridFrame with a resolution > 0"),
        (lambda: Navigator(GRID, "pionear3dx"), "did you mean 'pioneer3dx'"),
        (lambda: Navigator(GRID, 3), "a robot: got int, expected Robot, or one of paper"),
        (lambda: Navigator(np.zeros((9, 9)), "jackal"), "a map: got ndarray, expected OccupancyGrid"),
        (lambda: Navigator(GRID, "jackal", {"period": 1}), "settings: got dict"),
        (lambda: plan(np.zeros((9, 9), bool), (1, 1), (2, 2)), "OccupancyGrid\\(array, 0.05\\)"),
        (lambda: plan(GRID, 1.0, (2, 2)), "the start is 1.0: expected \\(x, y\\)"),
        (lambda: plan(GRID, (1, 1), "here"), "the goal is 'here': expected \\(x, y\\)"),
        (lambda: plan(GRID, (1, 1), (float("nan"), 1)), "the goal \\(nan, 1\\) is off the map"),
        (lambda: Path([1.0, 2.0]), "a path has shape"),
    ],
)  # fmt: skip
def test_what_cannot_be_meant_is_refused_with_what_would_be_right(make, words):
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (7.2, "expected \\(x, y\\) in metres"),
        ("7.2, 10", "expected \\(x, y\\) in metres"),
        ((7.2,), "expected \\(x, y\\)"),
        ((7.2, None), "expected \\(x, y\\)"),
        ((7.2, 1.0, 90.0), "90 degrees are 1.571 rad"),
        ((float("inf"), 1.0), "finite"),
        ([(1.0, 2.0), "x"], "expected \\(x, y\\)"),
    ],
)
def test_what_is_no_goal_is_said_to_be_none(goal, words):
    with pytest.raises(InputError, match=words):
        Navigator(GRID, "turtlebot3_burger").set_goal(goal)


@pytest.mark.parametrize(
    ("given", "goals"),
    [
        ((7, 6), [Goal(7.0, 6.0)]),
        ([7, 6, 1], [Goal(7.0, 6.0, 1.0)]),
        (Goal(7.0, 6.0), [Goal(7.0, 6.0)]),
        (Pose2D(7.0, 6.0, 0.5), [Goal(7.0, 6.0, 0.5)]),
        (np.array([7.0, 6.0]), [Goal(7.0, 6.0)]),
        ([(7, 6), Goal(1, 2, 0.1)], [Goal(7.0, 6.0), Goal(1.0, 2.0, 0.1)]),
        (np.array([(7.0, 6.0), (1.0, 2.0)]), [Goal(7.0, 6.0), Goal(1.0, 2.0)]),
        ([], []),
    ],
)
def test_goals_may_be_tuples_poses_and_arrays(given, goals):
    navigator = Navigator(GRID, ROBOTS["turtlebot3_burger"])
    navigator.set_goal(given)
    assert navigator.mission.goals == goals
    assert all(isinstance(goal, Goal) for goal in navigator.mission.goals)


def test_points_may_be_poses_and_goals_and_a_frame_the_side_of_a_cell():
    grid = OccupancyGrid(np.zeros((80, 80), bool), 0.1)
    assert grid.frame == GRID.frame
    there = plan(grid, (1, 1), (5, 4)).path.points
    assert (plan(grid, Pose2D(1.0, 1.0, 2.0), Goal(5.0, 4.0)).path.points == there).all()


def test_numbers_become_floats_so_that_no_kernel_is_compiled_again():
    limits = Limits(1, 2, 3, 4, 5, 6)
    assert limits == (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0, 0.0, 0.0)
    assert {type(value) for value in limits} == {float}
    config = NavigatorConfig(latency=0, dwa={"horizon": 3})
    assert type(config.latency) is type(config.dwa.horizon) is float
    assert type(config._replace(period=1).period) is float


def test_a_navigator_with_whole_numbers_compiles_nothing():
    from numba.core import event

    from dynastar.simulation.warming import warm_up

    warm_up()
    listener = event.RecordingListener()
    event.register("numba:compile", listener)
    try:
        robot = dynastar.Robot("whole", Limits(1, 2, 3, 4, 5, 6), dynastar.Footprint.disc(1))
        navigator = Navigator(GRID, robot, NavigatorConfig(latency=0))
        navigator.set_goal((6, 6))
        scan = dynastar.LaserScan(0.0, np.full(360, 3.0), -np.pi, np.pi / 180, 0.0, 5.0)
        state = dynastar.RobotState(0.0, Pose2D(4.0, 4.0, 0.0), dynastar.Twist(0.0, 0.0))
        navigator.command(state, scan)
    finally:
        event.unregister("numba:compile", listener)
    assert [e.data["dispatcher"].__name__ for _, e in listener.buffer if e.is_start] == []


def test_checks_are_for_tuples_with_declared_fields():
    with pytest.raises(AttributeError):
        self_checking(int)


def test_every_public_name_is_there_and_known_to_type_checkers():
    from pathlib import Path as File

    source = File(dynastar.__file__).read_text(encoding="utf-8")
    for name in dynastar.__all__:
        assert getattr(dynastar, name) is not None
        if name != "__version__":
            assert f" import {name} as {name}\n" in source
    assert source.count(" as ") - source.count("import ") <= 1
    assert sorted(dynastar.__all__) == dir(dynastar)


USER_PROGRAM = """
import numpy as np
import dynastar
from dynastar import Goal, LaserScan, Navigator, OccupancyGrid, Pose2D, RobotState, Twist

def drive(scan: LaserScan, stamp: float) -> Twist:
    occupied = np.zeros((40, 60), dtype=bool)
    grid = OccupancyGrid(occupied, 0.05)
    navigator = Navigator(grid, "pioneer3dx", dynastar.configured("paper", {"latency": 0.1}))
    navigator.set_goal((1.0, 2.0))
    navigator.set_goal([Goal(1.0, 2.0), (2.0, 1.0, 0.0)])
    plan = dynastar.plan(grid, (0.5, 0.5), (2.5, 1.5), radius=0.2)
    navigator.follow(plan.path)
    twist = navigator.command(RobotState(stamp, Pose2D(0.5, 0.5), Twist(0.0, 0.0)), scan)
    state: str = navigator.status.state
    print(state, plan.path.length, twist.v)
    return twist
"""


@pytest.mark.slow
def test_a_program_of_a_users_own_passes_strict_type_checks(tmp_path):
    (tmp_path / "program.py").write_text(USER_PROGRAM)
    words = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "program.py"]
    found = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "no issues" in found.stdout, found.stdout


def test_a_wrong_robot_is_told_the_nearest_name():
    with pytest.raises(
        KeyError, match=r"^unknown robot 'turtlebot' \(did you mean 'turtlebot3_burger'"
    ):
        ROBOTS["turtlebot"]
    with pytest.raises(
        InputError, match=r"\(legal: jackal, paper, pioneer3dx, turtlebot3_burger\)"
    ):
        ROBOTS[3]
    assert ROBOTS.get("turtlebot") is None
    assert "turtlebot" not in ROBOTS


def test_a_radius_and_a_speed_make_a_robot_that_drives():
    robot = Robot.simple(0.2, 0.8)
    assert robot.footprint.circumscribed == 0.2
    assert (robot.limits.v_max, robot.limits.v_accel, robot.limits.v_brake) == (0.8, 0.8, 0.8)
    navigator = Navigator(GRID, robot)
    navigator.set_goal((6.0, 6.0))
    world = World(Scenario("hall", GRID, robot, (2.0, 2.0, None), (Goal(6.0, 6.0),)))
    for _ in range(40):
        world.step(navigator.command(world.sensed_state(), world.scan()), 0.1)
    assert np.hypot(world.pose.x - 2.0, world.pose.y - 2.0) > 1.0
    with pytest.raises(ConfigError, match=r"'Limits.v_max' is 0 m/s"):
        Robot.simple(0.2, 0)
    with pytest.raises(ConfigError, match=r"radius is -1"):
        Robot.simple(-1, 1.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Footprint.disc(25),
        lambda: Footprint.polygon([(30, -20), (30, 20), (-30, 20), (-30, -20)]),
        lambda: Robot.simple(25, 1.0),
    ],
)
def test_a_footprint_of_many_metres_is_questioned(make):
    with pytest.warns(DynastarWarning, match=r"reaches (25|36.0555) m .*: lengths are in metres"):
        make()


def test_a_footprint_of_a_truck_is_not_questioned():
    assert Footprint.disc(5.0).is_disc  # warnings are errors here
