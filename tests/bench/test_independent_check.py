"""Saved episodes say the same to a check that shares no code with the simulator and the suites."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import independent
from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import barn
from dynastar.geometry import Goal, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io import save_episode
from dynastar.metrics import measure
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Noise, Scenario, drive

BOX = np.array([[4.0, 2.6], [4.9, 2.9], [4.6, 3.8], [3.7, 3.5]])
STEP = 0.02  # m: v_max of the Jackal for the simulator's longest step, how deep a contact can be
WALLS = np.zeros((60, 80), bool)
WALLS[[0, -1]] = WALLS[:, [0, -1]] = True
WALLS[0:25, 60:63] = True


class Blind:
    """Drives straight on at a speed until a time, and sees nothing."""

    def __init__(self, v, until=math.inf):
        self.v, self.until = v, until
        self.status = SimpleNamespace(
            state="following", reason="", recoveries=0, plan=None, plan_id=0, plan_reason="",
            planning_frame=GridFrame(1.0), error=None,
        )  # fmt: skip

    def set_goal(self, goals):
        self.goals = goals

    def command(self, state, scan):
        return Twist(self.v if state.stamp < self.until else 0.0, 0.0)


def blind(v, until=math.inf):
    return lambda grid, robot, config: Blind(v, until)


def mission(robot, yaw=0.0, **more):
    frame = GridFrame(0.1, -1.0, 0.5, yaw)
    start = frame.to_world(30.0, 15.0)
    goal = frame.to_world(30.0, 70.0)
    return Scenario(
        "check", OccupancyGrid(WALLS, frame), ROBOTS[robot], (*start, yaw), (Goal(*goal),),
        **{"time_limit": 30.0, "noise": Noise(0.01), "latency": 0.05, **more},
        navigator={"period": 0.05},
    )  # fmt: skip


def checked(tmp_path, scenario, controller=None, **more):
    """The episode's own numbers, and what the check finds in its file."""
    episode = drive(scenario, navigator=controller)
    save_episode(episode, tmp_path / "episode.npz")
    return measure(episode), independent.found(independent.read(tmp_path / "episode.npz"), **more)


def agree(told, found):
    contact = "moving" if told.contacts_moving else "resting" if told.contacts_resting else ""
    assert found.contact == contact
    assert found.length == pytest.approx(told.length, abs=1e-9)
    assert found.at_goal == (told.outcome == "arrived")
    gap = min(found.static_gap, found.mover_gap)
    if contact:
        assert -STEP <= gap <= 0.0
    else:
        # The simulator looks at fewer poses than every one, the check at straight lines between.
        assert told.min_clearance == pytest.approx(gap, abs=STEP)
        assert gap > 0.0
    return contact


@pytest.mark.parametrize("robot", ["pioneer3dx", "jackal"])
@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_an_arrival_past_a_box_and_a_walker(tmp_path, robot, yaw):
    frame = GridFrame(0.1, -1.0, 0.5, yaw)
    walk = frame.points_to_world([(45.0, 40.0), (52.0, 70.0)])
    scenario = mission(
        robot,
        yaw,
        obstacles=(frame.points_to_world(10.0 * BOX[:, ::-1] + (-2.0, 0.0)),),
        movers=(Mover(0.25, np.array([0.0, 6.0]), walk),),
    )
    told, found = checked(tmp_path, scenario, controller_named("pure_pursuit"))
    assert told.outcome == "arrived"
    assert agree(told, found) == ""


@pytest.mark.parametrize("robot", ["pioneer3dx", "jackal"])
def test_a_contact_with_the_map_while_moving(tmp_path, robot):
    told, found = checked(tmp_path, mission(robot), blind(0.5))
    assert agree(told, found) == "moving"
    assert found.static_gap <= 0.0 < found.mover_gap


@pytest.mark.parametrize("robot", ["pioneer3dx", "jackal"])
def test_a_contact_with_an_unmapped_box_while_moving(tmp_path, robot):
    told, found = checked(tmp_path, mission(robot, 0.7, obstacles=_ahead(0.7)), blind(0.5))
    assert agree(told, found) == "moving"
    assert told.length < 4.0


def _ahead(yaw):
    frame = GridFrame(0.1, -1.0, 0.5, yaw)
    return (frame.points_to_world([(28.0, 45.0), (28.0, 50.0), (35.0, 50.0), (35.0, 44.0)]),)


@pytest.mark.parametrize("robot", ["pioneer3dx", "jackal"])
@pytest.mark.parametrize(("until", "contact"), [(1.0, "resting"), (math.inf, "moving")])
def test_a_contact_with_a_walker(tmp_path, robot, until, contact):
    walker = Mover(0.3, np.array([0.0, 10.0]), np.array([[6.0, 3.5], [0.0, 3.5]]))
    told, found = checked(tmp_path, mission(robot, movers=(walker,)), blind(0.4, until))
    assert agree(told, found) == contact
    assert found.mover_gap <= 0.0 < found.static_gap


def test_a_mover_that_jumps_back_to_its_start_touches_nobody_on_the_way(tmp_path):
    walker = Mover(
        0.3, np.array([0.0, 2.0]), np.array([[4.0, 2.0], [4.0, 5.0]]) + (0.0, 0.2), "loop"
    )
    scenario = mission("pioneer3dx", movers=(walker,), time_limit=5.0)
    told, found = checked(tmp_path, scenario, blind(0.0))
    assert told.outcome == "timeout"
    assert agree(told, found) == ""


def test_leaving_the_map_is_a_contact(tmp_path):
    open_map = OccupancyGrid(np.zeros((40, 40), bool), GridFrame(0.1))
    scenario = Scenario(
        "off", open_map, ROBOTS["pioneer3dx"], (2.0, 2.0, 0.0), (Goal(1.0, 1.0),), time_limit=9.0
    )
    told, found = checked(tmp_path, scenario, blind(0.5))
    assert agree(told, found) == "moving"


def test_the_check_can_fail(tmp_path):
    told, found = checked(tmp_path, mission("jackal"), blind(0.5), map_is_true=False)
    with pytest.raises(AssertionError):
        agree(told, found)


@pytest.mark.data
@pytest.mark.parametrize(
    ("number", "controller", "contact"),
    [(15, "pure_pursuit", ""), (105, "pure_pursuit", ""), (45, "blind", "moving")],
)
def test_barn_worlds_from_their_own_files(
    tmp_path, data_dir, monkeypatch, number, controller, contact
):
    cls = blind(2.0) if controller == "blind" else controller_named(controller)
    monkeypatch.setattr("dynastar.bench.driven.controller_named", lambda name: cls)
    options = Options(data=data_dir, controller=controller)
    row = barn.run_mission(Mission(number), options, 0)
    episode = drive(barn.scenario(Mission(number), options, 0), navigator=cls)
    save_episode(episode, tmp_path / "episode.npz")
    saved = independent.read(tmp_path / "episode.npz")
    saved.arrays["obstacle_points"] = np.empty((0, 2))  # the original cylinders instead
    saved.arrays["obstacle_rows"] = np.empty(0, int)
    cylinders = independent.barn_cylinders(data_dir / "barn", number)
    assert len(cylinders) > 150
    found = independent.found(saved, cylinders, margin=0.003)  # cylinders are 12-gons in the suite
    assert found.contact == contact
    assert found.length == pytest.approx(row["length"], abs=1e-9)
    score = independent.barn_score(saved, data_dir / "barn", number, found.at_goal)
    assert row["score"] == pytest.approx(score, abs=1e-9)
    assert (score > 0.3) == (contact == "")
